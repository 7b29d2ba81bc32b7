# SPDX-License-Identifier: Apache-2.0
"""Attention: of an image only that part is taken in which things are, and what may hide them.

A glance, an image of few pixels without room and robot, tells where things are. The window round
them is then looked at with all pixels, and is widened as long as something goes on beyond it. Of
the robot those links are drawn that may be before something in the window: where they are, its
joints tell. So the pixels that show things are the same as in the whole image.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..physics.engine import PhysicsEngine
from ..poses import Array
from .camera import Camera, CameraImage, Window

GLANCE = 4  # times fewer pixels to each side
MARGIN = 12  # pixels round what a glance shows
FURTHER = 60  # pixels by which a window is widened
LONGEST = 0.3  # [m] that a thing may reach farther away than its part that a glance shows
BULGE = 0.02  # [m] that a link may be seen to stand out of what is felt of it
_CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])  # of a box


@dataclass(frozen=True)
class Attention:
    """Looks for things at one moment.

    Attributes:
        engine: where they are.
        things: the bodies that are looked for.
        unseen: all other bodies.
        links: body and link of what may hide things; m of them.
        corners: of boxes round them (m, 8, 3), in the world [m].
    """

    engine: PhysicsEngine
    things: Collection[str]
    unseen: tuple[str, ...]
    links: tuple[tuple[str, str], ...]
    corners: Array

    @classmethod
    def on(
        cls, things: Collection[str], engine: PhysicsEngine, *, room: Collection[str]
    ) -> Attention:
        """Attention on things among bodies, of which those of the room hide nothing."""
        unseen = tuple(name for name in engine.bodies.names if name not in things)
        links = tuple(
            (body, link)
            for body in unseen
            if body not in room
            for link in engine.rendering.visible_links(body)
        )
        ends = [np.add(engine.bodies.bounds(*each), [[-BULGE], [BULGE]]) for each in links]
        boxes = np.array(ends).reshape(-1, 2, 3)
        return cls(engine, things, unseen, links, boxes[:, _CORNERS, [0, 1, 2]])

    def look(self, camera: Camera) -> CameraImage:
        """What a camera sees of the things, in a window round all of them."""
        with self.engine.rendering.hidden(self.unseen):
            glance = camera.coarser(GLANCE).look(self.engine)
        shown = self._shown(glance)
        if not shown.any():
            return camera.look(self.engine, window=Window(0, 0, 1, 1))
        farthest = float(glance.depth[shown].max()) + LONGEST
        view = self._look(camera, _window(shown, camera), farthest)
        while wider := _widened(view, self._shown(view)):
            view = self._look(camera, wider, farthest)
        return view

    def _look(self, camera: Camera, window: Window, farthest: float) -> CameraImage:
        """What a camera sees in a window, in which nothing is farther away than that [m]."""
        with self.engine.rendering.hidden(self.unseen, but=self._before(window, camera, farthest)):
            return camera.look(self.engine, window=window)

    def _shown(self, view: CameraImage) -> NDArray[np.bool_]:
        """Which pixels of a view show any of the things (height, width)."""
        labels = [label for label, (body, _) in view.names.items() if body in self.things]
        return np.isin(view.labels, labels)

    def _before(self, window: Window, camera: Camera, farthest: float) -> set[tuple[str, str]]:
        """What may be before a window, nearer than the farthest thing [m]."""
        corners = self.corners.reshape(-1, 3)
        near = camera.depths(corners).reshape(-1, 8).min(axis=1, initial=np.inf) <= farthest
        pixels = camera.pixels(corners).reshape(-1, 8, 2)
        first = np.array([window.left, window.top])
        last = first + np.array([window.width, window.height])
        # Behind the camera pixels are not finite, and no comparison holds: it may be anywhere.
        outside = (pixels.max(axis=1) < first) | (pixels.min(axis=1) > last)
        found = np.flatnonzero(near & ~outside.any(axis=1))
        return {self.links[index] for index in found}


def _window(shown: NDArray[np.bool_], camera: Camera) -> Window:
    """The window round the pixels in which a glance shows something."""
    rows, columns = (np.flatnonzero(shown.any(axis=axis)) * GLANCE for axis in (1, 0))
    return _between(
        camera,
        (columns[0] - MARGIN, rows[0] - MARGIN),
        (columns[-1] + GLANCE + MARGIN, rows[-1] + GLANCE + MARGIN),
    )


def _widened(view: CameraImage, shown: NDArray[np.bool_]) -> Window | None:
    """The window of a view, wider where something goes on beyond it; None where nothing does."""
    now = view.window
    top, left, bottom, right = (
        FURTHER * bool(edge.any()) for edge in (shown[0], shown[:, 0], shown[-1], shown[:, -1])
    )
    wider = _between(
        view.camera,
        (now.left - left, now.top - top),
        (now.left + now.width + right, now.top + now.height + bottom),
    )
    return None if wider == now else wider


def _between(camera: Camera, first: tuple[int, int], last: tuple[int, int]) -> Window:
    """The window from one column and row to before others, as far as there is an image."""
    (left, right), (top, bottom) = (
        (max(0, int(low)), min(size, int(high)))
        for low, high, size in zip(first, last, (camera.width, camera.height), strict=True)
    )
    return Window(left, top, right - left, bottom - top)
