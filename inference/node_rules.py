"""The rules that apply at a node of an action tree for a goal, and which of them override others.

A use may have a material, which is a context of its rule: a saw is used for cutting wood. Which
rules apply depends on whether the goal names a material:

| rule | asked for bread | asked for no material |
|---|---|---|
| used for cutting; not used for cutting | applies | applies |
| used for cutting bread | applies | applies |
| not used for cutting bread | applies | does not apply |
| used, or not used, for cutting wood | does not apply | as for bread |

A rule that names a part of any object ("to pass anything, grab it by the handle") applies to the
objects that have such a part: the part is one of its features.

A rule is more specific than another if its premises entail all premises of the other, but not
conversely (Poole 1985). The premises are the features and contexts of a rule, and its argument
where an argument is asked for. A premise entails itself and its kinds in the taxonomy; the action
of a node entails those above it in the tree. So more features are more specific than some of them,
and a bread knife is more specific than a knife. Rules of which none is more specific are fused.

A rule overrides a more general one with the same conclusion. Where the arguments are alternatives,
such as the parts to grasp, it also overrides one that asserts another argument, if it asserts its
own. But it does so only if the premises that it adds are more plausible than not: a rule about
blunt knives says nothing of a knife that does not look blunt. An overridden rule overrides none.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from ..kb.interval import EPSILON
from ..kb.rule import GRASP_OBJECT, USED_FOR, Atom, Rule
from ..ontology.actions import Actions
from .taxonomy import ImpliedAtoms, Taxonomy
from .types import Conclusion, Goal, Observation

FIND = "findObject"  # the action that selects an object; its rules conclude usedFor(affordance)
GRASP = "grasp"  # the action of which every grasp is one: "never grab a knife by the blade"

Premise = tuple[str, Atom]  # "feature", "context" or "argument", and the atom
Premises = frozenset[Premise]


@dataclass(frozen=True)
class ObjectRules:
    """The most specific rules that apply to an object.

    `overrides` are pairs of one of these and a rule that it overrides; `distances` maps the
    features of a rule to their distance in the is-a hierarchy.
    """

    rules: tuple[Rule, ...] = ()
    overrides: tuple[tuple[Rule, Rule], ...] = ()
    distances: Mapping[frozenset[Atom], int] = field(default_factory=dict[frozenset[Atom], int])

    @property
    def distance(self) -> int:
        """The distance of the nearest rule: 0 for a rule about exactly this kind."""
        return min((self.distances.get(rule.features, 0) for rule in self.rules), default=0)

    @property
    def overruled(self) -> tuple[Rule, ...]:
        """The rules that more specific ones override."""
        return tuple(dict.fromkeys(general for _, general in self.overrides))

    def by_argument(self) -> "dict[Atom | None, ObjectRules]":
        """Return the rules about each argument."""
        found: dict[Atom | None, ObjectRules] = {}
        for argument in dict.fromkeys(rule.argument for rule in self.rules):
            rules = tuple(rule for rule in self.rules if rule.argument == argument)
            pairs = tuple(pair for pair in self.overrides if pair[0].argument == argument)
            found[argument] = ObjectRules(rules, pairs, self.distances)
        return found


class Specificity:
    """The order of rules by specificity, at one node for one goal.

    `actions` are those above the node, with their kinds, nearest first. Materials are premises only
    if the goal names one: `has_material`.
    """

    def __init__(self, taxonomy: Taxonomy, actions: Sequence[Atom], *, has_material: bool) -> None:
        self._taxonomy = taxonomy
        self._distance = {action: index for index, action in enumerate(actions)}
        self._has_material = has_material

    def overriding_rules(
        self,
        rules: Sequence[Rule],
        is_affirmed: Callable[[Premises, Premises], bool],
        *,
        is_asked: bool,
    ) -> Sequence[Sequence[Rule]]:
        """Return for each rule those that override it: none for the most specific ones.

        `is_affirmed` tells of the premises of two rules whether those that the first one adds are
        more plausible than not. With `is_asked`, all rules are about one argument or a kind of it;
        otherwise their arguments are alternatives.
        """
        if len({(rule.features, rule.contexts, is_asked and rule.argument) for rule in rules}) < 2:
            return [()] * len(rules)
        premises = [self._premises(rule, is_asked=is_asked) for rule in rules]
        specific = [
            [i for i, one in enumerate(premises) if self._is_more_specific(one, other)]
            for other in premises
        ]
        found: list[Sequence[Rule]] = [()] * len(rules)
        # A rule comes after all that are more specific: each of them has fewer above it.
        for index in sorted(range(len(rules)), key=lambda each: len(specific[each])):
            found[index] = [
                rules[each]
                for each in specific[index]
                if not found[each]
                and is_affirmed(premises[each], premises[index])
                and (is_asked or self._competes(rules[each], rules[index]))
            ]
        return found

    def is_more_specific(self, one: Rule, other: Rule) -> bool:
        """Return whether the premises and the argument of one rule entail those of another."""
        premises = (self._premises(rule, is_asked=True) for rule in (one, other))
        return self._is_more_specific(*premises)

    def _premises(self, rule: Rule, *, is_asked: bool) -> Premises:
        contexts = (a for a in rule.contexts if self._has_material or a.kind != "material")
        premises = {("feature", a) for a in rule.features} | {("context", a) for a in contexts}
        return frozenset(premises | {("argument", a) for a in (rule.argument,) if is_asked and a})

    def _is_more_specific(self, one: Premises, other: Premises) -> bool:
        return one > other or (self._entails(one, other) and not self._entails(other, one))

    def _entails(self, one: Premises, other: Premises) -> bool:
        return all(any(a == b or self._is_below(a, b) for a in one) for b in other)

    def _is_below(self, one: Premise, other: Premise) -> bool:
        (role, atom), (other_role, above) = one, other
        if role != other_role or atom.kind != above.kind:
            return False
        if role == "context" and atom.kind == "action":
            return self._distance[atom] < self._distance[above]
        return self._is_kind(atom, above)

    def _is_kind(self, atom: Atom, above: Atom) -> bool:
        if atom.kind == "material":  # materials are objects in the taxonomy: rye bread is bread
            atom, above = Atom("object", atom.name), Atom("object", above.name)
        return any(kind == above for kind, _ in self._taxonomy.above(atom))

    def _competes(self, one: Rule, other: Rule) -> bool:
        if one.argument is None or other.argument is None:
            return True
        return self._is_kind(one.argument, other.argument) or (one.asserts and other.asserts)


class NodeRules:
    """The rules that apply at one node for one goal, of those that `rules_at` has under a key."""

    def __init__(
        self, node: str, goal: Goal, rules_at: Callable[[str], Sequence[Rule]], taxonomy: Taxonomy
    ) -> None:
        self.node, self.goal, self.taxonomy = node, goal, taxonomy
        self.action = node.rpartition("/")[2]
        self._rules_at = rules_at
        self._selected: dict[str, Sequence[Rule]] = {}
        self._held = frozenset((*self.contexts, *self.given))
        material = goal.target.material
        self._material = taxonomy.names_above("object", material)
        self._order = Specificity(taxonomy, self.contexts, has_material=material is not None)

    @cached_property
    def contexts(self) -> tuple[Atom, ...]:
        """The actions above the node, nearest first, each with its more general actions."""
        itself = (GRASP,) if self.action == GRASP_OBJECT else ()  # whatever for
        acting = (Atom("action", name) for name in (*Actions.contexts(self.node), *itself))
        kinds = (above for atom in acting for above, _ in self.taxonomy.above(atom))
        return tuple(dict.fromkeys(kinds))

    @cached_property
    def given(self) -> ImpliedAtoms:
        """The other contexts of the goal, with their more general kinds."""
        return self.taxonomy.implied(self.goal.contexts)

    @cached_property
    def named_features(self) -> tuple[Atom, ...]:
        """The features that the command itself names; used at the find node only."""
        if self.action != FIND:
            return ()
        target = self.goal.target
        named = [Atom("object", target.object)] if target.object else []
        return (*named, *(Atom("property", name) for name in sorted(target.properties)))

    @cached_property
    def keys(self) -> tuple[str, ...]:
        """The keys of the rules of this node, nearest context first."""
        if self.action != FIND:
            return self.keys_of(Conclusion(self.action))
        wanted = (self.keys_of(conclusion) for conclusion, _ in self.goal.target.wanted)
        return tuple(key for keys in wanted for key in keys)

    def keys_of(self, wanted: Conclusion) -> tuple[str, ...]:
        """Return the keys of the rules that can conclude what is wanted."""
        if wanted.functor == USED_FOR and wanted.argument:
            return (f"{FIND}.{wanted.argument.name}",)
        return (*(f"{each.name}.{wanted.functor}" for each in self.contexts), wanted.functor)

    @property
    def features(self) -> frozenset[Atom]:
        """Those of the command and of the rules here; if one has none, the found object itself."""
        named = self.goal.target.object
        found = [features_of(rule) for key in self.keys for rule in self.rules(key)]
        itself = {Atom("object", named)} if named and self.action != FIND and not all(found) else ()
        return frozenset(self.named_features).union(itself, *found)

    def rules(self, key: str) -> Sequence[Rule]:
        """Return the rules of a key whose contexts hold and (past the find node) object fits."""
        if key not in self._selected:
            rules = [rule for rule in self._rules_at(key) if rule.applies_to(self._material)]
            if (name := self.goal.target.object) is not None and self.action != FIND:
                wanted = {None, *self.taxonomy.names_above("object", name)}
                rules = [rule for rule in rules if rule.object in wanted]
            holds = self._held.issuperset
            self._selected[key] = [
                rule for rule in rules if holds(a for a in rule.contexts if a.kind != "material")
            ]
        return self._selected[key]

    def concluding(self, wanted: Conclusion, seen: Observation, shown: ImpliedAtoms) -> ObjectRules:
        """Return the most specific rules that conclude what is wanted of an object."""
        rules = [rule for key in self.keys_of(wanted) for rule in self.rules(key)]
        if wanted.argument is not None:
            asked = self.taxonomy.implied([wanted.argument])
            rules = [rule for rule in rules if rule.argument is None or rule.argument in asked]
        return self._most_specific(rules, seen, shown, is_asked=True)

    def binding(self, seen: Observation, shown: ImpliedAtoms) -> ObjectRules:
        """Return the most specific rules about the action of this node on an object."""
        rules = [rule for key in self.keys for rule in self.rules(key)]
        return self._most_specific(rules, seen, shown, is_asked=False)

    def _most_specific(
        self, rules: Sequence[Rule], seen: Observation, shown: ImpliedAtoms, *, is_asked: bool
    ) -> ObjectRules:
        # What asserts and denies nothing only says on what a use rests (`induction`). The interval
        # is read last: the decision must not depend on those of rules about other objects.
        fitting = [r for r in rules if features_of(r) <= shown.keys() and not r.interval.is_vacuous]

        def is_affirmed(*premises: Premises) -> bool:
            known, evidence = {**self.given, **shown}, {**self.goal.contexts, **seen.atoms}
            one, other = ({known[a][1] for _, a in each if a in known} for each in premises)
            return all(evidence[a].lower + evidence[a].upper > 1 + EPSILON for a in one - other)

        overriding = self._order.overriding_rules(fitting, is_affirmed, is_asked=is_asked)
        pairs = list(zip(fitting, overriding, strict=True))
        return ObjectRules(
            tuple(rule for rule, by in pairs if not by),
            tuple((one, rule) for rule, by in pairs for one in by),
            # That of the features in the is-a hierarchy.
            {r.features: max((shown[f][0] for f in r.features), default=0) for r in fitting},
        )


def acting_for(node: str) -> str:
    """Return the action that a node is part of: "pass" for "pass/graspObject"."""
    return next(iter(Actions.contexts(node)), node)


def features_of(rule: Rule) -> frozenset[Atom]:
    """Return the features that an object must show for a rule; its part, for one about any."""
    argument = rule.argument
    if argument is None or argument.kind != "part" or rule.object is not None:
        return rule.features
    return rule.features | {argument}
