# SPDX-License-Identifier: Apache-2.0
"""The gaze of a body: what its eyes saw last, as long as no time has passed since then."""

from __future__ import annotations

from collections.abc import Sequence

from ..grasping.context import Sight
from ..scene.world import World
from .camera import CameraImage
from .percept import Percept
from .sensors import Eyes


class Gaze:
    """Looks at a world through some eyes, once a moment.

    Args:
        world: what there is to see.
        eyes: with which it looks.
    """

    def __init__(self, world: World, eyes: Eyes) -> None:
        self.world, self.eyes = world, eyes
        self._views: tuple[CameraImage, ...] = ()
        self._seen_at = -1

    def views(self) -> tuple[CameraImage, ...]:
        """What the cameras see; the last views as long as no time has passed."""
        now = self.world.engine.steps
        if now != self._seen_at:
            self._views, self._seen_at = self.eyes.look(), now
        return self._views

    def search(self, features: Sequence[str]) -> tuple[Percept, ...]:
        """The things in view that have one of the features, the surest first."""
        return self.eyes.search(features, views=self.views())

    def sight(self, name: str, part: str | None) -> Sight | None:
        """A thing in its surroundings, to be taken by a part; None when it is not in view."""
        kind = self.world.kinds.get(name)
        if kind is None:
            return None
        found = self.search([f"object:{kind.name}"])
        percept = next((each for each in found if each.name == name), None)
        if percept is None:
            return None
        return Sight(percept, kind, part, self.eyes.obstacles(name, views=self.views()))
