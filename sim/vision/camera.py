# SPDX-License-Identifier: Apache-2.0
"""Cameras: from where they look, what they deliver, and the points in the world behind the pixels.

Pinhole cameras after OpenGL: the camera looks along its -z axis, x goes right and y up; pixel rows
count from the top. A `CameraImage` is what one camera delivers at one moment: colours, depths
in [m] and, as the simulator's stand-in for a perfect detector, which link every pixel shows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import radians, tan

import numpy as np
from numpy.typing import NDArray

from .. import poses
from ..physics.engine import PhysicsEngine
from ..physics.types import Light
from ..poses import Array

NEAR, FAR = 0.05, 6.0  # [m], what a camera can see at all
# Where in its pixel the renderer looks, from the upper left corner: the lower left one. Half a
# pixel would be 1 mm on the table, in another direction for each camera.
SAMPLE = (0.0, 1.0)
VISION_LIGHT = Light(ambient=0.6, diffuse=0.4, specular=0.05, shadow=False)

_WATCHED = (0.49, 0.0, 0.03)  # [m], the middle of where objects stand
_EYES = (
    (1.12, -0.55, 0.72),
    (1.12, 0.55, 0.72),
    (0.30, -0.82, 0.70),
    (0.30, 0.82, 0.70),
)  # [m], round the table, two of them facing the robot


@dataclass(frozen=True)
class Window:
    """A part of an image, in its pixels.

    Attributes:
        left, top: its first column and row.
        width, height: how many there are of them.
    """

    left: int
    top: int
    width: int
    height: int


@dataclass(frozen=True)
class Camera:
    """One camera.

    Attributes:
        name: to tell it from others.
        eye: where it is [m].
        target: what it looks at [m].
        field: angle of view from bottom to top [rad].
        width: of the image in pixels.
        height: of the image in pixels.
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
        focal = 1 / tan(self.field / 2)
        depth, product = NEAR - FAR, NEAR * FAR
        return np.array(
            [
                [focal * self.height / self.width, 0, 0, 0],
                [0, focal, 0, 0],
                [0, 0, (FAR + NEAR) / depth, 2 * product / depth],
                [0, 0, -1, 0],
            ]
        )

    @property
    def focal(self) -> float:
        """The focal length in pixels."""
        return self.height / 2 / tan(self.field / 2)

    def depths(self, points: Array) -> Array:
        """How far before the camera points (n, 3) of the world are (n,) [m]."""
        return -poses.transform(poses.inverse(self.world_from_camera), points)[:, 2]

    def pixels(self, points: Array) -> Array:
        """Where points (n, 3) of the world appear: column, row (n, 2); NaN behind the camera."""
        seen = poses.transform(poses.inverse(self.world_from_camera), points)
        ahead = np.where(seen[:, 2] < -NEAR, -seen[:, 2], np.nan)
        column = self.width / 2 + self.focal * seen[:, 0] / ahead
        row = self.height / 2 - self.focal * seen[:, 1] / ahead
        return np.column_stack([column, row])

    @property
    def whole(self) -> Window:
        """All of its image."""
        return Window(0, 0, self.width, self.height)

    def coarser(self, times: int) -> Camera:
        """The same with so many times fewer pixels to each side."""
        return replace(self, width=self.width // times, height=self.height // times)

    def look(
        self, engine: PhysicsEngine, *, light: Light = VISION_LIGHT, window: Window | None = None
    ) -> CameraImage:
        """What it sees now, or of that what is in a window of its image."""
        window = window or self.whole
        view = poses.inverse(self.world_from_camera)
        projection = self._through(window) @ self.projection
        image = engine.rendering.render(view, projection, window.width, window.height, light=light)
        depth = FAR * NEAR / (FAR - (FAR - NEAR) * image.depth)
        return CameraImage(self, image.colour, depth, image.labels, image.names, window)

    def _through(self, window: Window) -> Array:
        """What moves and widens the image so that the window fills it (4, 4)."""
        wider, higher = self.width / window.width, self.height / window.height
        across = 1 - 2 * (window.left + window.width / 2) / self.width
        upwards = 2 * (window.top + window.height / 2) / self.height - 1
        result = np.diag([wider, higher, 1.0, 1.0])
        result[:2, 3] = wider * across, higher * upwards
        return result


@dataclass(frozen=True)
class CameraImage:
    """What one camera saw at one moment, in a window of its image.

    Attributes:
        camera: which one.
        colour: (height, width, 3) uint8.
        depth: distance along the line of sight's z axis, (height, width) [m].
        labels: (height, width) int32; what each pixel shows.
        names: label -> (body, link); pixels of nothing have a label that is not in here.
        window: which part of the image that is.
    """

    camera: Camera
    colour: NDArray[np.uint8]
    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
    names: Mapping[int, tuple[str, str]]
    window: Window

    def mask(self, body: str, link: str | None = None) -> NDArray[np.bool_]:
        """Which pixels show a body, or one of its links, (height, width)."""
        wanted = [
            label
            for label, (each, part) in self.names.items()
            if each == body and link in {None, part}
        ]
        return np.isin(self.labels, wanted)

    def points(self, mask: NDArray[np.bool_]) -> Array:
        """The points in the world behind the pixels of a mask (n, 3) [m]."""
        rows, columns = np.nonzero(mask)
        camera = self.camera
        depth = self.depth[rows, columns].astype(np.float64)
        across = (columns + self.window.left + SAMPLE[0] - camera.width / 2) / camera.focal
        upwards = (camera.height / 2 - rows - self.window.top - SAMPLE[1]) / camera.focal
        seen = np.column_stack([across * depth, upwards * depth, -depth])
        return poses.transform(camera.world_from_camera, seen)


def cameras_round_table(*, width: int = 640, height: int = 480) -> tuple[Camera, ...]:
    """The cameras that vision uses: four round the table."""
    return tuple(
        Camera(f"camera {i + 1}", eye, _WATCHED, width=width, height=height)
        for i, eye in enumerate(_EYES)
    )
