# SPDX-License-Identifier: Apache-2.0
"""Reader of action trees: `actions.yaml`, and files of one's own in the same form.

`docs/actions.md` tells all keys. A file of one's own adds primitives and trees to those of Hilt; a
tree of the same name takes the place of Hilt's. A mistake is told with its line and column.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from pathlib import Path

from .actions import (
    ANY_FAILURE,
    CONDITIONS,
    FAILURES,
    FIXED,
    Actions,
    ActionTree,
    Affords,
    Branch,
    Condition,
    Loop,
    Step,
)
from .errors import UnknownNameError
from .yaml_reader import Field, read_yaml

ACTIONS_FILE = Path(__file__).with_name("actions.yaml")
MAX_REPEAT = 100
MAX_AGAIN = 10
SPEAKER = "speaker"

_TREE_KEYS = frozenset({"defaults", "requires", "otherwise", "is_a"})
_BRANCHES = ("next", "again", "steps")


def load_actions(path: Path = ACTIONS_FILE, *, added_to: Actions | None = None) -> Actions:
    """Read and check action trees.

    Args:
        path: the file.
        added_to: those that its trees may use, and that it adds to.

    Raises:
        DataError: the file is wrong; says where and what was expected.
    """
    known = added_to or Actions({})
    top = read_yaml(path).entries(required=["trees"], optional=["primitives", "failures"])
    added = top["primitives"].entries() if "primitives" in top else {}
    primitives = {**known.primitives, **{name: spec.texts() for name, spec in added.items()}}
    specs = top["trees"].entries()
    failures = {*FAILURES, *(top["failures"].texts() if "failures" in top else ())}
    signatures = {**primitives, **{name: each.parameters for name, each in known.trees.items()}}
    signatures |= {name: _parameters(spec) for name, spec in specs.items()}
    read = {name: _Tree(name, spec, signatures, failures).read() for name, spec in specs.items()}
    trees = {**known.trees, **read}
    for name, spec in specs.items():
        _refuse_circles(name, spec, trees)
    return Actions(primitives, trees)


def _parameters(spec: Field) -> tuple[str, ...]:
    return spec.entries(required={"parameters", "steps"}, optional=_TREE_KEYS)["parameters"].texts()


class _Tree:
    """One tree of the file, with what its steps may name."""

    def __init__(
        self,
        name: str,
        spec: Field,
        signatures: Mapping[str, tuple[str, ...]],
        failures: Collection[str],
    ) -> None:
        self.name, self.keys = name, spec.entries()
        self.signatures, self.failures = signatures, failures
        self.parameters = signatures[name]

    def read(self) -> ActionTree:
        """The tree."""
        keys = self.keys
        defaults = keys["defaults"].entries(optional=self.parameters) if "defaults" in keys else {}
        return ActionTree(
            self.name,
            self.parameters,
            {parameter: self._default(value) for parameter, value in defaults.items()},
            self._steps(keys["steps"]),
            tuple(self._condition(item) for item in _items(keys, "requires")),
            tuple(self._branch(item) for item in _items(keys, "otherwise")),
            self._action(keys["is_a"]) if "is_a" in keys else None,
        )

    def _default(self, value: Field) -> str | Affords:
        if isinstance(value.value, str):
            return value.text(choices={SPEAKER})
        keys = value.entries(optional={"usedFor", "affords", "of"})
        if "usedFor" in keys:
            value.entries(required={"usedFor"}, optional=())
            return Affords("usedFor", f"affordance:{keys['usedFor'].text()}")
        value.entries(required={"affords"}, optional={"of"})
        of = self._parameter(keys["of"]) if "of" in keys else None
        return Affords(keys["affords"].text(), of=of)

    def _condition(self, item: Field) -> Condition:
        kind, parameter = _one(item, "condition")
        if kind not in CONDITIONS:
            raise parameter.fail(str(UnknownNameError("condition", kind, CONDITIONS)))
        return Condition(kind, self._parameter(parameter))

    def _branch(self, item: Field) -> Branch:
        keys = item.entries(required={"after"}, optional=_BRANCHES)
        given = [key for key in _BRANCHES if key in keys]
        if len(given) != 1:
            found = " and ".join(given) or "none"
            raise item.fail(f"expected one of {', '.join(_BRANCHES)}, found {found}.")
        return Branch(
            self._failures(keys["after"]),
            self._parameter(keys["next"]) if "next" in keys else None,
            keys["again"].integer(low=1, high=MAX_AGAIN) if "again" in keys else 0,
            self._steps(keys["steps"]) if "steps" in keys else (),
        )

    def _failures(self, field: Field) -> frozenset[str]:
        if field.value == ANY_FAILURE:
            return frozenset({ANY_FAILURE})
        return frozenset(field.texts(choices=self.failures))

    def _steps(self, field: Field) -> tuple[Step | Loop, ...]:
        return tuple(self._step(item) for item in field.items())

    def _step(self, item: Field) -> Step | Loop:
        keys = item.entries()
        if "repeat" not in keys:
            return self._plain_step(item)
        item.entries(required={"repeat", "steps"}, optional={"until"})
        return Loop(
            keys["repeat"].integer(low=1, high=MAX_REPEAT),
            keys["until"].text() if "until" in keys else None,
            tuple(self._plain_step(each) for each in keys["steps"].items()),
        )

    def _plain_step(self, item: Field) -> Step:
        action, argument = _one(item, "action")
        if action not in self.signatures:
            raise item.fail(str(UnknownNameError("action", action, self.signatures)))
        if argument.value is None:
            return Step(action, {})
        wanted = self.signatures[action]
        if not wanted:
            raise argument.fail(f'"{action}" takes no argument.')
        if isinstance(argument.value, dict):
            given = argument.entries(optional=wanted)
            return Step(action, {name: self._handed(value) for name, value in given.items()})
        return Step(action, {wanted[0]: self._handed(argument)})

    def _handed(self, argument: Field) -> str:
        word = argument.text()
        return word if word.startswith(FIXED) else self._parameter(argument)

    def _parameter(self, field: Field) -> str:
        if field.text() not in self.parameters:
            raise field.fail(str(UnknownNameError("parameter", field.value, self.parameters)))
        return field.text()

    def _action(self, field: Field) -> str:
        if field.text() not in self.signatures or field.value == self.name:
            others = set(self.signatures) - {self.name}
            raise field.fail(str(UnknownNameError("other action", field.value, others)))
        return field.text()


def _one(item: Field, what: str) -> tuple[str, Field]:
    keys = item.entries()
    if len(keys) != 1:
        raise item.fail(f"expected one {what} with its argument, found {len(keys)} keys.")
    return next(iter(keys.items()))


def _items(keys: Mapping[str, Field], key: str) -> tuple[Field, ...]:
    return keys[key].items() if key in keys else ()


def _refuse_circles(name: str, spec: Field, trees: Mapping[str, ActionTree]) -> None:
    """Refuse a tree that would never end, or that would be a kind of itself."""
    if name in _reached(name, lambda tree: [step.action for step in tree.all_steps], trees):
        raise spec.fail(f'the tree "{name}" contains itself.')
    if name in _reached(name, lambda tree: [tree.is_a] if tree.is_a else [], trees):
        raise spec.fail(f'the tree "{name}" would be a kind of itself.')


def _reached(
    name: str, following: Callable[[ActionTree], list[str]], trees: Mapping[str, ActionTree]
) -> set[str]:
    seen: set[str] = set()
    waiting = following(trees[name])
    while waiting:
        action = waiting.pop()
        if action in trees and action not in seen:
            seen.add(action)
            waiting += following(trees[action])
    return seen
