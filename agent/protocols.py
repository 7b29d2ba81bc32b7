"""Protocols for other vision systems, motion stacks, language parts, recognisers and voices.

The simulated body of `hilt.sim` implements `Vision` and `Motion`. What they exchange are frozen
values: a `Percept` for an object in view, a `MotionReport` for an attempted action, a `Meaning` for
an utterance. A failure is a report with a reason, never an exception.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from ..sim.manipulation.motion_report import MotionReport
from ..sim.vision.percept import Percept

if TYPE_CHECKING:
    from ..inference.types import Candidate
    from ..nlu.language import Language
    from ..nlu.semantics.meaning import Meaning
    from .execution.outcome import AnswerContent
    from .speech.sound import Sound, Transcript


class Vision(Protocol):
    """Searches the scene for given features, and nothing else (top-down attention)."""

    def search(self, features: Sequence[str]) -> Sequence[Percept]:
        """Return the objects in view that show one of the features.

        Features are atoms as text: "object:knife", "part:blade", "property:red".
        """
        ...


class Motion(Protocol):
    """Performs the bottom-level actions of the action trees, one at a time."""

    @property
    def abilities(self) -> frozenset[str]:
        """The primitives it can perform ("graspObject", "handOver", ...)."""
        ...

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Grasp an object by this part only; by any part when it is None."""
        ...

    def lift(self) -> MotionReport:
        """Lift the held object from the table and hold it for a second."""
        ...

    def hand_over(self) -> MotionReport:
        """Bring the held object to the receiver, its free part first."""
        ...

    def point_at(self, percept: Percept) -> MotionReport:
        """Point at an object without touching it."""
        ...

    def move_above(self, percept: Percept) -> MotionReport:
        """Move the held tool above an object that is to be driven in."""
        ...

    def raise_(self) -> MotionReport:
        """Raise the held tool above it, ready for a blow."""
        ...

    def lower(self) -> MotionReport:
        """Strike once; the report has the depth, and whether it is driven in completely."""
        ...


@runtime_checkable
class ExtraPrimitives(Protocol):
    """Further primitives of a robot beside those of `Motion`; optional.

    Their names are among the `abilities`, and action trees name them in `primitives`.
    """

    def perform(
        self, action: str, arguments: Mapping[str, Percept | str], constraint: "Candidate | None"
    ) -> MotionReport:
        """Perform one of these primitives.

        `arguments` has the percept of each parameter, or its name when no such object is in view;
        `constraint` is what the rules conclude at this node, if anything.
        """
        ...


@runtime_checkable
class ReleasingMotion(Protocol):
    """A motion that can empty its hand, also without an action tree; optional."""

    @property
    def held(self) -> Percept | None:
        """The object in the hand, as it was seen before it was grasped; None when it is empty."""
        ...

    def release(self) -> MotionReport:
        """Open the hand where it is."""
        ...

    def put_down(self) -> MotionReport:
        """Put the held object on the nearest free place of the table."""
        ...

    def put_back(self) -> MotionReport:
        """Put the held object back where it was taken up."""
        ...


@runtime_checkable
class ClearingMotion(Protocol):
    """A motion that puts aside what is in the way, by a part that it may take it by; optional."""

    movable: Callable[[Percept], Collection[str | None]]  # set before a command; None is any part


class Dialogue(Protocol):
    """Understands utterances and words the answers."""

    def understand(self, text: str, *, speaker: str) -> "Meaning | None":
        """Return the meaning of an utterance; None leaves it to Hilt's own grammar."""
        ...

    def say(self, answer: "AnswerContent", spoken: str) -> str:
        """Return the wording of an answer."""
        ...


class SpeechRecogniser(Protocol):
    """Finds the words in a sound."""

    name: str  #: what it is called in the calibration and in the history

    def recognise(self, sound: "Sound") -> "Sequence[Transcript]":
        """Return the texts that may have been said, best first; none for a sound without words."""
        ...

    def learn(self, language: "Language") -> None:
        """Take note of the words that are known now; one with words of its own does nothing."""


class Voice(Protocol):
    """Speaks."""

    def say(self, text: str, cancelled: Event) -> None:
        """Speak until all is said, or the event is set."""

    def save(self, text: str, path: Path) -> None:
        """Write a text as a WAV file."""
