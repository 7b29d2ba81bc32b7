# SPDX-License-Identifier: Apache-2.0
"""What a speaker wants by saying something: pragmatic rules over speech acts.

`STATEMENT(A,B,X) => wantBelieve(A,B,X)`: when a person tells an agent something, it wants the agent
to believe it. The rules are data (`pragmatics.yaml`), each with an interval of confidence, as in
Scheutz et al. (2013) and Williams et al. (2015). Paper, section 3.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..ontology.source import Field, read_yaml
from .meaning import Confidence
from .notation import read_rule
from .predicates import Form, fill, match

PRAGMATICS_FILE = Path(__file__).parents[1] / "ontology" / "pragmatics.yaml"


@dataclass(frozen=True)
class PragmaticRule:
    """One rule from a speech act to an intention.

    Attributes:
        act: the pattern of the speech act.
        intention: what the speaker wants, with the same variables.
        interval: how sure the rule is, (lower, upper) in [0, 1].
    """

    act: Form
    intention: Form
    interval: Confidence

    @property
    def detail(self) -> int:
        """How much the pattern says: the number of its forms that are no variables."""
        return sum(not part.is_variable for part in self.act)

    def __str__(self) -> str:
        return f"{self.act} => {self.intention}"


@dataclass(frozen=True)
class Intention:
    """What a speaker wants, by one rule.

    Attributes:
        form: the intention, as `want(sam,pass(self,knife))`.
        rule: the rule that says so.
    """

    form: Form
    rule: PragmaticRule


def intentions(act: Form, rules: Sequence[PragmaticRule]) -> list[Intention]:
    """All that a speech act may be meant to bring about, the likeliest first.

    A rule that says more about the act goes before one that says less, and of two that say as
    much the surer one.
    """
    found = [
        Intention(fill(rule.intention, variables), rule)
        for rule in rules
        if (variables := match(rule.act, act)) is not None
    ]
    return sorted(found, key=lambda each: (-each.rule.detail, -each.rule.interval[0]))


def load_pragmatics(path: Path = PRAGMATICS_FILE) -> tuple[PragmaticRule, ...]:
    """Read the pragmatic rules.

    Raises:
        DataError: the file is not as expected; says where.
    """
    entries = read_yaml(path).entries(required=("rules",), optional=())
    return tuple(_rule(field) for field in entries["rules"].items())


def _rule(field: Field) -> PragmaticRule:
    parts = field.entries(required=("rule", "interval"), optional=())
    act, intention = read_rule(parts["rule"])
    lower, upper = parts["interval"].numbers(count=2, low=0, high=1)
    if lower > upper:
        raise parts["interval"].fail(f"expected lower <= upper, found [{lower:g}, {upper:g}].")
    unbound = {part.name for part in intention if part.is_variable}
    unbound -= {part.name for part in act if part.is_variable}
    if unbound:
        raise parts["rule"].fail(f"{', '.join(sorted(unbound))} stands only on the right.")
    return PragmaticRule(act, intention, (lower, upper))
