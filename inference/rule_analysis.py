"""What rules say of each other and would imply, with no object in view.

Conflicts are pairs of rules, one of which asserts what the other denies, weighted by the mass K of
`Interval.conflict`. Two different parts for one grasp are no contradiction.

Abduction finds hypotheses that would entail or explain a given conclusion: rules are applied
backwards, as in Sarathy & Scheutz (2016). "What would have to be true of an object for it to be
used for cutting?" returns the sufficient antecedents, each with the interval of the conclusion;
"which context explains that it was passed by the blade?" returns the contexts in which that
conclusion holds, the most plausible first.
"""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations

from ..kb.formats.value_notation import read_atom
from ..kb.interval import EPSILON, Interval
from ..kb.rule import ARGUMENT_KINDS, GRASP_OBJECT, USED_FOR, Atom, Rule
from .interval_operators import Operators, relative_plausibility
from .proof import Json
from .taxonomy import FLAT, Taxonomy
from .types import Conclusion

_FUNCTORS = {"affordance": USED_FOR, "part": GRASP_OBJECT}


@dataclass(frozen=True)
class Hypothesis:
    """An antecedent that would entail the conclusion, and the interval of that by the rules."""

    features: frozenset[Atom]
    contexts: frozenset[Atom]
    interval: Interval
    rules: tuple[Rule, ...]

    def as_json(self) -> Json:
        """Return the JSON object that `hilt abduce --json` prints."""
        return {
            "features": sorted(map(str, self.features)),
            "contexts": sorted(map(str, self.contexts)),
            "lower": self.interval.lower,
            "upper": self.interval.upper,
            "rules": [rule.id for rule in self.rules],
        }


def parse_conclusion(text: str) -> Conclusion:
    """Parse an atom with a known functor, or functor(argument); ValidationError if it is neither.

    >>> print(parse_conclusion("part:blade"), parse_conclusion("cutWith(object:bread)"))
    graspObject(part:blade) cutWith(object:bread)
    """
    functor, bracket, rest = text.partition("(")
    if bracket:
        name = rest.rstrip().removesuffix(")").strip()
        argument = read_atom(name, ARGUMENT_KINDS.get(functor, "object")) if name else None
        return Conclusion(functor.strip(), argument)
    if ":" not in text:
        return Conclusion(text)
    argument = Atom.parse(text)
    return Conclusion(_FUNCTORS.get(argument.kind, GRASP_OBJECT), argument)


def find_hypotheses(
    rules: Iterable[Rule],
    conclusion: Conclusion,
    *,
    given: frozenset[Atom] = frozenset(),
    taxonomy: Taxonomy = FLAT,
) -> list[Hypothesis]:
    """Return the hypotheses under which a conclusion is more plausible than its negation.

    The most plausible one is first. Rules with the same antecedent are fused. Atoms that are
    `given` hold: they are left out of the hypotheses, and rules about other objects than the given
    one are ignored. Along the taxonomy a given bread knife is a knife.
    """
    known = frozenset(above for atom in given for above, _ in taxonomy.above(atom))
    groups: dict[frozenset[Atom], list[Rule]] = defaultdict(list)
    objects = {atom for atom in known if atom.kind == "object"}
    for rule in rules:
        wanted = {atom for atom in rule.features if atom.kind == "object"}
        concludes = conclusion.argument in {None, rule.argument}
        if rule.functor == conclusion.functor and concludes and (not objects or wanted <= objects):
            groups[rule.features | rule.contexts].append(rule)
    found = (
        Hypothesis(
            group[0].features - known,
            group[0].contexts - known,
            Operators().fuse([rule.support for rule in group]),
            tuple(group),
        )
        for group in groups.values()
    )
    by_name = sorted(found, key=lambda each: sorted(map(str, each.features | each.contexts)))
    by_name.sort(key=lambda each: -relative_plausibility(each.interval))
    return [each for each in by_name if relative_plausibility(each.interval) > 0.5]


@dataclass(frozen=True)
class Conflict:
    """Two rules of one antecedent and conclusion, the earlier one first, and their K in [0, 1]."""

    first: Rule
    second: Rule
    weight: float

    def as_json(self) -> Json:
        """Return the JSON object that `hilt conflicts --json` prints."""
        return {"rules": [self.first.as_json(), self.second.as_json()], "weight": self.weight}


def find_conflicts(rules: Iterable[Rule]) -> list[Conflict]:
    """Return the pairs of rules that contradict each other, weighted by trust, heaviest first."""
    groups: dict[tuple[frozenset[Atom], str, Atom | None], list[Rule]] = defaultdict(list)
    for rule in rules:
        groups[rule.features | rule.contexts, rule.functor, rule.argument].append(rule)
    pairs = (pair for group in groups.values() for pair in combinations(group, 2))
    found = [Conflict(a, b, a.support.conflict(b.support)) for a, b in pairs]
    heavy = [each for each in found if each.weight > EPSILON]
    return sorted(heavy, key=lambda each: (-each.weight, each.first.id, each.second.id))
