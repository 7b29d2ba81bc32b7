"""What is drawn into pictures is where it belongs in the world."""

from dataclasses import replace

import numpy as np

from hilt.sim import poses
from hilt.sim.media.pictures import (
    ACCEPTED,
    CHOSEN,
    FINGER,
    OVERVIEW,
    REJECTED,
    draw_grasps,
    draw_names,
)
from hilt.sim.robot.path_planner import Grasp

CAMERA = replace(OVERVIEW, width=320, height=240)
BLANK = np.full((240, 320, 3), 255, dtype=np.uint8)
DOWNWARD = poses.pose(poses.rotation_from_rpy(np.pi, 0, 0), (0.4, 0.0, 0.1))
GRASP = Grasp(DOWNWARD, 0.06, 0.08, 1.0)


def drawn(picture: np.ndarray) -> np.ndarray:
    """Columns and rows of the pixels that are no longer white (n, 2)."""
    rows, columns = np.nonzero((picture < 250).any(axis=2))
    return np.column_stack([columns, rows])


def test_grasp_is_drawn_where_it_is():
    """The fingers end where the grip frame says, half the opening to each side."""
    picture = draw_grasps(BLANK, CAMERA, {ACCEPTED: [GRASP]})

    tips = poses.transform(DOWNWARD, np.array([[0, -0.04, 0], [0, 0.04, 0], [0, 0.04, -FINGER]]))
    for place in CAMERA.pixels(tips):
        assert np.linalg.norm(drawn(picture) - place, axis=1).min() < 1.5


def test_good_grasps_are_green_and_others_red():
    """What was accepted, what was ruled out and what was taken look different."""
    pictures = [draw_grasps(BLANK, CAMERA, {pen: [GRASP]}) for pen in (ACCEPTED, REJECTED, CHOSEN)]

    good, bad, taken = (picture[tuple(drawn(picture).T[::-1])].mean(axis=0) for picture in pictures)
    assert good[1] > good[0]
    assert bad[0] > bad[1]
    assert len(drawn(pictures[2])) > 1.5 * len(drawn(pictures[0]))
    assert taken.sum() < good.sum()


def test_nothing_behind_the_camera_is_drawn():
    """A grasp at the camera's back leaves the picture as it was."""
    behind = poses.translation(*(2 * np.array(CAMERA.eye) - np.array(CAMERA.target)))

    picture = draw_grasps(BLANK, CAMERA, {ACCEPTED: [replace(GRASP, world_from_grip=behind)]})

    assert (picture == BLANK).all()


def test_names_stand_above_their_places_without_covering_each_other():
    """Two names at one place are written one above the other."""
    place = np.array([0.4, 0.0, 0.0])

    one = draw_names(BLANK, CAMERA, {"mug": place})
    two = draw_names(BLANK, CAMERA, {"mug": place, "cup": place})

    assert drawn(one)[:, 1].max() <= CAMERA.pixels(place[None])[0, 1] + 1
    assert np.ptp(drawn(two)[:, 1]) > np.ptp(drawn(one)[:, 1]) + 8
