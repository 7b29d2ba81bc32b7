"""`hilt scene show`: a picture of a scene, and what stands where."""

import json
from pathlib import Path

import pytest
from PIL import Image

from hilt.agent.cli import main

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


def run(*arguments: str) -> int:
    """The exit code of a command."""
    with pytest.raises(SystemExit) as ended:
        main(["scene", "show", *arguments])
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
