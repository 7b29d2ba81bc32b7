"""Grasps planned on synthetic clouds: of the target part only, clear of everything else."""

from __future__ import annotations

import numpy as np
import pytest

from hilt.sim import poses
from hilt.sim.grasping.context import LabelledPointCloud, PointLabel
from hilt.sim.grasping.planner import RankedGrasps, plan_grasps
from hilt.sim.grasping.sampling import BIN, sample_grasps
from hilt.sim.grasping.scoring import REJECTIONS, gravity_lever, hits_table, score_grasps
from hilt.sim.poses import Array
from hilt.sim.robot.models import find_robot

panda = find_robot("panda").gripper
assert panda is not None
GRIPPER = panda
DOWN = poses.rotation_about((1, 0, 0), np.pi)
NOTHING = np.zeros((0, 3))
BAR = (0.5, 0.0, 0.012)  # middle of a bar that lies on the table [m]


def box(middle: tuple[float, float, float], size: tuple[float, float, float]) -> Array:
    """Points on all faces of a box but the bottom one, which no camera sees."""
    axes = [
        np.linspace(-s / 2, s / 2, max(2, round(s / 0.0015) + 1)) + m
        for m, s in zip(middle, size, strict=True)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    low, high = grid.min(axis=0), grid.max(axis=0)
    sides = np.any(np.isclose(grid[:, :2], low[:2]) | np.isclose(grid[:, :2], high[:2]), axis=1)
    return grid[sides | np.isclose(grid[:, 2], high[2])]


def labelled(
    target: Array,
    *,
    other_parts: Array = NOTHING,
    neighbours: Array = NOTHING,
    table: float,
    centre_of_mass: Array,
    mass: float,
) -> LabelledPointCloud:
    """Clouds of the part, of the other parts of the object, and of other objects."""
    groups = [target, other_parts, neighbours]
    labels = np.repeat(np.array(list(PointLabel)), [len(group) for group in groups])
    return LabelledPointCloud(np.vstack(groups), labels, table, centre_of_mass, mass)


def bar(
    *, width: float = 0.02, others: Array = NOTHING, near: Array = NOTHING
) -> LabelledPointCloud:
    """A bar of 10 cm that lies along x."""
    cloud = box(BAR, (0.1, width, 0.022))
    return labelled(
        cloud,
        other_parts=others,
        neighbours=near,
        table=0.0,
        centre_of_mass=np.array(BAR),
        mass=0.1,
    )


def plan(cloud: LabelledPointCloud, seed: int = 0) -> RankedGrasps:
    """The grasps of a part."""
    return plan_grasps(cloud, GRIPPER, rng=np.random.default_rng(seed))


def hand_over_bar(*, turn: float = 0.0, aside: float = 0.0) -> Array:
    """A hand that looks straight down on the bar and closes across it."""
    rotation = poses.rotation_about((0, 0, 1), turn) @ DOWN
    return poses.pose(rotation, (BAR[0], BAR[1] + aside, BAR[2]))[None]


def test_bar_is_grasped_across_at_its_middle():
    """The best grasp closes across the bar, near its centre of mass, from above."""
    best = plan(bar()).grasps[0]

    assert abs(best.world_from_grip[1, 1]) > 0.99
    assert best.world_from_grip[2, 2] < -0.85
    assert np.linalg.norm(best.world_from_grip[:3, 3] - BAR) < 0.02
    assert best.width == pytest.approx(0.02, abs=0.001)


@pytest.mark.parametrize("seed", range(4))
def test_grasps_come_best_first_and_are_worth_trying(seed: int):
    """Scores fall, and none is at or below zero."""
    scores = [grasp.score for grasp in plan(bar(), seed).grasps]

    assert len(scores) > 5
    assert scores == sorted(scores, reverse=True)
    assert min(scores) > 0


def test_same_seed_gives_the_same_grasps():
    """A plan depends on the cloud and the seed, on nothing else."""
    first, second = plan(bar(), 3), plan(bar(), 3)

    assert all(
        np.array_equal(a.world_from_grip, b.world_from_grip)
        for a, b in zip(first.grasps, second.grasps, strict=True)
    )


def test_other_part_is_never_between_the_pads():
    """With another part on one half of the bar, all grasps keep to the other half."""
    half = box((0.525, 0.0, 0.012), (0.05, 0.02, 0.022))
    target = box((0.475, 0.0, 0.012), (0.05, 0.02, 0.022))
    scene = labelled(target, other_parts=half, table=0.0, centre_of_mass=np.array(BAR), mass=0.1)

    found = plan(scene).grasps

    assert found
    for grasp in found:
        local = poses.transform(poses.inverse(grasp.world_from_grip), half)
        in_band = np.abs(local[:, 0]) <= GRIPPER.pad_width / 2 + 0.003
        assert not np.any(in_band & (local[:, 2] < GRIPPER.tip))


def test_part_wider_than_the_hand_is_too_wide():
    """A cube of 10 cm leaves no grasp, and the reason is its width."""
    cube = box((0.5, 0.0, 0.05), (0.1, 0.1, 0.1))
    scene = labelled(cube, table=0.0, centre_of_mass=np.array((0.5, 0, 0.05)), mass=0.5)

    found = plan(scene)

    assert not found.grasps
    assert found.reason == "too_wide"


def test_part_walled_in_by_others_is_blocked():
    """Where neighbours stand close on both sides, no finger finds room."""
    walls = np.vstack([box((0.5, y, 0.06), (0.2, 0.01, 0.12)) for y in (-0.022, 0.022)])
    lids = np.vstack([box((x, 0.0, 0.06), (0.01, 0.03, 0.12)) for x in (0.44, 0.56)])

    found = plan(bar(near=np.vstack([walls, lids])))

    assert not found.grasps
    assert found.reason == "blocked"


@pytest.mark.parametrize(
    ("rejected", "reason"),
    [
        ({"below_table": 9}, ""),
        ({"below_table": 9, "too_wide": 2, "slope": 1}, "too_wide"),
        ({"too_wide": 2, "slope": 2}, "no_grasp"),
    ],
)
def test_poses_below_the_table_are_no_reason(rejected: dict[str, int], reason: str):
    """The reason is that of most poses that could have been taken above the table."""
    assert RankedGrasps((), rejected).reason == reason


def test_part_hardly_seen_gives_no_grasp_and_no_reason():
    """Too few points give an empty plan."""
    few = labelled(np.zeros((3, 3)), table=0.0, centre_of_mass=np.zeros(3), mass=0.1)

    found = plan(few)

    assert found == RankedGrasps((), {})
    assert found.reason == ""


def test_candidate_fingers_come_down_beside_all_points():
    """Between the fingers is the bar; where they are, from their tips upwards, is no point."""
    block = box((0.5, 0.04, 0.012), (0.03, 0.02, 0.022))
    around = bar(near=block).downsampled(0.0035, reach=0.15, limit=2000)

    at, width, _ = sample_grasps(around, GRIPPER, rng=np.random.default_rng(2), count=20)

    local = (around.points - at[:, None, :3, 3]) @ at[:, :3, :3]
    aside = np.abs(local[..., 1]) - width[:, None] / 2
    on_finger = np.abs(local[..., 0]) < GRIPPER.finger_width / 2 - BIN
    on_finger &= (aside > BIN) & (aside < GRIPPER.finger_thickness)
    assert len(width) > 100
    assert not (on_finger & (local[..., 2] < GRIPPER.tip)).any()


def test_scoring_centres_the_hand_on_the_part():
    """A hand that is off the middle is moved there along its closing direction."""
    scores = score_grasps(hand_over_bar(aside=0.004), np.array([0.02]), bar(), GRIPPER)

    assert REJECTIONS[scores.rejection[0]] == ""
    assert scores.world_from_grip[0, 1, 3] == pytest.approx(0.0, abs=5e-4)


def test_twist_turns_the_hand_to_the_faces():
    """Turning a hand about its approach by the twist lays the pads flat."""
    turned = score_grasps(hand_over_bar(turn=0.1), np.array([0.02]), bar(), GRIPPER)

    straight = turned.world_from_grip[0, :3, :3] @ poses.rotation_about((0, 0, 1), turned.twist[0])

    assert abs(straight[1, 1]) > np.cos(0.03)


def test_slope_leads_to_the_widest_place():
    """On a disc beside its middle, slope times half the width leads to the middle."""
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    rim = np.column_stack([0.5 + 0.03 * np.cos(angle), 0.03 * np.sin(angle), 0 * angle])
    disc = np.vstack([rim + np.array((0, 0, z)) for z in np.linspace(0.005, 0.02, 12)])
    scene = labelled(disc, table=0.0, centre_of_mass=np.array((0.5, 0, 0.01)), mass=0.1)
    beside = poses.pose(DOWN, (0.508, 0.0, 0.012))[None]

    scores = score_grasps(beside, np.array([0.06]), scene, GRIPPER)
    moved = beside[0] @ poses.translation(scores.slope[0, 0] * scores.width[0] / 2, 0, 0)

    assert moved[0, 3] == pytest.approx(0.5, abs=0.003)


def test_part_reached_by_the_ends_of_the_pads_only_is_held_worse():
    """A hand that just reaches a plate scores less than one 3 mm deeper, all else alike."""
    plate = box((0.5, 0.0, 0.03), (0.1, 0.02, 0.002))
    scene = labelled(plate, table=0.0, centre_of_mass=np.array((0.5, 0, 0.03)), mass=0.1)
    bottom = 0.029 + GRIPPER.pad_length / 2  # height of the grip when the pads end with the plate
    hands = np.stack([poses.pose(DOWN, (0.5, 0, bottom - z)) for z in (0.0, 0.003)])

    shallow, deep = score_grasps(hands, np.full(2, 0.02), scene, GRIPPER).score

    assert 0 < shallow < 0.7 * deep


def test_object_that_would_turn_in_the_hand_is_not_rejected():
    """A heavy bar held far from its middle scores little, but more than nothing."""
    far = labelled(bar().target, table=0.0, centre_of_mass=np.array((0.6, 0.0, 0.012)), mass=0.6)

    near_middle, far_from_it = (
        score_grasps(hand_over_bar(), np.array([0.02]), scene, GRIPPER).score[0]
        for scene in (bar(), far)
    )

    assert 0 < far_from_it < 0.3 * near_middle


def test_hand_lower_than_the_table_hits_it():
    """The tips end a centimetre below the grip frame."""
    low, high = (poses.pose(DOWN, (0.5, 0, z))[None] for z in (0.009, 0.012))

    assert hits_table(low, np.array([0.03]), 0.0, GRIPPER).all()
    assert not hits_table(high, np.array([0.03]), 0.0, GRIPPER).any()


def test_weight_turns_a_object_held_at_its_end_only():
    """The lever is the level distance across the closing direction."""
    hand = poses.pose(DOWN, (0.5, 0, 0))[None]
    along, across = np.array([[0.1, 0, 0]]), np.array([[0, 0.1, 0]])

    assert gravity_lever(hand, along)[0] == pytest.approx(0.1)
    assert gravity_lever(hand, across)[0] == pytest.approx(0.0, abs=1e-9)


def test_downsampled_cloud_keeps_labels_and_stays_below_the_limit():
    """However dense the cloud, about so many points remain, of each kind some."""
    scene = bar(others=box((0.6, 0, 0.012), (0.05, 0.02, 0.022)))

    fewer = scene.downsampled(0.001, reach=0.2, limit=500)

    assert np.bincount(fewer.labels).max() <= 500
    assert {PointLabel.TARGET, PointLabel.OTHER_PART} == set(fewer.labels)
