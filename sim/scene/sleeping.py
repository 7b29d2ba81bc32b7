# SPDX-License-Identifier: Apache-2.0
"""Things that lie still: the engine need not reckon with them until something moves them.

Most of the time of a full table would go into things that do nothing: each is pressed on the table
by a dozen contacts, and the engine solves all things together whose bounding boxes overlap, a long
chain on a full table. So what lies still sleeps, and contacts between two such things, which cannot
change, are left out. Whatever has moved is awake, and felt by all others, from that moment on.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..physics.engine import PhysicsEngine
from ..poses import Array

LOOK_EVERY = 12  # steps between two looks: a twentieth of a second
MOVED = 5e-4  # [m], a thing that lies still moves less


class Resting:
    """The things of a table that lie still at the moment.

    Args:
        engine: where they are.
        loose: the names of all things that lie on the table, still by now.
    """

    def __init__(self, engine: PhysicsEngine, loose: Iterable[str]) -> None:
        self._engine = engine
        self._moving: dict[str, Array] = {}
        self._places: dict[str, Array] = {}
        self._steps = 0
        for name in loose:
            self._rest(name)

    @property
    def names(self) -> tuple[str, ...]:
        """What lies still."""
        return tuple(self._places)

    def settle(self, *, but: str) -> None:
        """Take what has come to lie still as resting again.

        Args:
            but: what is going to be moved.
        """
        for name, before in list(self._moving.items()):
            if name != but and np.abs(self._place(name) - before).max() < MOVED:
                del self._moving[name]
                self._rest(name)

    def watch(self, steps: int) -> None:
        """Wake what has been moved; call it as time passes, with the number of steps."""
        self._steps += steps
        if self._steps < LOOK_EVERY:
            return
        self._steps = 0
        for name, before in list(self._places.items()):
            if np.abs(self._place(name) - before).max() > MOVED:
                self._wake(name)
        self._moving = {name: self._place(name) for name in self._moving}

    def _rest(self, name: str) -> None:
        for other in self._places:
            self._engine.contacts.enable(name, other, enabled=False)
        self._engine.contacts.enable_sleeping(name)
        self._places[name] = self._place(name)

    def _wake(self, name: str) -> None:
        self._moving[name] = self._places.pop(name)
        self._engine.contacts.disable_sleeping(name)
        for other in self._places:
            self._engine.contacts.enable(name, other, enabled=True)

    def _place(self, name: str) -> Array:
        return self._engine.bodies.pose(name)[:3, 3]
