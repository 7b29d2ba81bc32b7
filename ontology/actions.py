# SPDX-License-Identifier: Apache-2.0
"""Action trees: how a goal is carried out, step by step (paper, sections 3.3 and 4.2, Figure 3).

A tree's steps are walked in preorder. Each step is a primitive, which the robot's vision or motion
performs, or another tree. A `Step` says which of the tree's arguments it hands down. Before its
first step a tree may require something, and after a failure its branches say what else to try.
Trees are data: `action_sheet` reads them from YAML, those of Hilt and those of its users.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from .errors import UnknownNameError

FIXED = "="  # in front of a step's argument that is a word of its own
ANY_FAILURE = "any"
FAILURES = frozenset(  # what a branch may follow: reasons of motion, and of the walk itself
    {
        "nothing_seen", "no_grasp", "too_wide", "blocked", "unreachable", "wrong_part", "missed",
        "slipped", "dropped", "bumped", "nothing_held", "nothing_to_strike", "not_driven",
        "no_gripper", "not_found", "not_sure", "required",
    }
)  # fmt: skip
CONDITIONS = ("sees", "holds")


@dataclass(frozen=True)
class Affords:
    """An argument that is not a thing but what it must afford: the argument review's question.

    Attributes:
        functor: what must follow of it: "usedFor", "cutWith", ...
        argument: an atom as text ("affordance:pounding"); None where the functor needs none.
        of: the parameter whose thing is the argument instead: cutWith(X, what is to be cut).
    """

    functor: str
    argument: str | None = None
    of: str | None = None


@dataclass(frozen=True)
class Step:
    """One step of a tree.

    Attributes:
        action: a primitive or a tree.
        arguments: parameter of that action -> argument of the tree above, or "=word".
    """

    action: str
    arguments: Mapping[str, str]


@dataclass(frozen=True)
class Loop:
    """Steps that are repeated at most `times` times, until the robot senses `until`."""

    times: int
    until: str | None
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class Condition:
    """What must hold before the first step.

    Attributes:
        kind: "sees", it is in view; or "holds", it is in the hand.
        parameter: the argument that is meant.
    """

    kind: str
    parameter: str


@dataclass(frozen=True)
class Branch:
    """What to do after a failure; exactly one of the last three.

    Attributes:
        after: the failures it is for, some of `FAILURES` or "any".
        next: the parameter for which the next best thing is to be tried.
        again: how often to walk the steps again.
        steps: what else to do; when they succeed, the tree does.
    """

    after: frozenset[str]
    next: str | None = None
    again: int = 0
    steps: tuple[Step | Loop, ...] = ()

    def follows(self, failure: str) -> bool:
        """Whether it is meant for a failure."""
        return ANY_FAILURE in self.after or failure in self.after


@dataclass(frozen=True)
class ActionTree:
    """How one goal is carried out.

    Attributes:
        name: of the goal.
        parameters: what the goal's predicate may carry, in order.
        defaults: parameter -> what it is when nobody says it; "speaker" is who asked.
        steps: walked in preorder.
        requires: what must hold before.
        otherwise: what to do after a failure, the first that fits.
        is_a: the action that it is a kind of, whose rules it inherits.
    """

    name: str
    parameters: tuple[str, ...]
    defaults: Mapping[str, str | Affords]
    steps: tuple[Step | Loop, ...]
    requires: tuple[Condition, ...] = ()
    otherwise: tuple[Branch, ...] = ()
    is_a: str | None = None

    @property
    def all_steps(self) -> Iterator[Step]:
        """Its steps with those inside loops and branches, once each."""
        yield from flat_steps(self.steps)
        for branch in self.otherwise:
            yield from flat_steps(branch.steps)


@dataclass(frozen=True)
class Actions:
    """All primitives and trees the robot knows.

    >>> from hilt.ontology.action_sheet import load_actions
    >>> actions = load_actions()
    >>> [step.action for step in actions.tree("pass").steps]
    ['findObject', 'graspObject', 'moveTo', 'handOver']
    >>> actions.contexts("pickUp/graspObject")
    ('pickUp',)
    """

    primitives: Mapping[str, tuple[str, ...]]
    trees: Mapping[str, ActionTree] = field(default_factory=dict[str, ActionTree])

    def tree(self, name: str) -> ActionTree:
        """The tree of a goal.

        Raises:
            UnknownNameError: there is no such tree.
        """
        if name not in self.trees:
            raise UnknownNameError("action tree", name, self.trees)
        return self.trees[name]

    @staticmethod
    def contexts(path: str) -> tuple[str, ...]:
        """The contexts of a node, nearest first: the trees above it on its path."""
        return tuple(reversed(path.split("/")[:-1]))

    @cached_property
    def nodes(self) -> tuple[str, ...]:
        """The paths of all nodes of all trees, each once."""
        found = (path for name in self.trees for path in self._paths(name, name))
        return tuple(dict.fromkeys(found))

    @property
    def kinds(self) -> Mapping[str, str]:
        """Action -> the action that it is a kind of, where it is one."""
        return {name: tree.is_a for name, tree in self.trees.items() if tree.is_a}

    def _paths(self, name: str, path: str) -> Iterator[str]:
        yield path
        for step in self.trees[name].all_steps if name in self.trees else ():
            yield from self._paths(step.action, f"{path}/{step.action}")


def flat_steps(steps: tuple[Step | Loop, ...]) -> Iterator[Step]:
    """Steps with those inside loops, once each."""
    for step in steps:
        if isinstance(step, Loop):
            yield from step.steps
        else:
            yield step
