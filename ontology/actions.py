"""Action trees, and their reader: how a goal is carried out (paper, sections 3.3, 4.2, Figure 3).

The steps of a tree are executed in preorder. Each step is a primitive, which vision or motion
performs, or another tree; a `Step` says which of the tree's arguments it passes on. A tree may have
preconditions, and branches that handle failures. Trees are data in YAML: `actions.yaml` holds those
of Hilt, and a file in the same form adds primitives and trees, or replaces trees of the same name.
`docs/actions.md` describes all keys.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from .errors import UnknownNameError
from .yaml_reader import YamlNode, read_yaml

ACTIONS_FILE = Path(__file__).with_name("actions.yaml")
MAX_REPEAT = 100
MAX_AGAIN = 10
SPEAKER = "speaker"

_TREE_KEYS = frozenset({"defaults", "requires", "otherwise", "is_a"})
_BRANCHES = ("next", "again", "steps")
FIXED = "="  # prefix of a step's argument that is a literal word
ANY_FAILURE = "any"
CONDITIONS = ("sees", "holds")


@dataclass(frozen=True)
class ArgumentByAffordance:
    """An argument given by what it must afford instead of by an object."""

    functor: str  #: of the conclusion: "usedFor", "cutWith"
    argument: str | None = None  #: its argument where it needs one: "affordance:pounding"
    of: str | None = None  #: or the parameter whose object is its argument: cutWith(X, it)


@dataclass(frozen=True)
class DescribedObject:
    """An argument given by a description: "the red mug", "something used for cutting"."""

    object: str | None = None  #: its kind; None for any
    used_for: str | None = None  #: the affordance that it must have
    not_used_for: str | None = None  #: the affordance that it must not have
    properties: frozenset[str] = frozenset()  #: all of which it has
    material: str | None = None  #: for which the affordance is wanted


@dataclass(frozen=True)
class Step:
    """A step of an action tree: a primitive or a tree."""

    action: str
    arguments: Mapping[str, str | DescribedObject]  #: parameter -> argument of the tree, or "=word"
    part: str | None = None  #: by which the step holds its object; None leaves it to the rules


@dataclass(frozen=True)
class Loop:
    """Steps repeated at most `times` times, until the robot senses `until`."""

    times: int
    until: str | None
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class Precondition:
    """A precondition of an action tree."""

    kind: str  #: "sees" (it is in view), "holds" (it is in the hand) or "is" (it has a property)
    parameter: str  #: the argument it is about, or "=object"
    property: str | None = None  #: the property that "is" asks for
    negated: bool = False  #: whether it must not be so


@dataclass(frozen=True)
class FailureBranch:
    """What to do after a failure: at most one of the last three attributes, or the tree fails."""

    after: frozenset[str]  #: the failures it handles, some of `Actions.failures` or "any"
    next: str | None = None  #: the parameter for which the next best candidate is tried
    again: int = 0  #: how often the steps are repeated
    steps: tuple[Step | Loop, ...] = ()  #: other steps; when they succeed, the tree above goes on

    @property
    def is_end(self) -> bool:
        """Whether nothing is tried after the failure."""
        return not (self.next or self.again or self.steps)

    def handles(self, failure: str) -> bool:
        """Whether the branch handles a failure."""
        return ANY_FAILURE in self.after or failure in self.after


@dataclass(frozen=True)
class ActionTree:
    """The steps that achieve one kind of goal, and their preconditions."""

    name: str  #: the predicate of the goal
    parameters: tuple[str, ...]  #: the arguments of the predicate, in order
    #: parameter -> its value when it is not given; "speaker" is who asked
    defaults: Mapping[str, str | ArgumentByAffordance]
    steps: tuple[Step | Loop, ...]  #: executed in preorder
    requires: tuple[Precondition, ...] = ()
    otherwise: tuple[FailureBranch, ...] = ()  #: the first that handles a failure is taken
    is_a: str | None = None  #: the more general action whose rules it inherits
    #: parameter -> the kind of object that it was taught for; None if it is of a file
    objects: Mapping[str, str] | None = None

    @property
    def all_steps(self) -> Iterator[Step]:
        """All steps, including those inside loops and branches, once each."""
        yield from iterate_steps(self.steps)
        for branch in self.otherwise:
            yield from iterate_steps(branch.steps)


@dataclass(frozen=True)
class Actions:
    """The primitives and action trees of the robot, and the failures that branches may handle.

    >>> actions = load_actions()
    >>> [step.action for step in actions.tree("pass").steps]
    ['findObject', 'graspObject', 'moveTo', 'handOver']
    >>> actions.contexts("pickUp/graspObject")
    ('pickUp',)
    """

    primitives: Mapping[str, tuple[str, ...]]
    trees: Mapping[str, ActionTree] = field(default_factory=dict[str, ActionTree])
    failures: frozenset[str] = frozenset()

    def tree(self, name: str) -> ActionTree:
        """Return the tree of a goal; `UnknownNameError` if there is none."""
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
        """Action -> the more general action, for the actions that have one."""
        return {name: tree.is_a for name, tree in self.trees.items() if tree.is_a}

    def used_by(self, name: str) -> set[str]:
        """Return the trees that a tree contains, directly or through others."""
        return _reached(name, lambda tree: [step.action for step in tree.all_steps], self.trees)

    def _paths(self, name: str, path: str) -> Iterator[str]:
        yield path
        for step in self.trees[name].all_steps if name in self.trees else ():
            yield from self._paths(step.action, f"{path}/{step.action}")


def iterate_steps(steps: tuple[Step | Loop, ...]) -> Iterator[Step]:
    """Yield the steps, including those inside loops, once each."""
    for step in steps:
        yield from step.steps if isinstance(step, Loop) else (step,)


def load_actions(path: Path = ACTIONS_FILE, *, added_to: Actions | None = None) -> Actions:
    """Read the action trees of a file, which may use and add to others; `DataError` if invalid."""
    known = added_to or Actions({})
    top = read_yaml(path).entries(required=["trees"], optional=["primitives", "failures"])
    added = top["primitives"].entries() if "primitives" in top else {}
    primitives = {**known.primitives, **{name: spec.texts() for name, spec in added.items()}}
    specs = top["trees"].entries()
    failures = known.failures.union(top["failures"].texts() if "failures" in top else ())
    signatures = {**primitives, **{name: each.parameters for name, each in known.trees.items()}}
    keys = {
        name: spec.entries(required={"parameters", "steps"}, optional=_TREE_KEYS)
        for name, spec in specs.items()
    }
    signatures |= {name: each["parameters"].texts() for name, each in keys.items()}
    trees = dict(known.trees)
    for name, each in keys.items():
        trees[name] = _TreeReader(name, each, signatures, failures).read()
    actions = Actions(primitives, trees, failures)
    for name, spec in specs.items():
        if name in actions.used_by(name):
            raise spec.fail(f'the tree "{name}" contains itself.')
        if name in _reached(name, lambda tree: [tree.is_a] if tree.is_a else [], trees):
            raise spec.fail(f'the tree "{name}" would be a kind of itself.')
    return actions


@dataclass(frozen=True)
class _TreeReader:
    name: str
    keys: Mapping[str, YamlNode]
    signatures: Mapping[str, tuple[str, ...]]
    failures: Collection[str]

    def read(self) -> ActionTree:
        keys, parameters = self.keys, self.signatures[self.name]
        others = self.signatures.keys() - {self.name}
        defaults = keys["defaults"].entries(optional=parameters) if "defaults" in keys else {}
        given = {key: keys[key].items() if key in keys else () for key in ("requires", "otherwise")}
        return ActionTree(
            self.name,
            parameters,
            {parameter: self._default(value) for parameter, value in defaults.items()},
            self._steps(keys["steps"]),
            tuple(self._condition(item) for item in given["requires"]),
            tuple(self._branch(item) for item in given["otherwise"]),
            keys["is_a"].text(choices=others) if "is_a" in keys else None,
        )

    def _default(self, value: YamlNode) -> str | ArgumentByAffordance:
        if isinstance(value.value, str):
            return value.text(choices={SPEAKER})
        keys = value.entries(optional={"usedFor", "affords", "of"})
        if "usedFor" in keys:
            value.entries(required={"usedFor"}, optional=())
            return ArgumentByAffordance("usedFor", f"affordance:{keys['usedFor'].text()}")
        value.entries(required={"affords"}, optional={"of"})
        of = self._parameter(keys["of"]) if "of" in keys else None
        return ArgumentByAffordance(keys["affords"].text(), of=of)

    def _condition(self, item: YamlNode) -> Precondition:
        kind, parameter = _single_entry(item, "condition")
        return Precondition(kind.text(choices=CONDITIONS), self._parameter(parameter))

    def _branch(self, item: YamlNode) -> FailureBranch:
        keys = item.entries(required={"after"}, optional=_BRANCHES)
        if len(given := [key for key in _BRANCHES if key in keys]) != 1:
            found = " and ".join(given) or "none"
            raise item.fail(f"expected one of {', '.join(_BRANCHES)}, found {found}.")
        after, is_any = keys["after"], keys["after"].value == ANY_FAILURE
        return FailureBranch(
            frozenset([ANY_FAILURE] if is_any else after.texts(choices=self.failures)),
            self._parameter(keys["next"]) if "next" in keys else None,
            keys["again"].integer(low=1, high=MAX_AGAIN) if "again" in keys else 0,
            self._steps(keys["steps"]) if "steps" in keys else (),
        )

    def _steps(self, field: YamlNode) -> tuple[Step | Loop, ...]:
        return tuple(self._step(item) for item in field.items())

    def _step(self, item: YamlNode) -> Step | Loop:
        if "repeat" not in (keys := item.entries()):
            return self._plain_step(item)
        item.entries(required={"repeat", "steps"}, optional={"until"})
        return Loop(
            keys["repeat"].integer(low=1, high=MAX_REPEAT),
            keys["until"].text() if "until" in keys else None,
            tuple(self._plain_step(each) for each in keys["steps"].items()),
        )

    def _plain_step(self, item: YamlNode) -> Step:
        key, argument = _single_entry(item, "action")
        action = key.text(choices=self.signatures)
        if argument.value is None:
            return Step(action, {})
        if not (wanted := self.signatures[action]):
            raise argument.fail(f'"{action}" takes no argument.')
        if isinstance(argument.value, dict):
            given = argument.entries(optional=wanted)
            return Step(action, {name: self._step_argument(value) for name, value in given.items()})
        return Step(action, {wanted[0]: self._step_argument(argument)})

    def _step_argument(self, argument: YamlNode) -> str:
        word = argument.text()
        return word if word.startswith(FIXED) else self._parameter(argument)

    def _parameter(self, field: YamlNode) -> str:
        return field.text(choices=self.signatures[self.name])


def _single_entry(item: YamlNode, what: str) -> tuple[YamlNode, YamlNode]:
    if len(keys := item.entries()) != 1:
        raise item.fail(f"expected one {what} with its argument, found {len(keys)} keys.")
    return item.keys[0], keys[item.keys[0].value]


def _reached(
    name: str, following: Callable[[ActionTree], list[str]], trees: Mapping[str, ActionTree]
) -> set[str]:
    seen: set[str] = set()
    waiting = following(trees[name])
    while waiting:
        if (action := waiting.pop()) in trees and action not in seen:
            seen.add(action)
            waiting += following(trees[action])
    return seen
