"""The live scene: what is drawn once, and where all of it is while somebody looks."""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING

from ...sim.physics.engine import TIME_STEP
from ..documents import things_as_json
from ..execution.outcome import Json
from .events import Hub

if TYPE_CHECKING:
    from ...sim.body import Body

STEPS_A_FRAME = 8  # 30 frames a second of the world
STEPS_A_LOOK = 48  # after which it is known anew where things are
_LATE_S = 0.2  # behind the clock, from which a slow world does not try to catch up


class LiveScene:
    """The scene of one body, which tells readers of events where everything is."""

    def __init__(self, body: Body, number: int, hub: Hub, *, pace: float) -> None:
        """Make its model, and watch it.

        `pace` is in seconds of the world in one of the clock, at most, while somebody looks; 0 for
        any.
        """
        from ...sim.media.gltf import pose_frame, scene_model

        self._engine, self._number, self._hub = body.world.engine, number, hub
        self._body = body
        self._pace, self._due = pace, 0.0
        self.model = scene_model(self._engine)
        self.look()
        self._frame = partial(pose_frame, self._engine, self.model.nodes, scene=number)
        body.world.watchers.append(self._watch)

    def as_json(self) -> Json:
        """Where the shapes are, and the names of their nodes in the order of frames."""
        address = f"/api/v1/scene.glb?v={self.model.key}"
        return {"number": self._number, "url": address, "nodes": list(self.model.node_names)}

    def show(self) -> None:
        """Send a frame now."""
        self._hub.publish(self._frame())

    def look(self) -> None:
        """See where things are now, in the thread that moves them; others read `things`."""
        self.things = things_as_json(self._body)

    def _watch(self) -> None:
        if self._engine.steps % STEPS_A_LOOK == 0:
            self.look()
        if self._hub.readers and self._engine.steps % STEPS_A_FRAME == 0:
            self.show()
            if self._pace:  # let the clock go on as far: who looks can stop what is seen
                now = time.monotonic()
                start = self._due if self._due > now - _LATE_S else now
                self._due = start + STEPS_A_FRAME * TIME_STEP / self._pace
                time.sleep(max(0.0, self._due - now))
