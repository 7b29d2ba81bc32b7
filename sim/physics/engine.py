# SPDX-License-Identifier: Apache-2.0
"""The physics engine behind names: all that a simulator can do, in the words of a world.

It speaks of bodies, links and joints by name, of poses as 4 x 4 matrices (`world_from_link`), and
of lengths, angles and forces in [m], [rad], [N]. What it does stands in `bodies`, `motors`,
`matter`, `touch` and `looks`; here is what makes it one, and time.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from types import TracebackType

from .contacts import ContactQueries
from .joints import Motors
from .looks import Looks
from .matter import Matter

TIME_STEP = 1 / 240  # [s]
SOLVER_ITERATIONS = 200  # fewer let a grasped object creep (measured: 2 mm instead of 8)
SOLVED = 1e-6  # an error of speed [m/s] below which the iterations end sooner
CONTACT_BREAKING = 0.004  # [m] from which on there is a contact to solve; 0.02 doubles their number
GRAVITY = 9.81  # [m/s^2]


class PhysicsEngine(Motors, Matter, ContactQueries, Looks):
    """One physics simulator, spoken to by names.

    Use it in a `with` block, or `close` it. Several can live in one process.

    Attributes:
        steps: how many have passed.
    """

    def __init__(self, *, gui: bool = False) -> None:
        super().__init__(gui=gui)
        self.steps = 0
        self._configure()

    def __enter__(self) -> PhysicsEngine:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _configure(self) -> None:
        self._call("setGravity", 0, 0, -GRAVITY)
        self._call(
            "setPhysicsEngineParameter",
            fixedTimeStep=TIME_STEP,
            numSolverIterations=SOLVER_ITERATIONS,
            solverResidualThreshold=SOLVED,
            contactBreakingThreshold=CONTACT_BREAKING,
            deterministicOverlappingPairs=1,
        )
        if self.gui:
            self._call("configureDebugVisualizer", self._p.COV_ENABLE_GUI, 0)
            self._call("resetDebugVisualizerCamera", 1.35, 60, -28, (0.35, 0.0, 0.05))

    def step(self, count: int = 1) -> None:
        """Let `count` steps of `TIME_STEP` pass."""
        for _ in range(count):
            self._call("stepSimulation")
        self.steps += count

    @contextmanager
    def tentatively(self) -> Generator[None]:
        """Inside this block anything may be moved; afterwards all is as it was before."""
        state = self.save()
        try:
            yield
        finally:
            self.restore(state)
            self.forget(state)

    def save(self) -> int:
        """Remember all poses, speeds and contacts; the answer is a ticket for `restore`."""
        return self._call("saveState")

    def restore(self, state: int) -> None:
        """Go back to what was remembered."""
        self._call("restoreState", stateId=state)

    def forget(self, state: int) -> None:
        """Free what was remembered."""
        self._call("removeState", state)
