"""Images of objects alone, with what may hide them: most of the time of an image is the robot's.

The objects are drawn first, without room and robot. Where links of the robot may be before them,
by their bounding boxes, the image is drawn again with these. So the pixels that show objects are
those of an image of everything.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np

from ..physics.engine import PhysicsEngine
from ..poses import Array
from ..scene.scene import ROOM
from .camera import Camera, CameraImage

BULGE = 0.02  # [m] that the visual shape of a link may exceed its collision shape
_CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])  # of a box


def capture_objects(
    engine: PhysicsEngine, objects: Collection[str], cameras: Sequence[Camera]
) -> Iterator[CameraImage]:
    """Take an image of some bodies with each camera; those of the room cannot hide anything."""
    hidden = tuple(name for name in engine.bodies.names if name not in objects)
    robot = [body for body in hidden if body not in ROOM]
    links = [(body, link) for body in robot for link in engine.rendering.visible_links(body)]
    ends = [np.add(engine.bodies.bounds(*each), [[-BULGE], [BULGE]]) for each in links]
    boxes = np.array(ends).reshape(-1, 2, 3)[:, _CORNERS, [0, 1, 2]]
    for camera in cameras:
        with engine.rendering.hidden(hidden):
            image = camera.capture(engine)
        if occluders := [links[index] for index in _occluders(image, boxes)]:
            with engine.rendering.hidden(hidden, but=occluders):
                image = camera.capture(engine)
        yield image


def _occluders(image: CameraImage, boxes: Array) -> np.ndarray:
    shown = np.nonzero(image.labels >= 0)
    if not len(shown[0]):
        return np.zeros(0, dtype=int)
    camera, corners = image.camera, boxes.reshape(-1, 3)
    depths = ((camera.eye - corners) @ camera.world_from_camera[:3, 2]).reshape(-1, 8)
    near = depths.min(axis=1) <= image.depth[shown].max()
    pixels = camera.pixels(corners).reshape(-1, 8, 2)
    first, last = ([each(axis) for axis in reversed(shown)] for each in (np.min, np.max))
    # Behind the camera pixels are NaN and no comparison holds, so that the link is kept.
    outside = (pixels.max(axis=1) < first) | (pixels.min(axis=1) > np.add(last, 1))
    return np.flatnonzero(near & ~outside.any(axis=1))
