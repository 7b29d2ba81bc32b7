"""Inputs and results of inference: goals, observations, candidates and inferences.

These types are the interface of `inference` for language, vision and motion. A `Goal` is the
predicate of a command ("pass(self, usedFor(something, cutting))"), an `Observation` is an object
reported by vision with an interval for each feature, and an `Inference` is the result at a node of
the action tree: all candidates with interval and proof, the best one, and its ties.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from ..kb.interval import Interval
from ..kb.rule import USED_FOR, Atom, Rule
from ..ontology.actions import DescribedObject
from .experience import OutcomeCounts, contradiction
from .proof import Proof

Verdict = Literal["accepted", "denied", "unsure", "unknown", "absent"]


@dataclass(frozen=True)
class Conclusion:
    """A conclusion about an object: usedFor(cutting), cutWith(bread); None matches any argument."""

    functor: str
    argument: Atom | None = None

    def __str__(self) -> str:
        return f"{self.functor}({self.argument or ''})"


@dataclass(frozen=True)
class Target(DescribedObject):
    """The object an action is about, as described by the speaker.

    It must also lead to `affords`: cutWith(bread). One confirmed by the speaker need only be seen.
    """

    affords: Conclusion | None = None
    is_confirmed: bool = False

    @cached_property
    def wanted(self) -> tuple[tuple[Conclusion, bool], ...]:
        """The conclusions that must hold for it, each with whether it is negated."""
        uses = ((self.used_for, False), (self.not_used_for, True))
        named = [(Conclusion(USED_FOR, Atom("affordance", n)), negated) for n, negated in uses if n]
        return (*named, *([(self.affords, False)] if self.affords else []))


@dataclass(frozen=True)
class Goal:
    """The goal of an action tree ("pass"), and the target of its find node.

    `contexts` hold besides the actions on its path: `{Atom("place", "kitchen"): Interval(0.9, 1)}`.
    """

    action: str
    target: Target
    contexts: Mapping[Atom, Interval] = field(default_factory=dict[Atom, Interval])


@dataclass(frozen=True)
class Observation:
    """An object seen: its name ("mug_2"), unique in the scene, class, and features looked for."""

    name: str
    object: str
    atoms: Mapping[Atom, Interval]


@dataclass(frozen=True)
class Candidate:
    """A conclusion about an observed object, with its proof and the reason for the verdict."""

    name: str
    object: str
    #: the affordance, or the part to act on; None if an object is named and no rule is needed
    argument: Atom | None
    proof: Proof
    certainty: float  #: lambda of the interval, in [0, 1]
    #: "accepted"; "denied", believed not to hold; "unsure", neither; "unknown", there is no rule;
    #: or "absent", there is a rule but the object is not in view
    verdict: Verdict
    reason: str
    inherited: int = 0  #: distance of the rules in the is-a hierarchy: 0 for rules about this kind
    overruled: tuple[Rule, ...] = ()  #: rules that more specific ones override
    #: the outcomes of grasps by that part; None where there are none
    experience: OutcomeCounts | None = None

    @property
    def part(self) -> str | None:
        """The name of the part to act on; None where that is left open."""
        return self.argument.name if self.argument and self.argument.kind == "part" else None

    @property
    def told(self) -> Interval:
        """The interval that follows from what was told, without experience."""
        return self.proof.inputs[0].interval if self.experience else self.interval

    @property
    def contradiction(self) -> float:
        """The mass by which experience contradicts what was told, in [0, 1]."""
        return contradiction(self.told, self.experience.interval) if self.experience else 0.0

    @property
    def interval(self) -> Interval:
        """The interval of the conclusion."""
        return self.proof.interval

    @property
    def accepted(self) -> bool:
        """Whether the conclusion is certain enough to act on."""
        return self.verdict == "accepted"

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules of the proof, each once."""
        return tuple(dict.fromkeys(step.rule for step in self.proof if step.rule))


@dataclass(frozen=True)
class Inference:
    """The result of inference at a node ("pass/findObject") of the action tree.

    `threshold` is Λ(c), which lambda must exceed. The candidates are sorted, best first; `ties` are
    as good as the best one, in the order of the scene. If none is accepted, `absent` are the
    objects named by rules that are not in view.
    """

    node: str
    threshold: float
    candidates: tuple[Candidate, ...]
    ties: tuple[Candidate, ...] = ()
    absent: tuple[Candidate, ...] = ()

    @property
    def best(self) -> Candidate | None:
        """The candidate to act on, or None if none is accepted."""
        return self.candidates[0] if self.candidates and self.candidates[0].accepted else None

    @property
    def denied(self) -> tuple[Candidate, ...]:
        """The candidates that are believed not to hold."""
        return tuple(each for each in self.candidates if each.verdict == "denied")
