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

from ..kb.interval import Interval
from ..kb.rule import Atom, Rule


@dataclass(frozen=True)
class Target:
    """The thing an action is about, as far as the speaker said.

    Attributes:
        object: its class ("knife"), or None for "something".
        used_for: an affordance it must have.
        not_used_for: an affordance it must not have.
        properties: adjectives it must satisfy ("red").
    """

    object: str | None = None
    used_for: str | None = None
    not_used_for: str | None = None
    properties: frozenset[str] = frozenset()


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
        interval: the fused conclusion.
        certainty: lambda of the interval, in [0, 1].
        accepted: whether it is sure enough to act on.
        reason: why it is accepted or not, in a few words.
        rules: the rules it rests on.
    """

    name: str
    object: str
    argument: Atom | None
    interval: Interval
    certainty: float
    accepted: bool
    reason: str
    rules: tuple[Rule, ...] = ()


@dataclass(frozen=True)
class Inference:
    """The answer at one node of the action tree.

    Attributes:
        node: the path of the node ("pass/findObject").
        threshold: Λ(c), what lambda must exceed here.
        candidates: all conclusions, best first.
        ties: the names (or parts) that are as good as the best one, in the order of the scene.
        denied: candidates that are believed not to hold, surely enough to avoid them.
    """

    node: str
    threshold: float
    candidates: tuple[Candidate, ...]
    ties: tuple[Candidate, ...] = ()
    denied: tuple[Candidate, ...] = ()

    @property
    def best(self) -> Candidate | None:
        """The candidate to act on, or None when none is sure enough."""
        return self.candidates[0] if self.candidates and self.candidates[0].accepted else None
