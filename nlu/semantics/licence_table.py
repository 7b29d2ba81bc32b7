"""The licence: what a sentence with a meaning may become, by the features of its clauses.

"You might pass a knife by the blade" and "children pass a knife by the blade" have the meaning of a
rule, but nobody says that it is one. One ordered table (`licence.yaml`) says which features of a
sentence let it become a rule, a retraction or a command; all others are asked about. The features
also bound how sure a rule is: "I think a shoe is used for pounding".
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from pathlib import Path
from typing import TypeVar

from ...ontology.yaml_reader import YamlNode, read_yaml
from . import meaning as meanings
from .clause_features import ASIDE, CONDITION, MAIN, UtteranceFeatures, Values

LICENCE_FILE = Path(__file__).parents[2] / "ontology" / "licence.yaml"

ACCEPT = "accept"
ABSENT = "none"  # stands in a row for the absence of a feature

KINDS = ("use", "holding", "correction", "retraction", "command", "prohibition", "norm")

AnyRule = TypeVar("AnyRule", meanings.Rule, meanings.KindRelation)

_CLAUSES = (MAIN, CONDITION, ASIDE)


@dataclass(frozen=True)
class LicenceRow:
    """A row of the table: for the kinds of meaning `of`, with these features, what follows."""

    of: frozenset[str]
    clauses: Mapping[str, Values]  # for each feature, the values of which one must be there
    then: str  # `ACCEPT`, or the name of the answer that asks back

    def applies(self, kinds: frozenset[str], features: UtteranceFeatures) -> bool:
        """Whether the row decides on a meaning of some kinds with these features."""
        return not self.of.isdisjoint(kinds) and all(
            not values.isdisjoint(features.of(clause).get(feature) or {ABSENT})
            for clause, wanted in self.clauses.items()
            for feature, values in wanted.items()
        )


@dataclass(frozen=True)
class LicenceTable:
    """The table of rows, and by feature and value the interval that bounds the one of a rule."""

    rows: Sequence[LicenceRow]
    degrees: Mapping[tuple[str, str], meanings.Confidence]

    def outcome(self, meaning: meanings.Meaning, features: UtteranceFeatures) -> str:
        """Return `ACCEPT`, or the name of the answer that asks whether this is meant."""
        match meaning:
            case meanings.Statement(rules):
                kinds = frozenset(map(_kind, rules))
            case meanings.KindStatement():
                kinds = frozenset({"use"})  # what holds of objects of a kind, as their uses do
            case meanings.NormStatement():
                kinds = frozenset({"norm"})
            case meanings.Retraction():
                kinds = frozenset({"retraction"})
            case meanings.Plan():
                kinds = frozenset({"command"})
            case meanings.Command(negated=negated) | meanings.ToolCommand(negated=negated):
                kinds = frozenset({"prohibition" if negated else "command"})
            case _:
                return ACCEPT
        return next(row.then for row in self.rows if row.applies(kinds, features))

    def weakened(self, meaning: meanings.Meaning, features: UtteranceFeatures) -> meanings.Meaning:
        """Return a meaning whose rules are as sure as their features allow."""
        if not isinstance(meaning, (meanings.Statement, meanings.KindStatement)):
            return meaning
        bounds = [
            self.degrees[feature, value]
            for clause in _CLAUSES
            for feature, values in features.of(clause).items()
            for value in values
            if (feature, value) in self.degrees
        ]
        rules = tuple(_bounded(rule, bounds) for rule in meaning.rules)  # pyright: ignore
        return replace(meaning, rules=rules)  # pyright: ignore


def bounded(interval: meanings.Confidence, bound: meanings.Confidence) -> meanings.Confidence:
    """Return an interval that is no surer than another one.

    Its lower bound is at most that of `bound`. When it says that something is not so, its upper
    bound is at least one minus that. The result contains `interval`, and a weaker bound gives an
    interval that contains that of a stronger one.
    """
    lower, upper = interval
    if upper < meanings.LIKELY:
        return lower, max(upper, round(1 - bound[0], 4))
    return min(lower, bound[0]), upper


def load_licence(
    features: Values, degrees: Mapping[str, meanings.Confidence], path: Path = LICENCE_FILE
) -> LicenceTable:
    """Return the licence of a file, with all values of each feature and the interval per degree.

    `DataError` where it is not as expected, or a kind of meaning has no row without features.
    """
    parts = read_yaml(path).entries(required=("rows", "degrees"), optional=())
    rows = tuple(_row(field, features) for field in parts["rows"].items())
    free = {kind for row in rows if not row.clauses for kind in row.of}
    for kind in KINDS:
        if kind not in free:
            raise parts["rows"].fail(f'there is no last row of "{kind}", without any feature.')
    bounds = {
        (feature, value): degrees[degree.text(choices=degrees)]
        for feature, values in parts["degrees"].entries(optional=features).items()
        for value, degree in values.entries(optional=features[feature]).items()
    }
    return LicenceTable(rows, bounds)


def _row(field: YamlNode, features: Values) -> LicenceRow:
    parts = field.entries(required=("of", "then"), optional=_CLAUSES)
    clauses = {
        clause: {
            name: frozenset(values.texts(choices=features[name] | {ABSENT}))
            for name, values in parts[clause].entries(optional=features).items()
        }
        for clause in _CLAUSES
        if clause in parts
    }
    return LicenceRow(frozenset(parts["of"].texts(choices=KINDS)), clauses, parts["then"].text())


def _kind(rule: meanings.Rule) -> str:
    if rule.revises:
        return "correction"
    return "holding" if isinstance(rule, meanings.ActionRule) else "use"


def _bounded(rule: AnyRule, bounds: Sequence[meanings.Confidence]) -> AnyRule:
    if rule.revises:
        return rule
    return replace(rule, confidence=reduce(bounded, bounds, rule.confidence))
