"""The live scene: what is drawn once, and where all of it is while somebody looks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..execution.outcome import Json
from .events import Hub

if TYPE_CHECKING:
    from ...sim.body import Body

STEPS_A_FRAME = 8  # 30 frames a second of the world


class LiveScene:
    """The scene of one body, which tells readers of events where everything is.

    Attributes:
        model: the shapes, as a file that never changes.
    """

    def __init__(self, body: Body, number: int, hub: Hub) -> None:
        from ...sim.media.gltf import scene_model

        self.model = scene_model(body.world.engine)
        self._engine, self._number, self._hub = body.world.engine, number, hub
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
