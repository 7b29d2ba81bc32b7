"""A stopwatch that measures the processor time of each kind of work in an episode."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from time import process_time
from typing import Any

from hilt.sim.grasping import planner, scoring
from hilt.sim.physics.bodies import Bodies
from hilt.sim.physics.engine import PhysicsEngine
from hilt.sim.robot.kinematics import KinematicChain
from hilt.sim.robot.path_planner import PathPlanner
from hilt.sim.vision.object_detector import MaskDetector, ObjectDetector

WATCHED: tuple[tuple[str, Any, str], ...] = (
    ("stepping", PhysicsEngine, "step"),
    ("loading", Bodies, "load"),
    ("vision", MaskDetector, "capture"),
    ("vision", ObjectDetector, "search"),
    ("vision", ObjectDetector, "find"),
    ("vision", ObjectDetector, "obstacles"),
    ("candidates", planner, "plan_grasps"),
    ("scoring", scoring, "score_grasps"),
    ("joints", KinematicChain, "solve"),
    ("joints", KinematicChain, "track"),
    ("paths", PathPlanner, "plan_transit"),
)


class Stopwatch:
    """Measures processor time by kind of work inside its `with` block.

    The time that a measured function spends in another measured one counts only for that one.

    Attributes:
        seconds: kind of work -> processor time [s].
    """

    def __init__(self) -> None:
        self.seconds = dict.fromkeys((kind for kind, _, _ in WATCHED), 0.0)
        self._running: list[str] = []
        self._since = 0.0
        self._originals: list[Callable[..., Any]] = []

    def __enter__(self) -> Stopwatch:
        self._originals = [getattr(owner, name) for _, owner, name in WATCHED]
        for (kind, owner, name), original in zip(WATCHED, self._originals, strict=True):
            setattr(owner, name, self._watched(kind, original))
        return self

    def __exit__(self, *_: object) -> None:
        for (_, owner, name), original in zip(WATCHED, self._originals, strict=True):
            setattr(owner, name, original)

    def _watched(self, kind: str, function: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(function)
        def timed(*args: Any, **options: Any) -> Any:
            self._book()
            self._running.append(kind)
            try:
                return function(*args, **options)
            finally:
                self._book()
                self._running.pop()

        return timed

    def _book(self) -> None:
        """Add the time since the last call to the kind of work that runs now."""
        now = process_time()
        if self._running:
            self.seconds[self._running[-1]] += now - self._since
        self._since = now
