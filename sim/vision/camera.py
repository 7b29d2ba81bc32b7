"""Pinhole cameras, the images they deliver, and the points in the world behind the pixels.

Cameras follow OpenGL: they look along their -z axis, x points right and y up; pixel rows count
from the top. A `CameraImage` holds colours, depths in [m] and a segmentation mask: which link of
which body every pixel shows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import radians, tan

import numpy as np
from numpy.typing import NDArray

from .. import poses
from ..physics.engine import PhysicsEngine
from ..physics.rendering import Lighting
from ..poses import Array

NEAR, FAR = 0.05, 6.0  # [m], clipping planes
# Where the renderer samples a pixel, from its upper left corner: at the lower left one. An error
# of half a pixel would be 1 mm on the table, in another direction for each camera.
SAMPLE = (0.0, 1.0)
VISION_LIGHT = Lighting(ambient=0.6, diffuse=0.4, specular=0.05, shadow=False)

_TARGET = (0.49, 0.0, 0.03)  # [m], the middle of where objects stand
_POSITIONS = (
    (1.12, -0.55, 0.72),
    (1.12, 0.55, 0.72),
    (0.30, -0.82, 0.70),
    (0.30, 0.82, 0.70),
)  # [m], round the table, two of them facing the robot


@dataclass(frozen=True)
class Camera:
    """One camera.

    Attributes:
        name: name, unique among the cameras of a scene.
        eye: position x, y, z of the camera [m].
        target: point x, y, z that it looks at [m].
        field: vertical angle of view [rad].
        width, height: of the image [pixels].
    """

    name: str
    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    field: float = radians(46)
    width: int = 640
    height: int = 480

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
        result = np.diag([2 * self.focal / self.width, 2 * self.focal / self.height, 0, 0])
        result[2, 2:] = np.array([FAR + NEAR, 2 * FAR * NEAR]) / (NEAR - FAR)
        result[3, 2] = -1
        return result

    @property
    def focal(self) -> float:
        """The focal length in pixels."""
        return self.height / 2 / tan(self.field / 2)

    def pixels(self, points: Array) -> Array:
        """Pixels, column and row (n, 2), of points (n, 3) of the world; NaN behind the camera."""
        seen = poses.transform(poses.inverse(self.world_from_camera), points)
        ahead = np.where(seen[:, 2] < -NEAR, -seen[:, 2], np.nan)
        column = self.width / 2 + self.focal * seen[:, 0] / ahead
        row = self.height / 2 - self.focal * seen[:, 1] / ahead
        return np.column_stack([column, row])

    def capture(self, engine: PhysicsEngine, *, light: Lighting = VISION_LIGHT) -> CameraImage:
        """Take an image."""
        view = poses.inverse(self.world_from_camera)
        colour, depth, labels, names = engine.rendering.render(
            view, self.projection, self.width, self.height, light=light
        )
        depth = FAR * NEAR / (FAR - (FAR - NEAR) * depth)
        return CameraImage(self, colour, depth, labels, names)


@dataclass(frozen=True)
class CameraImage:
    """An image of one camera.

    Attributes:
        colour: red, green and blue of each pixel (height, width, 3), in 0..255.
        depth: depth along the camera's z axis (height, width) [m].
        labels: label of what each pixel shows (height, width).
        names: body and link of each label, without that of empty pixels.
    """

    camera: Camera
    colour: NDArray[np.uint8]
    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
    names: Mapping[int, tuple[str, str]]

    def mask(self, body: str, link: str | None = None) -> NDArray[np.bool_]:
        """The pixels that show a body, or one of its links (height, width)."""
        shown = self.names.items()
        wanted = [label for label, (b, part) in shown if b == body and link in {None, part}]
        return np.isin(self.labels, wanted)

    def points(self, mask: NDArray[np.bool_]) -> Array:
        """The points in the world behind the pixels of a mask (n, 3) [m]."""
        rows, columns = np.nonzero(mask)
        camera = self.camera
        depth = self.depth[rows, columns].astype(np.float64)
        across = (columns + SAMPLE[0] - camera.width / 2) / camera.focal
        upwards = (camera.height / 2 - rows - SAMPLE[1]) / camera.focal
        seen = np.column_stack([across * depth, upwards * depth, -depth])
        return poses.transform(camera.world_from_camera, seen)


CAMERAS_ROUND_TABLE = tuple(
    Camera(f"camera {number}", eye, _TARGET) for number, eye in enumerate(_POSITIONS, start=1)
)
