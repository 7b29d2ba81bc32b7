# SPDX-License-Identifier: Apache-2.0
"""What is struck: a thing that stands in another one, and goes in with each blow."""

from __future__ import annotations

import numpy as np

from ..poses import Array
from ..scene.world import World

IN = 0.003  # [m], what lacks less is in all the way
TOP = 0.0015  # [m], what is so little below the highest point is the top


class StrikeTarget:
    """A thing that is to be driven in.

    Args:
        world: where it is.
        name: of it; it stands in something.
        cloud: the points that were seen of it (n, 3) [m].

    Raises:
        UnknownNameError: it stands in nothing.
    """

    def __init__(self, world: World, name: str, cloud: Array) -> None:
        self._world, self.name = world, name
        self._seen, self._seen_depth = top_of(cloud), world.depth(name)

    @property
    def depth(self) -> float:
        """How deep it stands in the other thing [m]."""
        return self._world.depth(self.name)

    @property
    def top(self) -> Array:
        """Its top (3,): where it was seen, lower by as much as it has gone in since [m]."""
        return self._seen - (0, 0, self.depth - self._seen_depth)

    @property
    def is_in(self) -> bool:
        """Whether it is in all the way."""
        mount = self._world.kinds[self.name].mount
        return mount is not None and self.depth > mount.deepest - IN


def top_of(cloud: Array) -> Array:
    """The middle of the highest face of a cloud (n, 3) [m]."""
    top = float(cloud[:, 2].max())
    face = cloud[cloud[:, 2] > top - TOP]
    return np.array([*(face[:, :2].min(axis=0) + face[:, :2].max(axis=0)) / 2, top])
