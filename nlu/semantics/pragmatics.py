"""Pragmatic rules: from a speech act to the speaker's intention.

`STATEMENT(A,B,X) => wantBelieve(A,B,X)`: a person who states something to an agent wants the agent
to believe it. The rules are data (`pragmatics.yaml`), each with an interval of confidence, as in
Scheutz et al. (2013) and Williams et al. (2015). Paper, section 3.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ...ontology.confidence import read_interval
from ...ontology.evidence_operators import (
    certainty,
    fuse_yager,
    modus_ponens,
    relative_plausibility,
)
from ...ontology.yaml_reader import YamlNode, read_yaml
from ..grammar.notation_reader import read_rule
from ..grammar.terms import evaluate
from .meaning import Confidence
from .predicates import PredicateForm, fill, form_of, match

CERTAIN: Confidence = (1.0, 1.0)

PRAGMATICS_FILE = Path(__file__).parents[2] / "ontology" / "pragmatics.yaml"


@dataclass(frozen=True)
class PragmaticRule:
    """A rule from the pattern of a speech act to an intention, and its (lower, upper) in [0, 1]."""

    act: PredicateForm
    intention: PredicateForm
    interval: Confidence


@dataclass(frozen=True)
class Pragmatics:
    """The pragmatic rules, and the least certainty of an intention, in [0, 1]."""

    rules: tuple[PragmaticRule, ...]
    threshold: float

    def intentions(self, act: PredicateForm, heard: Confidence = CERTAIN) -> list[Intention]:
        """Return what an act `heard` as (lower, upper) in [0, 1] may intend, the surest first."""
        found: dict[PredicateForm, list[Confidence]] = {}
        for rule in self.rules:
            variables = match(rule.act, act) if rule.act.name == act.name else None
            if variables is not None:
                concluded = modus_ponens(heard, rule.interval)
                found.setdefault(fill(rule.intention, variables), []).append(concluded)
        fused = {form: fuse_yager(intervals) for form, intervals in found.items()}
        intentions = [Intention(form, each, _certainty(each)) for form, each in fused.items()]
        return sorted(intentions, key=lambda each: -each.certainty)

    def meant(self, act: PredicateForm, heard: Confidence = CERTAIN) -> list[Intention]:
        """Return the intentions that are sure enough; unless it is one, Hilt must ask."""
        return [each for each in self.intentions(act, heard) if self.is_enough(each.interval)]

    def is_enough(self, interval: Confidence) -> bool:
        """Whether an intention is sure enough to go by."""
        return _certainty(interval) > self.threshold


@dataclass(frozen=True)
class Intention:
    """What a speaker may want, as a form like `want(sam,pass(self,knife))`.

    Attributes:
        interval: how sure it is, (lower, upper) in [0, 1].
        certainty: the same in one number, in [0, 1]; 0 when it rather is not meant.
    """

    form: PredicateForm
    interval: Confidence
    certainty: float


def load_pragmatics(path: Path = PRAGMATICS_FILE) -> Pragmatics:
    """Read the pragmatic rules; `DataError` says where the file is not as expected."""
    entries = read_yaml(path).entries(required=("rules", "threshold"), optional=())
    rules = tuple(_rule(field) for field in entries["rules"].items())
    return Pragmatics(rules, entries["threshold"].number(low=0, high=1))


def _rule(field: YamlNode) -> PragmaticRule:
    parts = field.entries(required=("rule", "interval"), optional=())
    left, right = read_rule(parts["rule"])
    try:
        act, intention = form_of(evaluate(left)), form_of(evaluate(right))
    except ValueError as error:
        raise parts["rule"].fail("expected predicate forms without functions.") from error
    unbound = {part.name for part in intention if part.is_variable}
    unbound -= {part.name for part in act if part.is_variable}
    if unbound:
        raise parts["rule"].fail(f"{', '.join(sorted(unbound))} stands only on the right.")
    return PragmaticRule(act, intention, read_interval(parts["interval"]))


def _certainty(interval: Confidence) -> float:
    return certainty(interval) if relative_plausibility(interval) > 0.5 else 0.0
