# SPDX-License-Identifier: Apache-2.0
"""What is wanted, what is seen, and what is concluded: the values that inference takes and gives.

They are all that a language, vision or motion part has to know of `inference`. A `Goal` is the
predicate of a command ("pass(self, usedFor(something, cutting))"), an `Observation` one thing that
vision reports, with an interval for each feature, and an `Inference` the answer at one node of the
action tree: every candidate with its interval and its reasons, the best one, and what ties with it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from ..kb.interval import Interval
from ..kb.rule import USED_FOR, Atom, Rule
from .proof import Proof

Verdict = Literal["accepted", "denied", "unsure", "unknown", "absent"]


@dataclass(frozen=True)
class Conclusion:
    """What must follow of a thing: usedFor(cutting), cutWith(bread).

    Attributes:
        functor: of the rules that conclude it.
        argument: what of; None takes any.
    """

    functor: str
    argument: Atom | None = None

    def __str__(self) -> str:
        return f"{self.functor}({self.argument or ''})"


@dataclass(frozen=True)
class Target:
    """The thing an action is about, as far as the speaker said.

    Attributes:
        object: its class ("knife"), or None for "something".
        used_for: an affordance it must have.
        not_used_for: an affordance it must not have.
        affords: any other conclusion that must follow of it: cutWith(bread).
        properties: adjectives it must satisfy ("red").
        is_confirmed: whether the speaker said yes to it, when asked: then it need only be seen.
    """

    object: str | None = None
    used_for: str | None = None
    not_used_for: str | None = None
    affords: Conclusion | None = None
    properties: frozenset[str] = frozenset()
    is_confirmed: bool = False

    @cached_property
    def wanted(self) -> tuple[tuple[Conclusion, bool], ...]:
        """What must follow of it, each with whether its contrary must."""
        uses = ((self.used_for, False), (self.not_used_for, True))
        named = [
            (Conclusion(USED_FOR, Atom("affordance", name)), negated)
            for name, negated in uses
            if name
        ]
        return (*named, *([(self.affords, False)] if self.affords else []))


@dataclass(frozen=True)
class Goal:
    """What the walk of an action tree is for.

    Attributes:
        action: the tree ("pass").
        target: the thing looked for at the find node.
        contexts: what else holds in this situation besides the actions on the path, with how
            surely (`Atom("place", "kitchen"): Interval(0.9, 1.0)`).
    """

    action: str
    target: Target
    contexts: Mapping[Atom, Interval] = field(default_factory=dict[Atom, Interval])


@dataclass(frozen=True)
class Observation:
    """One thing that vision reports.

    Attributes:
        name: which one it is ("knife", "mug_2"), unique in the scene.
        object: the class it is seen as.
        atoms: the features looked for, each with its interval; an absent atom was not looked for.
    """

    name: str
    object: str
    atoms: Mapping[Atom, Interval]


@dataclass(frozen=True)
class Candidate:
    """One conclusion: that an observed thing affords `argument`.

    Attributes:
        name: the observed thing.
        object: its class.
        argument: what it affords: an affordance, or the part to act on; None where the command
            names the object and no rule is needed.
        proof: how the interval was worked out.
        certainty: lambda of the interval, in [0, 1].
        verdict: "accepted"; "denied", believed not to hold; "unsure", not enough either way;
            "unknown", nothing was told; or "absent", told of but not in view.
        reason: why, in a few words.
        inherited: how many steps up the rules were found: 0 for this very kind of thing.
        overruled: inherited rules that were set aside, since these are nearer.
    """

    name: str
    object: str
    argument: Atom | None
    proof: Proof
    certainty: float
    verdict: Verdict
    reason: str
    inherited: int = 0
    overruled: tuple[Rule, ...] = ()

    @property
    def interval(self) -> Interval:
        """The fused conclusion."""
        return self.proof.interval

    @property
    def accepted(self) -> bool:
        """Whether it is sure enough to act on."""
        return self.verdict == "accepted"

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules it rests on, each once."""
        return tuple(dict.fromkeys(step.rule for step in self.proof if step.rule))


@dataclass(frozen=True)
class Inference:
    """The answer at one node of the action tree.

    Attributes:
        node: the path of the node ("pass/findObject").
        threshold: Λ(c), what lambda must exceed here.
        candidates: all conclusions, best first.
        ties: the names (or parts) that are as good as the best one, in the order of the scene.
        absent: where nothing is sure enough: what rules name that is not in view.
    """

    node: str
    threshold: float
    candidates: tuple[Candidate, ...]
    ties: tuple[Candidate, ...] = ()
    absent: tuple[Candidate, ...] = ()

    @property
    def best(self) -> Candidate | None:
        """The candidate to act on, or None when none is sure enough."""
        return self.candidates[0] if self.candidates and self.candidates[0].accepted else None

    @property
    def denied(self) -> tuple[Candidate, ...]:
        """The candidates that are believed not to hold, surely enough to avoid them."""
        return tuple(each for each in self.candidates if each.verdict == "denied")
