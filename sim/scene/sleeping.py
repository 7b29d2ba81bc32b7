# SPDX-License-Identifier: Apache-2.0
"""Sleeping: the engine does not compute objects that lie still until something moves them.

Most of the time of a full table would go into objects that do nothing: each is pressed on the table
by a dozen contacts, and the engine solves all objects together whose bounding boxes overlap, a long
chain on a full table. So objects that lie still sleep, and contacts between two of them, which
cannot change, are left out. An object that has moved is awake, and touches all others again, from
that moment on.
"""

from __future__ import annotations

import numpy as np

from ..poses import Array
from .world import World

CHECK_INTERVAL = 12  # steps between two checks: a twentieth of a second
MOVED = 5e-4  # [m], an object that lies still moves less


class SleepManager:
    """Puts the loose objects of a world to sleep, and wakes those that are moved.

    Args:
        world: whose objects; they lie still by now.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._awake: dict[str, Array] = {}  # where each object was at the last check (3,)
        self._asleep: dict[str, Array] = {}
        self._steps = 0
        for name in world.loose:
            self._put_to_sleep(name)

    @property
    def asleep(self) -> tuple[str, ...]:
        """The names of the objects that sleep."""
        return tuple(self._asleep)

    def step(self, count: int) -> None:
        """Let `count` steps pass in the world, and wake what is moved."""
        for _ in range(count):
            self._world.step()
            self._steps = (self._steps + 1) % CHECK_INTERVAL
            if self._steps == 0:
                self._check()

    def sleep_again(self, *, but: str) -> None:
        """Put objects back to sleep that have come to lie still, but for one that will be moved."""
        for name, before in list(self._awake.items()):
            if name != but and np.abs(self._position(name) - before).max() < MOVED:
                del self._awake[name]
                self._put_to_sleep(name)

    def _check(self) -> None:
        for name, before in list(self._asleep.items()):
            if np.abs(self._position(name) - before).max() > MOVED:
                self._wake(name)
        self._awake = {name: self._position(name) for name in self._awake}

    def _put_to_sleep(self, name: str) -> None:
        contacts = self._world.engine.contacts
        for other in self._asleep:
            contacts.enable(name, other, enabled=False)
        contacts.enable_sleeping(name)
        self._asleep[name] = self._position(name)

    def _wake(self, name: str) -> None:
        contacts = self._world.engine.contacts
        self._awake[name] = self._asleep.pop(name)
        contacts.disable_sleeping(name)
        for other in self._asleep:
            contacts.enable(name, other, enabled=True)

    def _position(self, name: str) -> Array:
        return self._world.engine.bodies.pose(name)[:3, 3]
