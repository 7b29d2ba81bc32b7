"""Cameras: pixels and the points behind them."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.ontology.errors import DataError
from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.models.object_models import object_model
from hilt.sim.physics.engine import PhysicsEngine
from hilt.sim.vision.camera import CAMERAS_ROUND_TABLE, SAMPLE, Camera, CameraImage, load_cameras

CAMERA = Camera("test", (0.8, -0.5, 0.6), (0.0, 0.0, 0.0))
CALIBRATED = replace(CAMERA, calibration=(612.3, 598.7, 331.5, 226.2))
BLOCK = object_model(load_objects()["block"])
coordinates = st.floats(-0.3, 0.3)


@pytest.fixture(scope="module", params=[CAMERA, CALIBRATED], ids=["ideal", "calibrated"])
def view(request: pytest.FixtureRequest) -> Iterator[CameraImage]:
    """A block seen by a camera."""
    with PhysicsEngine() as engine:
        engine.bodies.load("block", BLOCK.urdf, fixed=True)
        yield request.param.capture(engine)


@given(coordinates, coordinates, coordinates)
def test_projection_and_pixels_agree(x: float, y: float, z: float):
    """A point appears where the OpenGL projection puts it."""
    point = np.array([[x, y, z]])

    seen = poses.transform(poses.inverse(CAMERA.world_from_camera), point)[0]
    clip = CAMERA.projection @ (*seen, 1.0)
    expected = (
        (clip[0] / clip[3] + 1) / 2 * CAMERA.width,
        (1 - clip[1] / clip[3]) / 2 * CAMERA.height,
    )

    assert CAMERA.pixels(point)[0] == pytest.approx(expected)


def test_target_is_in_the_middle():
    """A camera sees what it looks at in the middle of its image."""
    assert CAMERA.pixels(np.array([CAMERA.target]))[0] == pytest.approx((320, 240))


def test_what_is_behind_has_no_pixel():
    """A point behind the camera has no pixel."""
    assert np.isnan(CAMERA.pixels(np.array([[1.6, -1.0, 1.2]]))).all()


def test_camera_may_look_straight_down():
    """Looking down, x of the world points up in the image."""
    camera = Camera("top", (0.4, 0.0, 1.0), (0.4, 0.0, 0.0))

    (column, row), middle = camera.pixels(np.array([[0.5, 0, 0], [0.4, 0, 0]]))

    assert column == pytest.approx(middle[0])
    assert row < middle[1]


@pytest.mark.sim
def test_points_lie_on_the_surface(view: CameraImage):
    """The points behind the pixels of a block are on its faces, to a tenth of a millimetre."""
    points = view.points(view.mask("block"))

    low, high = BLOCK.points.min(axis=0), BLOCK.points.max(axis=0)
    outside = np.maximum(low - points, points - high).max(axis=1)
    assert len(points) > 4000
    assert np.abs(outside).max() < 0.003  # on the bevel
    assert np.quantile(np.abs(outside), 0.9) < 0.0001


@pytest.mark.sim
def test_points_return_to_their_pixels(view: CameraImage):
    """Seen again by the same camera, a point is in the pixel that it came from."""
    mask = view.mask("block", "body")

    pixels = view.camera.pixels(view.points(mask))

    rows, columns = np.nonzero(mask)
    assert pixels == pytest.approx(np.column_stack([columns, rows]) + SAMPLE, abs=0.01)


@pytest.mark.sim
def test_mask_of_what_is_not_there_is_empty(view: CameraImage):
    """Nothing shows a body that does not exist."""
    assert not view.mask("mug").any()
    assert not view.mask("block", "handle").any()


def test_four_cameras_watch_the_table():
    """The middle of the table is in the image of every camera that vision uses."""
    cameras = CAMERAS_ROUND_TABLE

    pixels = np.vstack([camera.pixels(np.array([[0.5, 0.0, 0.0]])) for camera in cameras])

    assert len(cameras) == 4
    assert ((pixels > (200, 150)) & (pixels < (440, 330))).all()


def test_cameras_of_ones_own_are_read(tmp_path: Path):
    """With the intrinsics of their calibration."""
    file = tmp_path / "cameras.yaml"
    file.write_text(
        "d435: {eye: [1.0, 0, 0.7], target: [0.5, 0, 0], size: [848, 480],"
        " intrinsics: [425.2, 424.9, 421.7, 238.4]}"
    )

    [camera] = load_cameras(file)

    assert (camera.name, camera.width, camera.height) == ("d435", 848, 480)
    assert camera.intrinsics == (425.2, 424.9, 421.7, 238.4)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("one: {eye: [1, 0, 1], size: [640, 480]}", r':1:6: the key "target" is missing'),
        ("one: {eye: [1, 0], target: [0, 0, 0], size: [640, 480]}", "expected 3 numbers, found 2"),
        ("one: {eye: [1, 0, 1], target: [0, 0, 0], size: [4, 4]}", r"expected a number in \[16"),
    ],
)
def test_wrong_camera_is_an_error(tmp_path: Path, text: str, error: str):
    """With its place."""
    (tmp_path / "cameras.yaml").write_text(text)

    with pytest.raises(DataError, match=error):
        load_cameras(tmp_path / "cameras.yaml")
