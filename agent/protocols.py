# SPDX-License-Identifier: Apache-2.0
"""What the agent asks of a robot's eyes, hands, and dialogue.

Anybody's detector, motion stack and language part fit in behind these protocols; the simulated body
of `hilt.sim` is one that does. Values that pass are small and frozen: a `Percept` for a thing seen,
a `MotionReport` for an action tried, a `Meaning` for an utterance. A failure is a report with a
reason, never an exception.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from ..sim.manipulation.report import MotionReport
from ..sim.vision.percept import Percept

if TYPE_CHECKING:
    from ..nlu.semantics.meaning import Meaning
    from .execution.outcome import Constraint, SpokenAnswer


class Vision(Protocol):
    """Searches the scene for what it is asked for, and nothing else (top-down attention)."""

    def search(self, features: Sequence[str]) -> Sequence[Percept]:
        """The things in view that show one of the features.

        Args:
            features: atoms as text: "object:knife", "part:blade", "property:red".
        """
        ...


class Motion(Protocol):
    """Performs the bottom-level actions of the action trees, one at a time."""

    @property
    def abilities(self) -> frozenset[str]:
        """The primitives it can perform ("graspObject", "handOver", ...)."""
        ...

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Close the hand on a thing, by this part only; None leaves the choice to the hand."""
        ...

    def lift(self) -> MotionReport:
        """Take what is held up from the table, and hold it for a second."""
        ...

    def hand_over(self) -> MotionReport:
        """Bring what is held to the receiver, its free part first."""
        ...

    def point_at(self, percept: Percept) -> MotionReport:
        """Point at a thing without touching it."""
        ...

    def move_above(self, percept: Percept) -> MotionReport:
        """Bring what is held above a thing that is to be driven in."""
        ...

    def raise_(self) -> MotionReport:
        """Bring what is held back above it, ready for a blow."""
        ...

    def lower(self) -> MotionReport:
        """Strike once; the report says how deep it is in, and whether all the way."""
        ...


@runtime_checkable
class Skills(Protocol):
    """Further primitives of a robot's own, beside those of `Motion`; may be left out.

    Their names are among the `abilities`, and action trees name them in `primitives`.
    """

    def perform(
        self,
        action: str,
        arguments: Mapping[str, Percept | str],
        constraint: Constraint | None,
    ) -> MotionReport:
        """Perform one of them.

        Args:
            action: its name.
            arguments: parameter -> the thing seen; a name where nothing of that name is in view.
            constraint: what the rules conclude at this node, if anything.
        """
        ...


class Dialogue(Protocol):
    """Understands what people say, and words what the robot answers."""

    def understand(self, text: str, *, speaker: str) -> Meaning | None:
        """What an utterance means; None leaves it to Hilt's own grammar.

        Args:
            text: what was said.
            speaker: who said it.
        """
        ...

    def say(self, answer: SpokenAnswer, spoken: str) -> str:
        """An answer in words.

        Args:
            answer: its key, slots, and how the thing asked for ended.
            spoken: how Hilt would put it.
        """
        ...
