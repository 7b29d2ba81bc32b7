"""Pinhole cameras, the images they deliver, and the points in the world behind the pixels.

Cameras follow OpenGL: they look along their -z axis, x points right and y up; pixel rows count
from the top. A `CameraImage` holds colours, depths [m] and a mask of the links that pixels show.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import radians, tan
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...ontology.part_shapes import read_point
from ...ontology.yaml_reader import read_yaml
from .. import poses
from ..physics.engine import PhysicsEngine
from ..physics.rendering import Lighting
from ..poses import Array

NEAR, FAR = 0.05, 6.0  # [m], clipping planes
# Where the renderer samples a pixel, from its upper left corner: at the lower left one. An error
# of half a pixel would be 1 mm on the table, in another direction for each camera.
SAMPLE = (0.0, 1.0)
Pixels: TypeAlias = NDArray[np.integer[Any]]
VISION_LIGHT = Lighting(ambient=0.6, diffuse=0.4, specular=0.05, shadow=False)


@dataclass(frozen=True)
class Camera:
    """One camera."""

    name: str  #: name, unique among the cameras of a scene
    eye: tuple[float, float, float]  #: position x, y, z of the camera [m]
    target: tuple[float, float, float]  #: point x, y, z that it looks at [m]
    field: float = radians(46)  #: vertical angle of view [rad]
    width: int = 640  #: of the image [pixels]
    height: int = 480  #: the same
    calibration: tuple[float, ...] = ()  #: its `intrinsics`, which go before the field; or none

    @cached_property
    def world_from_camera(self) -> Array:
        """The pose of the camera (4, 4); upright unless it looks straight down."""
        ahead = np.subtract(self.target, self.eye)
        ahead = ahead / np.linalg.norm(ahead)
        up = np.array([0.0, 0.0, 1.0]) if abs(ahead[2]) < 0.999 else np.array([1.0, 0.0, 0.0])
        right = np.cross(ahead, up)
        right /= np.linalg.norm(right)
        return poses.pose(np.column_stack([right, np.cross(right, ahead), -ahead]), self.eye)

    @cached_property
    def projection(self) -> Array:
        """The OpenGL projection matrix (4, 4)."""
        (fx, fy, cx, cy), (width, height) = self.intrinsics, (self.width, self.height)
        result = np.diag([2 * fx / width, 2 * fy / height, 0, 0])
        result[:2, 2] = 1 - 2 * cx / width, 2 * cy / height - 1
        result[2, 2:] = np.array([FAR + NEAR, 2 * FAR * NEAR]) / (NEAR - FAR)
        result[3, 2] = -1
        return result

    @cached_property
    def intrinsics(self) -> tuple[float, ...]:
        """The focal lengths fx and fy, and column cx and row cy of the optical axis [pixels]."""
        focal = self.height / 2 / tan(self.field / 2)
        return self.calibration or (focal, focal, self.width / 2, self.height / 2)

    def slopes(self, rows: Pixels, columns: Pixels) -> tuple[Array, Array]:
        """How far to the right and upwards pixels (n,) look, per metre of depth."""
        fx, fy, cx, cy = self.intrinsics
        right, down = columns.astype(np.float64) + SAMPLE[0], rows.astype(np.float64) + SAMPLE[1]
        return (right - cx) / fx, (cy - down) / fy

    def pixels(self, points: Array) -> Array:
        """Pixels, column and row (n, 2), of points (n, 3) of the world; NaN behind the camera."""
        seen = poses.transform(poses.inverse(self.world_from_camera), points)
        ahead = np.where(seen[:, 2] < -NEAR, -seen[:, 2], np.nan)
        fx, fy, cx, cy = self.intrinsics
        return np.column_stack([cx + fx * seen[:, 0] / ahead, cy - fy * seen[:, 1] / ahead])

    def capture(self, engine: PhysicsEngine, *, light: Lighting = VISION_LIGHT) -> "CameraImage":
        """Take an image."""
        view = poses.inverse(self.world_from_camera)
        colour, depth, labels, names = engine.rendering.render(
            view, self.projection, self.width, self.height, light=light
        )
        depth = FAR * NEAR / (FAR - (FAR - NEAR) * depth)
        return CameraImage(self, colour, depth, labels, names)


@dataclass(frozen=True)
class CameraImage:
    """An image of one camera."""

    camera: Camera
    colour: NDArray[np.uint8]  #: red, green and blue of each pixel (height, width, 3), in 0..255
    depth: NDArray[np.float32]  #: depth along the camera's z axis (height, width) [m]
    labels: NDArray[np.int32]  #: label of what each pixel shows (height, width)
    names: Mapping[int, tuple[str, str]]  #: body and link of each label but that of empty pixels

    def mask(self, body: str, link: str | None = None) -> NDArray[np.bool_]:
        """The pixels that show a body, or one of its links (height, width)."""
        shown = self.names.items()
        wanted = [label for label, (b, part) in shown if b == body and link in {None, part}]
        return np.isin(self.labels, wanted)

    def points(self, mask: NDArray[np.bool_]) -> Array:
        """The points in the world behind the pixels of a mask (n, 3) [m]."""
        rows, columns = np.nonzero(mask)
        depth = self.depth[rows, columns].astype(np.float64)
        across, upwards = self.camera.slopes(rows, columns)
        seen = np.column_stack([across * depth, upwards * depth, -depth])
        return poses.transform(self.camera.world_from_camera, seen)


def load_cameras(path: Path) -> tuple[Camera, ...]:
    """Read cameras from a YAML file such as `cameras.yaml`; DataError if it is wrong."""
    cameras: list[Camera] = []
    for name, spec in read_yaml(path).entries().items():
        keys = spec.entries(required={"eye", "target", "size"}, optional={"intrinsics"})
        eye, target = (read_point(keys[key]) for key in ("eye", "target"))
        width, height = map(int, keys["size"].numbers(count=2, low=16, high=4096))
        given = keys["intrinsics"].numbers(count=4, low=1) if "intrinsics" in keys else ()
        cameras.append(Camera(name, eye, target, width=width, height=height, calibration=given))
    return tuple(cameras)


CAMERAS_ROUND_TABLE = load_cameras(Path(__file__).parent / "cameras.yaml")
