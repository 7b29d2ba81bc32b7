"""Grasps in point clouds of one's own, mostly of a single view: planned, refused, and executed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.ontology.errors import DataError, SimulationError, UnknownNameError
from hilt.ontology.objects import load_objects
from hilt.sim import Body, grasps_on_cloud, parse_scene, poses, read_cloud
from hilt.sim.grasping import cloud_grasps
from hilt.sim.manipulation.hand_motions import LIFT_PACE, HandMotion
from hilt.sim.poses import Array
from hilt.sim.robot.models import find_robot
from hilt.sim.robot.path_planner import PathPlanner
from hilt.sim.vision.camera import CAMERAS_ROUND_TABLE, Camera
from hilt.sim.vision.object_detector import MaskDetector
from tests.sim.contacts import finger_contacts

panda = find_robot("panda").gripper
assert panda is not None
GRIPPER = panda
OBJECTS = load_objects()
SIZE = (0.12, 0.03, 0.04)  # of a bar on the table [m]
AT = (0.5, 0.0, 0.02)  # its middle
EYE = np.array((0.9, -0.5, 0.6))  # from where one camera sees it
POINTER = """
pointer:
  label: Panda without a hand
  urdf: franka_panda/panda.urdf
  hand: panda_hand
  home: [0.0, -0.6, 0.0, -2.3, 0.0, 1.75, 0.785]
"""


def seen_box(middle: tuple[float, ...] = AT, size: tuple[float, ...] = SIZE) -> Array:
    """Points on those faces of a box that a camera at `EYE` sees."""
    faces = []
    for axis, side in ((axis, side) for axis in range(3) for side in (-1, 1)):
        axes = [np.arange(-s / 2, s / 2 + 1e-9, 0.0015) for s in size]
        axes[axis] = np.array([side * size[axis] / 2])
        face = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3) + middle
        if side * (EYE - face[0])[axis] > 0:
            faces.append(face)
    return np.vstack(faces)


def halves(points: Array) -> list[str]:
    """The name of the half of the bar that each point lies on."""
    return ["head" if x > AT[0] else "grip" for x in points[:, 0]]


def between_pads(points: Array, world_from_grip: Array) -> np.ndarray:
    """Whether each point lies in the closing region of a hand."""
    local = np.abs(poses.transform(poses.inverse(world_from_grip), points))
    across, along = GRIPPER.pad_width / 2, GRIPPER.pad_length / 2
    return (local <= (across, GRIPPER.opening / 2, along)).all(axis=1)


def test_bar_is_grasped_across_as_wide_as_it_is():
    """Three faces of a bar are enough to close across it, from above, near its middle."""
    best = grasps_on_cloud(seen_box(), table=0.0).grasps[0]

    assert abs(best.world_from_grip[1, 1]) > 0.99
    assert best.width == pytest.approx(SIZE[1], abs=0.002)
    assert np.linalg.norm(best.world_from_grip[:3, 3] - AT) < 0.03


@pytest.mark.parametrize("part", ["grip", "head"])
def test_closing_region_holds_points_of_the_part_only(part: str):
    """Of two halves of a bar none but the one that was asked for is between the pads."""
    points = seen_box()
    labels = halves(points)

    found = grasps_on_cloud(points, labels=labels, part=part, table=0.0).grasps

    assert found
    for grasp in found:
        held = between_pads(points, grasp.world_from_grip)
        assert set(np.array(labels)[held]) == {part}


def test_hand_stays_above_the_table():
    """A table just below the top leaves no grasp, and that is the reason; no table leaves many."""
    points = seen_box()

    low, high = (grasps_on_cloud(points, table=table) for table in (None, 0.039))

    assert len(low.grasps) > 5
    assert not high.grasps
    assert next(iter(high.rejected)) == "below_table"


def test_finger_tips_end_above_the_table():
    """No fingertip of any grasp is lower than the table."""
    found = grasps_on_cloud(seen_box(), table=0.0).grasps

    tips = [(g.world_from_grip @ poses.translation(0, 0, GRIPPER.tip))[2, 3] for g in found]
    assert min(tips) > 0


def test_low_things_are_solid_down_to_the_table(monkeypatch: pytest.MonkeyPatch):
    """Of a low round bar the far side is not seen to its widest place, and yet taken for steep."""
    angle, x = np.meshgrid(np.radians(np.arange(-40, 131, 4)), np.arange(0.44, 0.56, 0.0015))
    arc = np.stack([x, -0.013 * np.cos(angle), 0.01 + 0.009 * np.sin(angle)], axis=-1)

    solid = grasps_on_cloud(arc.reshape(-1, 3), table=0.0).grasps
    monkeypatch.setattr(cloud_grasps, "SOLID", cloud_grasps.FINE_CELL)
    hollow = grasps_on_cloud(arc.reshape(-1, 3), table=0.0).grasps

    assert solid and not hollow
    assert abs(solid[0].world_from_grip[1, 1]) > 0.99


def test_other_things_are_kept_clear_of():
    """Walls on both sides forbid what the bar alone allows."""
    bar, walls = seen_box(), [seen_box((0.5, y, 0.06), (0.2, 0.01, 0.12)) for y in (-0.03, 0.03)]
    points = np.vstack([bar, *walls])
    labels = ["bar"] * len(bar) + ["wall"] * (len(points) - len(bar))

    found = grasps_on_cloud(points, labels=labels, part="bar", others=["wall"], table=0.0)

    assert not any(abs(grasp.world_from_grip[1, 1]) > 0.9 for grasp in found.grasps)
    assert found.rejected["part"] > 0


@settings(max_examples=6, deadline=None, derandomize=True)
@given(turn=st.floats(-3.0, 3.0), x=st.floats(-0.2, 0.2), y=st.floats(-0.2, 0.2))
def test_grasps_move_with_the_cloud(turn: float, x: float, y: float):
    """A cloud turned about the vertical and shifted is held alike, at the same place of it."""
    moved = poses.pose(poses.rotation_about((0, 0, 1), turn), (x, y, 0.0))
    points = seen_box()

    first = grasps_on_cloud(points, table=0.0).grasps[0]
    second = grasps_on_cloud(poses.transform(moved, points), table=0.0).grasps[0]

    expected = moved @ first.world_from_grip
    assert second.score == pytest.approx(first.score, abs=0.08)
    assert second.width == pytest.approx(first.width, abs=0.002)
    assert np.linalg.norm(second.world_from_grip[:3, 3] - expected[:3, 3]) < 0.02
    assert abs(second.world_from_grip[:3, 1] @ expected[:3, 1]) > 0.97


def test_points_of_a_camera_give_grasps_in_the_base():
    """With the pose of its camera a cloud gives the grasps that it gives in the base."""
    camera = Camera("one", (0.9, -0.5, 0.6), AT)
    points = poses.transform(poses.inverse(camera.world_from_camera), seen_box())

    seen = grasps_on_cloud(points, base_from_camera=camera.world_from_camera, table=0.0).grasps
    known = grasps_on_cloud(seen_box(), base_from_camera=np.eye(4), table=0.0).grasps

    # Points that rounding moves to another voxel give other candidates, about as good.
    assert seen[0].score == pytest.approx(known[0].score, abs=0.08)
    assert np.allclose(seen[0].world_from_grip[:3, 3], known[0].world_from_grip[:3, 3], atol=0.02)


@pytest.mark.parametrize(("x", "is_near"), [(0.0, True), (0.8, False)])
def test_grasps_out_of_reach_are_rejected(x: float, is_near: bool):
    """A bar far away leaves no grasp, and its grasps are counted as unreachable."""
    away = poses.translation(x, 0.0, 0.0)

    found = grasps_on_cloud(seen_box(), base_from_camera=away, table=0.0)

    assert bool(found.grasps) == is_near
    assert is_near or found.rejected["unreachable"] > 0


def test_same_seed_gives_the_same_grasps():
    """Nothing but the seed is random."""
    first, second = (grasps_on_cloud(seen_box(), table=0.0, seed=3).grasps for _ in range(2))

    assert np.array_equal(first[0].world_from_grip, second[0].world_from_grip)


BAD = seen_box()
WITH_NAN = np.where(np.arange(len(BAD))[:, None] < 3, np.nan, BAD)
MIRRORED = np.diag([1.0, 1.0, -1.0, 1.0])


@pytest.mark.parametrize(
    ("wrong", "problem"),
    [
        ({"points": BAD * 1000}, "points: spans 120 m; expected at most 10 m. Is it in millimetr"),
        ({"points": WITH_NAN}, f"points: 3 of {len(BAD)} rows are not finite"),
        ({"points": BAD.T}, "points: has the shape"),
        ({"points": BAD[:5]}, "points: 5 to grasp at; expected at least 12"),
        ({"points": BAD[:0]}, "points: 0 to grasp at"),
        ({"labels": ["bar"]}, f"labels: 1 for {len(BAD)} points"),
        ({"base_from_camera": MIRRORED}, "base_from_camera: is not a rigid motion"),
        ({"base_from_camera": 2 * np.eye(4)}, "base_from_camera: is not a rigid motion"),
        ({"base_from_camera": np.eye(3)}, "base_from_camera: has the shape"),
    ],
)
def test_wrong_arrays_are_refused(wrong: dict[str, Any], problem: str):
    """The error names the array, and what is wrong with it."""
    with pytest.raises(DataError, match=problem):
        grasps_on_cloud(**({"points": BAD} | wrong))


@pytest.mark.parametrize("wrong", [{"part": "lid"}, {"others": ["lid"]}])
def test_unknown_label_is_refused_with_those_there_are(wrong: dict[str, Any]):
    """The message lists the labels."""
    with pytest.raises(UnknownNameError, match=r'no label "lid"\. .*Known: grip, head\.'):
        grasps_on_cloud(BAD, labels=halves(BAD), **wrong)


def test_robot_without_gripper_cannot_grasp(tmp_path: Path):
    """It is refused by its name for people."""
    (tmp_path / "pointer.yaml").write_text(POINTER, encoding="utf-8")

    with pytest.raises(SimulationError, match="The Panda without a hand has no gripper"):
        grasps_on_cloud(BAD, robot=str(tmp_path / "pointer.yaml"))


def write_ply(path: Path, points: Array, labels: np.ndarray, kind: str) -> None:
    """Write a .ply file with the property `label`, "ascii" or binary."""
    rows = np.zeros(len(points), [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("label", "<i4")])
    rows["x"], rows["y"], rows["z"] = points.T
    rows["label"] = labels
    properties = "".join(f"property float {axis}\n" for axis in "xyz") + "property int label\n"
    header = f"ply\nformat {kind} 1.0\nelement vertex {len(points)}\n{properties}end_header\n"
    text = "".join(" ".join(map(str, row)) + "\n" for row in rows.tolist())
    path.write_bytes(header.encode() + (text.encode() if kind == "ascii" else rows.tobytes()))


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian"])
def test_ply_file_is_read_with_labels(tmp_path: Path, kind: str):
    """Text and binary files give the points, and the property `label` as text."""
    labels = np.arange(len(BAD)) % 3
    write_ply(tmp_path / "bar.ply", BAD, labels, kind)

    found = read_cloud(tmp_path / "bar.ply")

    assert np.allclose(found["points"], BAD, atol=1e-6)
    assert found["labels"] == labels.astype(str).tolist()


@pytest.mark.parametrize(
    ("arrays", "labels"),
    [
        ({"labels": np.array(["grip", "head"])}, ["grip", "head"]),
        ({"labels": np.array([1, 0]), "names": np.array(["grip", "head"])}, ["head", "grip"]),
        ({"labels": np.array([7, 0]), "names": np.array(["grip"])}, ["7", "grip"]),
        ({}, None),
    ],
)
def test_npz_file_is_read_with_labels(tmp_path: Path, arrays: dict[str, Any], labels: object):
    """Labels are text, or numbers with names; a file without them has none."""
    np.savez(tmp_path / "bar.npz", points=np.zeros((2, 3)), **arrays)

    found = read_cloud(tmp_path / "bar.npz")

    assert found.get("labels") == labels


def test_pose_of_the_camera_is_read_from_a_text_file(tmp_path: Path):
    """Sixteen numbers, a row a line, as numpy writes them."""
    at = poses.translation(0.1, 0.2, 0.3)
    np.savez(tmp_path / "bar.npz", points=BAD)
    np.savetxt(tmp_path / "pose.txt", at)

    found = read_cloud(tmp_path / "bar.npz", tmp_path / "pose.txt")

    assert np.array_equal(found["base_from_camera"], at)


def test_wrong_files_are_refused(tmp_path: Path):
    """The file is named: one without points, one that is no cloud, one that is not there."""
    np.savez(tmp_path / "empty.npz", vertices=BAD)
    (tmp_path / "text.ply").write_text("no cloud", encoding="utf-8")

    with pytest.raises(DataError, match=r'empty\.npz: has no "points"\. It has: vertices\.'):
        read_cloud(tmp_path / "empty.npz")
    for name in ("text.ply", "missing.npz"):
        with pytest.raises(DataError, match=rf"{name}: cannot be read as \.npz or \.ply: "):
            read_cloud(tmp_path / name)


@pytest.mark.sim
@pytest.mark.parametrize(
    ("name", "part", "seed"), [("mug", "handle", 7), ("knife", "handle", 3), ("glass", "stem", 4)]
)
def test_best_grasp_of_one_view_lifts_the_object_by_the_part(name: str, part: str, seed: int):
    """What one camera sees is enough for the simulated hand to lift a thing by the told part."""
    camera = CAMERAS_ROUND_TABLE[1]
    with Body(parse_scene(f"objects:{name}", seed=seed, objects=OBJECTS), OBJECTS, seed=seed) as it:
        image = camera.capture(it.world.engine)
        shown = image.mask(name)
        seen = image.points(shown)
        points = poses.transform(poses.inverse(camera.world_from_camera), seen)
        labels = [image.names[label][1] for label in image.labels[shown]]

        grasps = grasps_on_cloud(
            points, labels=labels, part=part, base_from_camera=camera.world_from_camera, table=0.0
        ).grasps
        path = next(PathPlanner(it.robot, seen, seen[:0]).grasp_paths(grasps))
        before = it.world.pose(name)[2, 3]
        HandMotion(it.robot, MaskDetector(it.world)).grasp(path, force=GRIPPER.force)
        touched = finger_contacts(it.robot)
        it.robot.follow(path.lift, pace=LIFT_PACE)
        it.robot.advance(240)

        assert np.allclose(path.grasp.world_from_grip[:3, 3], grasps[0].world_from_grip[:3, 3])
        assert touched == [{(name, part)}] * 2
        assert it.world.pose(name)[2, 3] - before > 0.1
