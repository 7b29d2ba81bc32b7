"""The physics engine: one simulator whose bodies, links and joints are spoken of by name.

Poses are 4 x 4 matrices (`world_from_link`); lengths, angles and forces are in [m], [rad], [N].
"""

from collections.abc import Callable
from contextlib import AbstractContextManager

from .bodies import Bodies, Joints
from .pybullet_client import PhysicsClient
from .rendering import Rendering

TIME_STEP = 1 / 240  # [s]
SOLVER_ITERATIONS = 200  # fewer let a grasped object creep (measured: 2 mm instead of 8)
SOLVED = 1e-6  # an error of speed [m/s] below which the iterations end sooner
CONTACT_BREAKING = 0.004  # [m] from which on there is a contact to solve; 0.02 doubles their number
GRAVITY = 9.81  # [m/s^2]


class PhysicsEngine(AbstractContextManager["PhysicsEngine"]):
    """One of several simulators, with its bodies; use it in a `with` block, or `close` it."""

    def __init__(self, *, gui: bool = False) -> None:
        self._client = PhysicsClient(gui=gui)
        self.bodies = Bodies(self._client)
        self.joints = Joints(self._client, self.bodies)
        self.rendering = Rendering(self._client, self.bodies)
        self.steps = 0
        self.watchers: list[Callable[[], None]] = []  #: are called after every step
        self._client.call("setGravity", 0, 0, -GRAVITY)
        self._client.call(
            "setPhysicsEngineParameter",
            fixedTimeStep=TIME_STEP,
            numSolverIterations=SOLVER_ITERATIONS,
            solverResidualThreshold=SOLVED,
            contactBreakingThreshold=CONTACT_BREAKING,
            deterministicOverlappingPairs=1,
        )
        if gui:
            panels = self._client.constant("COV_ENABLE_GUI")
            self._client.call("configureDebugVisualizer", panels, 0)
            self._client.call("resetDebugVisualizerCamera", 1.35, 60, -28, (0.35, 0.0, 0.05))

    def step(self, count: int = 1) -> None:
        """Simulate `count` steps of `TIME_STEP`, and call the watchers after each."""
        for _ in range(count):
            self._client.call("stepSimulation")
            self.steps += 1
            for watcher in self.watchers:
                watcher()

    def close(self) -> None:
        """Stop the simulator; closing twice is allowed."""
        self._client.close()

    def __exit__(self, *_: object) -> None:
        self.close()
