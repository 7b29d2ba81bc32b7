"""The live scene: what is drawn once, and where all of it is while somebody looks."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from ...sim.physics.engine import TIME_STEP
from ..execution.outcome import Json
from .events import Hub

if TYPE_CHECKING:
    from ...sim.body import Body

STEPS_A_FRAME = 8  # 30 frames a second of the world
_LATE_S = 0.2  # behind the clock, from which a slow world does not try to catch up


class LiveScene:
    """The scene of one body, which tells readers of events where everything is.

    Args:
        pace: seconds of the world in one of the clock, at most, while somebody looks; 0 for any.

    Attributes:
        model: the shapes, as a file that never changes.
    """

    def __init__(self, body: Body, number: int, hub: Hub, *, pace: float) -> None:
        from ...sim.media.gltf import scene_model

        self.model = scene_model(body.world.engine)
        self._engine, self._number, self._hub = body.world.engine, number, hub
        self._pace, self._due = pace, 0.0
        body.world.watchers.append(self._watch)

    def as_json(self) -> Json:
        """Where the shapes are, and the names of their nodes in the order of frames."""
        address = f"/api/v1/scene.glb?v={self.model.key}"
        return {"number": self._number, "url": address, "nodes": list(self.model.node_names)}

    def show(self) -> None:
        """Send a frame now."""
        from ...sim.media.pose_frames import pose_frame

        self._hub.publish(pose_frame(self._engine, self.model.nodes, scene=self._number))

    def _watch(self) -> None:
        if self._hub.readers and self._engine.steps % STEPS_A_FRAME == 0:
            self.show()
            if self._pace:
                self._wait()

    def _wait(self) -> None:
        """Let the clock go on as far as the world: who looks can stop what is seen."""
        now = time.monotonic()
        frame_s = STEPS_A_FRAME * TIME_STEP / self._pace
        self._due = (self._due if self._due > now - _LATE_S else now) + frame_s
        time.sleep(max(0.0, self._due - now))
