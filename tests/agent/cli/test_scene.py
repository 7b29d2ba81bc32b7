"""`hilt scene show`, `hilt grasp` on a cloud, and `hilt object import`."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from hilt.agent.cli import main
from hilt.sim import poses

ROD = """
objects:
  rod:
    is_a: tool
    parts:
      shaft:
        role: grip
        material: wood
        colour: "#805030"
        mass: 0.1
        shape:
          - cylinder: {radius: 0.01, length: 0.3}
    rests:
      flat: {turn_deg: [0, 90, 0]}
"""


def run(*arguments: str, group: str = "scene") -> int:
    """The exit code of a command, `hilt scene show` by default."""
    with pytest.raises(SystemExit) as ended:
        main([group, *(["show"] if group == "scene" else []), *arguments])
    return int(ended.value.code or 0)


@pytest.mark.sim
def test_scene_is_rendered_and_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """The picture is written, and the nail stands in the block that came with it."""
    out = tmp_path / "scene.png"

    code = run("--scene", "objects:mug,nail", "--out", str(out), "--names", "--json")

    told = json.loads(capsys.readouterr().out)
    assert code == 0
    assert {thing["name"]: thing["within"] for thing in told["things"]} == {
        "mug": None,
        "nail": "block",
        "block": None,
    }
    with Image.open(out) as picture:
        assert picture.size == (960, 720)


@pytest.mark.sim
def test_own_object_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """An object of one's own needs a file and no code."""
    (tmp_path / "mine.yaml").write_text(ROD, encoding="utf-8")

    code = run(
        "--objects", str(tmp_path / "mine.yaml"), "--scene", "objects:rod,mug", "--seed", "3",
        "--out", str(tmp_path / "scene.jpg"),
    )  # fmt: skip

    assert code == 0
    assert capsys.readouterr().out.startswith("rod ")


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (("--out", "scene.pdf"), "expected a file ending in .png"),
        (("--scene", "objects:sabre"), 'object "sabre"'),
        (("--objects", "nowhere.yaml"), "nowhere.yaml"),
    ],
)
def test_what_cannot_be_shown_is_told(
    arguments: tuple[str, ...], problem: str, capsys: pytest.CaptureFixture[str]
):
    """Wrong usage is one line on stderr and exit code 2."""
    assert run(*arguments) == 2
    assert problem in capsys.readouterr().err


BASE_FROM_CAMERA = poses.pose(poses.rotation_about((1, 0, 0), np.pi), (0.5, 0.0, 0.6))


def grasp(folder: Path, *options: str) -> int:
    """The exit code of `hilt grasp` on a bar, 3 cm wide, that a camera above it sees."""
    x, y = np.meshgrid(np.linspace(-0.06, 0.06, 80), np.linspace(-0.015, 0.015, 20))
    top = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 0.56)])
    side = np.column_stack([x.ravel(), np.full(x.size, 0.015), 0.575 + y.ravel()])
    points = np.vstack([top, side])
    labels = np.where(points[:, 0] > 0, "head", "grip")
    np.savez(folder / "bar.npz", points=points, labels=labels, base_from_camera=BASE_FROM_CAMERA)
    with pytest.raises(SystemExit) as ended:
        main(["grasp", "--cloud", str(folder / "bar.npz"), "--table", "0", *options])
    return int(ended.value.code or 0)


def test_grasps_of_a_cloud_are_one_json_document(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """Each grasp has its part, pose, width, opening and score; the best come first."""
    code = grasp(tmp_path, "--part", "grip", "--top", "2", "--json")

    told = json.loads(capsys.readouterr().out)
    assert code == 0
    assert (told["frame"], told["reach_checked"], len(told["grasps"])) == ("base", True, 2)
    first, second = told["grasps"]
    assert first.keys() == {"part", "pose", "width_m", "opening_m", "score"}
    assert first["part"] == "grip" and first["score"] >= second["score"]
    assert first["opening_m"] > first["width_m"] == pytest.approx(0.03, abs=0.002)
    assert np.shape(first["pose"]) == (4, 4) and first["pose"][0][3] < 0.5
    assert set(told["rejected"]) & {"part", "below_table"}


def test_grasps_are_told_in_the_frame_of_the_camera(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """The pose of the camera leads from the one frame to the other."""
    told = []
    for frame in ("base", "camera"):
        assert grasp(tmp_path, "--frame", frame, "--top", "1", "--json") == 0
        told.append(json.loads(capsys.readouterr().out))

    in_base, in_camera = (np.array(each["grasps"][0]["pose"]) for each in told)
    assert [each["frame"] for each in told] == ["base", "camera"]
    assert np.allclose(BASE_FROM_CAMERA @ in_camera, in_base, atol=1e-5)


def test_cloud_without_a_grasp_is_a_failure_with_its_reasons(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """The exit code is 1, and what was rejected is counted."""
    code = grasp(tmp_path, "--table", "0.039")

    assert code == 1
    assert "Rejected: " in (told := capsys.readouterr().out) and "below_table" in told


def test_wrong_cloud_is_wrong_usage(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """One line names the label, and those there are."""
    code = grasp(tmp_path, "--part", "lid")

    assert code == 2
    assert capsys.readouterr().err == 'hilt: There is no label "lid". Known: grip, head.\n'


BRICK = """<mujoco><worldbody><body name="brick">
<geom type="box" size="0.03 0.02 0.01"/>
</body></worldbody></mujoco>
"""


@pytest.mark.sim
def test_object_is_imported_and_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """The object has the name of its file; the picture shows it on the table."""
    (tmp_path / "brick.xml").write_text(BRICK, encoding="utf-8")
    out, picture = str(tmp_path / "mine.yaml"), str(tmp_path / "brick.png")

    code = run(
        "import", str(tmp_path / "brick.xml"), "--role", "brick=grip", "--out", out,
        "--picture", picture, "--json", group="object",
    )  # fmt: skip

    assert code == 0
    told = json.loads(capsys.readouterr().out)
    assert told == {"object": "brick", "parts": {"brick": 0.048}, "file": out, "picture": picture}
    with Image.open(picture) as image:
        assert image.size == (960, 720)


def test_import_without_a_link_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A part that names nothing is one line on stderr, which lists what could be named."""
    (tmp_path / "brick.xml").write_text(BRICK, encoding="utf-8")

    file, out = str(tmp_path / "brick.xml"), str(tmp_path / "mine.yaml")

    assert run("import", file, "--part", "side", "--out", out, group="object") == 2
    assert "Known: brick, world." in capsys.readouterr().err
