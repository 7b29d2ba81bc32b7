# SPDX-License-Identifier: Apache-2.0
"""Abduction: from a conclusion back to what would bring it about, or what explains it.

As in Sarathy & Scheutz (2016): rules are read from right to left. "What would have to be true of an
object for it to be used for cutting?" gives the antecedents that would do, with what each would
come to; "which context explains that it was passed by the blade?" gives the contexts under which
that is the thing to do, the likeliest first.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from ..kb.formats.notation import read_atom
from ..kb.interval import Interval
from ..kb.rule import GRASP_OBJECT, USED_FOR, Atom, Rule
from .evidence import relative_plausibility
from .settings import Settings
from .taxonomy import FLAT, Taxonomy
from .types import Conclusion

Json = dict[str, object]

_FUNCTORS = {"affordance": USED_FOR, "part": GRASP_OBJECT}
_KINDS = {USED_FOR: "affordance", GRASP_OBJECT: "part"}


@dataclass(frozen=True)
class Hypothesis:
    """Something that, if it were so, would bring the conclusion about.

    Attributes:
        features: what would have to be seen.
        contexts: what would have to be going on.
        interval: what the conclusion would then come to.
        rules: those it rests on.
    """

    features: frozenset[Atom]
    contexts: frozenset[Atom]
    interval: Interval
    rules: tuple[Rule, ...]

    def as_json(self) -> Json:
        """As `hilt abduce --json` prints it."""
        return {
            "features": sorted(map(str, self.features)),
            "contexts": sorted(map(str, self.contexts)),
            "lower": self.interval.lower,
            "upper": self.interval.upper,
            "rules": [rule.id for rule in self.rules],
        }


def concluded(text: str) -> Conclusion:
    """The conclusion that a person writes: an atom of a known functor, or functor(argument).

    >>> print(concluded("part:blade"), concluded("cutWith(object:bread)"))
    graspObject(part:blade) cutWith(object:bread)

    Raises:
        ValidationError: it names nothing.
    """
    functor, bracket, rest = text.partition("(")
    if bracket:
        name = rest.rstrip().removesuffix(")").strip()
        return Conclusion(
            functor.strip(), read_atom(name, _KINDS.get(functor, "object")) if name else None
        )
    if ":" not in text:
        return Conclusion(text)
    argument = Atom.parse(text)
    return Conclusion(_FUNCTORS.get(argument.kind, GRASP_OBJECT), argument)


def hypotheses(
    rules: Iterable[Rule],
    conclusion: Conclusion,
    *,
    given: frozenset[Atom] = frozenset(),
    settings: Settings | None = None,
    taxonomy: Taxonomy = FLAT,
) -> list[Hypothesis]:
    """What would bring a conclusion about, the likeliest first.

    Args:
        rules: those to read backwards.
        conclusion: usedFor(cutting), graspObject(blade), cutWith(bread).
        given: what is known to hold; left out of the hypotheses, and a rule about another object
            than a given one explains nothing.
        settings: the choices of the theory; rules with the same antecedent are fused.
        taxonomy: what is a kind of what: a given bread knife is a knife.

    Returns:
        Only hypotheses under which the conclusion is rather true than false.
    """
    operators = (settings or Settings()).operators
    known = frozenset(above for atom in given for above, _ in taxonomy.above(atom))
    groups: dict[frozenset[Atom], list[Rule]] = defaultdict(list)
    for rule in rules:
        if _concludes(rule, conclusion) and _is_compatible(rule, known):
            groups[rule.features | rule.contexts].append(rule)
    found = (
        Hypothesis(
            group[0].features - known,
            group[0].contexts - known,
            operators.fuse([rule.support for rule in group]),
            tuple(group),
        )
        for group in groups.values()
    )
    likely = [each for each in found if relative_plausibility(each.interval) > 0.5]
    return sorted(likely, key=lambda each: (-relative_plausibility(each.interval), _name(each)))


def _concludes(rule: Rule, conclusion: Conclusion) -> bool:
    return rule.functor == conclusion.functor and conclusion.argument in {None, rule.argument}


def _is_compatible(rule: Rule, given: frozenset[Atom]) -> bool:
    objects = {atom for atom in given if atom.kind == "object"}
    wanted = {atom for atom in rule.features if atom.kind == "object"}
    return not objects or wanted <= objects


def _name(hypothesis: Hypothesis) -> str:
    return " ".join(sorted(map(str, hypothesis.features | hypothesis.contexts)))
