"""Specificity: which of the rules that apply to an object override others.

A rule is more specific than another if its premises entail all premises of the other, but not
conversely (Poole 1985). The premises are the features and contexts of a rule, and its argument
where an argument is asked for. A premise entails itself and its kinds in the taxonomy; the action
of a node entails those above it in the tree. So more features are more specific than some of them,
and a bread knife is more specific than a knife. Rules that are equally specific, or of which none
is more specific, are fused.

A rule overrides a more general one with the same conclusion. Where the arguments are alternatives,
such as the parts to grasp, it also overrides one that asserts another argument, if it asserts its
own. But it does so only if the premises that it adds are more plausible than not: a rule about
blunt knives says nothing of a knife that does not look blunt. An overridden rule overrides none.
"""

from collections.abc import Callable, Mapping, Sequence

from ..kb.rule import Atom, Rule
from .taxonomy import Taxonomy

MATERIAL = "material"

Premise = tuple[str, Atom]  # "feature", "context" or "argument", and the atom
Premises = frozenset[Premise]
ImpliedAtoms = Mapping[Atom, tuple[int, Atom]]  # atom -> steps up from the given atom, given atom


class Specificity:
    """The order of rules by specificity, at one node for one goal.

    Args:
        taxonomy: the is-a hierarchy.
        actions: the actions above the node with their kinds, nearest first.
        has_material: whether the goal names a material; otherwise materials are no premises.
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
        found = {("feature", atom) for atom in rule.features}
        for atom in rule.contexts:
            if self._has_material or atom.kind != MATERIAL:
                found.add(("context", atom))
        if is_asked and rule.argument:
            found.add(("argument", rule.argument))
        return frozenset(found)

    def _is_more_specific(self, one: Premises, other: Premises) -> bool:
        return one > other or (self._entails_all(one, other) and not self._entails_all(other, one))

    def _entails_all(self, one: Premises, other: Premises) -> bool:
        return all(any(self._entails(a, b) for a in one) for b in other)

    def _entails(self, one: Premise, other: Premise) -> bool:
        if one == other:
            return True
        (role, atom), (other_role, above) = one, other
        if role != other_role or atom.kind != above.kind:
            return False
        if role == "context" and atom.kind == "action":
            return self._distance[atom] < self._distance[above]
        return self._is_kind(atom, above)

    def _is_kind(self, atom: Atom, above: Atom) -> bool:
        if atom.kind == MATERIAL:  # materials are objects in the taxonomy: rye bread is bread
            atom, above = Atom("object", atom.name), Atom("object", above.name)
        return any(kind == above for kind, _ in self._taxonomy.above(atom))

    def _competes(self, one: Rule, other: Rule) -> bool:
        if one.argument is None or other.argument is None or one.argument == other.argument:
            return True
        return self._is_kind(one.argument, other.argument) or (one.asserts and other.asserts)
