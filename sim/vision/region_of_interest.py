"""Rendering of the region of interest: only the window with the objects, and what may hide them.

A preview image of few pixels, without room and robot, shows where the objects are. The window
round them is then rendered at full resolution, and is enlarged as long as an object continues
beyond it. Of the robot only the links that may occlude something in the window are drawn; their
bounding boxes follow from its joints. So the pixels that show objects are those of a full image.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..physics.engine import PhysicsEngine
from ..poses import Array
from .camera import Camera, CameraImage, ImageWindow

PREVIEW_FACTOR = 4  # times fewer pixels along each side
MARGIN = 12  # pixels round what a preview shows
ENLARGEMENT = 60  # pixels by which a window is enlarged
LONGEST = 0.3  # [m] that an object may reach farther away than its part that a preview shows
BULGE = 0.02  # [m] that the visual shape of a link may exceed its collision shape
_CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])  # of a box


@dataclass(frozen=True)
class RegionRenderer:
    """Renders the objects of interest at one moment.

    Attributes:
        engine: the physics engine.
        objects: names of the bodies of interest.
        hidden: names of all other bodies.
        links: body and link of each of the m possible occluders.
        corners: corners of the bounding boxes of the occluders (m, 8, 3), in the world [m].
    """

    engine: PhysicsEngine
    objects: Collection[str]
    hidden: tuple[str, ...]
    links: tuple[tuple[str, str], ...]
    corners: Array

    @classmethod
    def around(
        cls, objects: Collection[str], engine: PhysicsEngine, *, room: Collection[str]
    ) -> RegionRenderer:
        """The region round some bodies; those of the room cannot occlude anything."""
        hidden = tuple(name for name in engine.bodies.names if name not in objects)
        links = tuple(
            (body, link)
            for body in hidden
            if body not in room
            for link in engine.rendering.visible_links(body)
        )
        ends = [np.add(engine.bodies.bounds(*each), [[-BULGE], [BULGE]]) for each in links]
        boxes = np.array(ends).reshape(-1, 2, 3)
        return cls(engine, objects, hidden, links, boxes[:, _CORNERS, [0, 1, 2]])

    def capture(self, camera: Camera) -> CameraImage:
        """Take the window of an image that shows all objects."""
        with self.engine.rendering.hidden(self.hidden):
            preview = camera.downscaled(PREVIEW_FACTOR).capture(self.engine)
        shown = self._object_mask(preview)
        if not shown.any():
            return camera.capture(self.engine, window=ImageWindow(0, 0, 1, 1))
        farthest = float(preview.depth[shown].max()) + LONGEST
        image = self._capture(camera, _window(shown, camera), farthest)
        while enlarged := _enlarged(image, self._object_mask(image)):
            image = self._capture(camera, enlarged, farthest)
        return image

    def _capture(self, camera: Camera, window: ImageWindow, farthest: float) -> CameraImage:
        occluders = self._occluders(window, camera, farthest)
        with self.engine.rendering.hidden(self.hidden, but=occluders):
            return camera.capture(self.engine, window=window)

    def _object_mask(self, image: CameraImage) -> NDArray[np.bool_]:
        """The pixels of an image that show any of the objects (height, width)."""
        labels = [label for label, (body, _) in image.names.items() if body in self.objects]
        return np.isin(image.labels, labels)

    def _occluders(
        self, window: ImageWindow, camera: Camera, farthest: float
    ) -> set[tuple[str, str]]:
        """The links that may lie in a window and nearer than the farthest object [m]."""
        corners = self.corners.reshape(-1, 3)
        depths = (camera.eye - corners) @ camera.world_from_camera[:3, 2]
        near = depths.reshape(-1, 8).min(axis=1, initial=np.inf) <= farthest
        pixels = camera.pixels(corners).reshape(-1, 8, 2)
        first = np.array([window.left, window.top])
        last = first + np.array([window.width, window.height])
        # Behind the camera pixels are NaN and no comparison holds, so that the link is kept.
        outside = (pixels.max(axis=1) < first) | (pixels.min(axis=1) > last)
        found = np.flatnonzero(near & ~outside.any(axis=1))
        return {self.links[index] for index in found}


def _window(shown: NDArray[np.bool_], camera: Camera) -> ImageWindow:
    """The window of a camera round the pixels in which a preview shows objects."""
    rows, columns = (np.flatnonzero(shown.any(axis=axis)) * PREVIEW_FACTOR for axis in (1, 0))
    return _clipped(
        camera,
        (columns[0] - MARGIN, rows[0] - MARGIN),
        (columns[-1] + PREVIEW_FACTOR + MARGIN, rows[-1] + PREVIEW_FACTOR + MARGIN),
    )


def _enlarged(image: CameraImage, shown: NDArray[np.bool_]) -> ImageWindow | None:
    """The window of an image, enlarged where objects reach its edge; None where none does."""
    now = image.window
    top, left, bottom, right = (
        ENLARGEMENT * bool(edge.any()) for edge in (shown[0], shown[:, 0], shown[-1], shown[:, -1])
    )
    enlarged = _clipped(
        image.camera,
        (now.left - left, now.top - top),
        (now.left + now.width + right, now.top + now.height + bottom),
    )
    return None if enlarged == now else enlarged


def _clipped(camera: Camera, first: tuple[int, int], last: tuple[int, int]) -> ImageWindow:
    """The window between two corners (column, row), clipped to the image."""
    (left, right), (top, bottom) = (
        (max(0, int(low)), min(size, int(high)))
        for low, high, size in zip(first, last, (camera.width, camera.height), strict=True)
    )
    return ImageWindow(left, top, right - left, bottom - top)
