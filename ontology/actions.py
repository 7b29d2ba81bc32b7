# SPDX-License-Identifier: Apache-2.0
"""Action trees: how a goal is carried out, step by step (paper, sections 3.3 and 4.2, Figure 3).

A tree's steps are walked in preorder. Each step is a primitive, which the robot's vision or motion
performs, or another tree. A `Step` says which of the tree's arguments it hands down; `expand`
unfolds a tree into the nodes of one walk, each named by its path ("pass/graspObject").
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from .errors import UnknownNameError
from .source import Field, read_yaml

ACTIONS_FILE = Path(__file__).with_name("actions.yaml")
MAX_REPEAT = 100
FIXED = "="  # in front of a step's argument that is a word of its own


@dataclass(frozen=True)
class Affords:
    """An argument that is not a thing but what it must be used for: usedFor(something, X)."""

    affordance: str


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
class ActionTree:
    """How one goal is carried out."""

    name: str
    parameters: tuple[str, ...]
    defaults: Mapping[str, str | Affords]
    steps: tuple[Step | Loop, ...]


@dataclass(frozen=True)
class Actions:
    """All primitives and trees the robot knows.

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

    def _paths(self, name: str, path: str) -> Iterator[str]:
        yield path
        for step in flat_steps(self.trees[name].steps) if name in self.trees else ():
            yield from self._paths(step.action, f"{path}/{step.action}")


def flat_steps(steps: tuple[Step | Loop, ...]) -> Iterator[Step]:
    """The steps of a tree with those inside loops, once each."""
    for step in steps:
        if isinstance(step, Loop):
            yield from step.steps
        else:
            yield step


def load_actions(path: Path = ACTIONS_FILE) -> Actions:
    """Read and check action trees.

    Raises:
        DataError: the file is wrong; says where and what was expected.
    """
    top = read_yaml(path).entries(required={"primitives", "trees"}, optional=())
    primitives = {name: spec.texts() for name, spec in top["primitives"].entries().items()}
    trees = top["trees"].entries()
    signatures = primitives | {name: _parameters(spec) for name, spec in trees.items()}
    loaded = {name: _read_tree(name, spec, signatures) for name, spec in trees.items()}
    for name, spec in trees.items():
        _refuse_recursion(name, spec, loaded)
    return Actions(primitives, loaded)


def _parameters(spec: Field) -> tuple[str, ...]:
    keys = spec.entries(required={"parameters", "steps"}, optional={"defaults"})
    return keys["parameters"].texts()


def _read_tree(name: str, spec: Field, signatures: Mapping[str, tuple[str, ...]]) -> ActionTree:
    keys = spec.entries()
    parameters = signatures[name]
    defaults = keys["defaults"].entries(optional=parameters) if "defaults" in keys else {}
    return ActionTree(
        name,
        parameters,
        {parameter: _read_default(value) for parameter, value in defaults.items()},
        tuple(_read_step(item, parameters, signatures) for item in keys["steps"].items()),
    )


def _read_default(value: Field) -> str | Affords:
    if isinstance(value.value, str):
        return value.text(choices={"speaker"})
    return Affords(value.entries(required={"usedFor"}, optional=())["usedFor"].text())


def _read_step(
    item: Field, parameters: tuple[str, ...], signatures: Mapping[str, tuple[str, ...]]
) -> Step | Loop:
    keys = item.entries()
    if "repeat" not in keys:
        return _read_plain_step(item, parameters, signatures)
    item.entries(required={"repeat", "steps"}, optional={"until"})
    return Loop(
        keys["repeat"].integer(low=1, high=MAX_REPEAT),
        keys["until"].text() if "until" in keys else None,
        tuple(_read_plain_step(s, parameters, signatures) for s in keys["steps"].items()),
    )


def _read_plain_step(
    item: Field, parameters: tuple[str, ...], signatures: Mapping[str, tuple[str, ...]]
) -> Step:
    keys = item.entries()
    if len(keys) != 1:
        raise item.fail(f"expected one action with its argument, found {len(keys)} keys.")
    ((action, argument),) = keys.items()
    if action not in signatures:
        raise item.fail(str(UnknownNameError("action", action, signatures)))
    if argument.value is None:
        return Step(action, {})
    word = argument.text()
    if not word.startswith(FIXED) and word not in parameters:
        raise argument.fail(str(UnknownNameError("parameter", word, parameters)))
    if not signatures[action]:
        raise argument.fail(f'"{action}" takes no argument.')
    return Step(action, {signatures[action][0]: word})


def _refuse_recursion(name: str, spec: Field, trees: Mapping[str, ActionTree]) -> None:
    seen: set[str] = set()
    waiting = [step.action for step in flat_steps(trees[name].steps)]
    while waiting:
        action = waiting.pop()
        if action == name:
            raise spec.fail(f'the tree "{name}" contains itself.')
        if action in trees and action not in seen:
            seen.add(action)
            waiting += [step.action for step in flat_steps(trees[action].steps)]
