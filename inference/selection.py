# SPDX-License-Identifier: Apache-2.0
"""Which rules matter at a node: those that hang there, whose contexts hold, and the nearest first.

A `NodeContext` is one node of an action tree with one goal. What it selects is worked out once, for
all the things that are then seen there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property

from ..kb.rule import USED_FOR, Atom, Rule
from .decision import Applicable
from .settings import Settings
from .taxonomy import Taxonomy
from .types import Conclusion, Goal

FIND = "findObject"  # the action whose rules say which thing: usedFor(object, affordance)

Shown = Mapping[Atom, tuple[int, Atom]]  # what holds -> steps up from what was seen, and that


class NodeContext:
    """One node with one goal.

    Args:
        node: the path of the node.
        goal: what the walk is for.
        rules_at: the rules that hang under a key.
        taxonomy: what is a kind of what.
    """

    def __init__(
        self,
        node: str,
        goal: Goal,
        rules_at: Callable[[str], Sequence[Rule]],
        taxonomy: Taxonomy,
    ) -> None:
        self.node, self.goal, self.taxonomy = node, goal, taxonomy
        self.action = node.rsplit("/", 1)[-1]
        self._rules_at = rules_at
        self._relevant: dict[str, Sequence[Rule]] = {}

    @cached_property
    def contexts(self) -> tuple[Atom, ...]:
        """The actions above the node, nearest first, each with what it is a kind of."""
        acting = (Atom("action", name) for name in contexts_of(self.node))
        return tuple(
            dict.fromkeys(above for atom in acting for above, _ in self.taxonomy.above(atom))
        )

    @cached_property
    def given(self) -> Shown:
        """What else holds here, with what it is a kind of."""
        return closure(self.goal.contexts, self.taxonomy)

    @cached_property
    def asked(self) -> tuple[Atom, ...]:
        """The features that the command itself names, which matter at the find node only."""
        if self.action != FIND:
            return ()
        target = self.goal.target
        named = [Atom("object", target.object)] if target.object else []
        return (*named, *(Atom("property", name) for name in sorted(target.properties)))

    @cached_property
    def levels(self) -> tuple[str, ...]:
        """The keys under which rules of this node hang, nearest context first."""
        if self.action != FIND:
            return self._keys(self.action)
        wanted = (self.keys_of(conclusion) for conclusion, _ in self.goal.target.wanted)
        return tuple(key for keys in wanted for key in keys)

    def keys_of(self, wanted: Conclusion) -> tuple[str, ...]:
        """The keys under which rules hang that conclude what is wanted of a thing."""
        if wanted.functor == USED_FOR and wanted.argument:
            return (f"{FIND}.{wanted.argument.name}",)
        return self._keys(wanted.functor)

    def threshold(self, settings: Settings) -> float:
        """Λ here."""
        if not settings.thresholds:
            return settings.threshold
        return settings.threshold_of((context.name for context in self.contexts), self.given)

    def relevant(self, key: str) -> Sequence[Rule]:
        """The rules under a key whose contexts hold and, past the find node, whose object fits."""
        if key not in self._relevant:
            held = {*self.contexts, *self.given}
            rules = [rule for rule in self._rules_at(key) if rule.contexts <= held]
            name = self.goal.target.object
            if name is not None and self.action != FIND:
                wanted = {above.name for above, _ in self.taxonomy.above(Atom("object", name))}
                rules = [rule for rule in rules if rule.object is None or rule.object in wanted]
            self._relevant[key] = rules
        return self._relevant[key]

    def concluding(self, wanted: Conclusion, shown: Shown) -> Applicable:
        """The rules of the nearest context that conclude what is wanted of a thing."""
        arguments = closure([wanted.argument], self.taxonomy) if wanted.argument else None
        for key in self.keys_of(wanted):
            rules = self.relevant(key)
            if arguments is not None:
                rules = [r for r in rules if r.argument is None or r.argument in arguments]
            applied = nearest(rules, shown, arguments or {})
            if applied.rules:
                return applied
        return Applicable()

    def _keys(self, functor: str) -> tuple[str, ...]:
        return (*(f"{context.name}.{functor}" for context in self.contexts), functor)


def closure(atoms: Iterable[Atom], taxonomy: Taxonomy) -> Shown:
    """What atoms show: themselves and what they are kinds of, with distance and origin."""
    found: dict[Atom, tuple[int, Atom]] = {}
    for atom in atoms:
        for above, distance in taxonomy.above(atom):
            if above not in found or distance < found[above][0]:
                found[above] = (distance, atom)
    return found


def nearest(rules: Sequence[Rule], shown: Shown, arguments: Shown | None = None) -> Applicable:
    """Of rules those all of whose features are shown, and of these the nearest."""
    fitting = [rule for rule in rules if rule.features <= shown.keys()]
    if not fitting:
        return Applicable()
    pairs = [(rule, _distance(rule, shown, arguments or {})) for rule in fitting]
    least = min(distance for _, distance in pairs)
    near = tuple(rule for rule, distance in pairs if distance == least)
    return Applicable(near, least, tuple(rule for rule, far in pairs if far > least))


def contexts_of(node: str) -> tuple[str, ...]:
    """The contexts of a node, nearest first: the actions above it on its path."""
    return tuple(reversed(node.split("/")[:-1]))


def _distance(rule: Rule, shown: Shown, arguments: Shown) -> int:
    """How many steps up from what is seen, and from what is wanted, a rule was found."""
    above = max((shown[feature][0] for feature in rule.features), default=0)
    if rule.argument is None or rule.argument not in arguments:
        return above
    return above + arguments[rule.argument][0]
