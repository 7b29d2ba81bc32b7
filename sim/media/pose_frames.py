"""Pose frames: where the nodes of a scene's model are at one moment, as bytes for a live view.

A frame is little-endian: `u8 kind = 1`, `u8 version = 1`, `u16 scene`, `f32 time` [s] of the world,
then `f32 x y z qx qy qz qw` in the world for each node, in their order.
"""

import struct
from collections.abc import Sequence

import numpy as np

from ..physics.engine import TIME_STEP, PhysicsEngine

KIND, VERSION = 1, 1
_HEAD = struct.Struct("<BBHf")


def pose_frame(engine: PhysicsEngine, nodes: Sequence[tuple[str, str]], *, scene: int) -> bytes:
    """Return where links are now, in the order of `nodes` (body and link).

    `scene` is the number of the scene, modulo 65536. `UnknownNameError` for another body.
    """
    links: dict[str, list[int]] = {}
    for place, (body, _) in enumerate(nodes):
        links.setdefault(body, []).append(place)
    found = np.empty((len(nodes), 7), dtype="<f4")
    for body, places in links.items():
        found[places] = engine.bodies.link_poses(body, [nodes[place][1] for place in places])
    return _HEAD.pack(KIND, VERSION, scene % 65536, engine.steps * TIME_STEP) + found.tobytes()
