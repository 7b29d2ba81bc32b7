"""Which of two norms in conflict prevails, and when a norm applies at all."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hilt.inference.affordance import Affordances
from hilt.inference.norms import Act, NormChecker, NormVerdict
from hilt.inference.taxonomy import Taxonomy
from hilt.kb.interval import CERTAIN, Interval
from hilt.kb.rule import Atom, Rule, norm

from .rule_sources import Told

SURE = Interval(0.95, 1.0)
NEVER = replace(norm("forbidden", "pickUp", "mug", interval=SURE), utterance=1)
MAY = replace(norm("permitted", "pickUp", "mug", interval=SURE), utterance=2)
RED = replace(norm("permitted", "pickUp", "mug", interval=SURE, properties=["red"]), utterance=0)
BREAD_KNIFE = [(Atom("object", "bread knife"), Atom("object", "knife"))]


def verdict(act: Act, *rules: Rule) -> NormVerdict:
    """What some norms say of an act."""
    return NormChecker(Affordances(Told(*rules), taxonomy=Taxonomy(BREAD_KNIFE))).judge(act)


@pytest.mark.parametrize(
    ("rules", "is_forbidden", "reason"),
    [
        ((NEVER, MAY), False, "later"),
        ((NEVER, replace(MAY, utterance=0)), True, "later"),
        ((NEVER, replace(MAY, trust=0.5)), True, "told by somebody who is trusted more"),
        ((NEVER, RED), False, "more specific"),
    ],
)
def test_conflict_is_resolved_by_specificity_trust_and_time(
    rules: tuple[Rule, ...], is_forbidden: bool, reason: str
):
    """The more specific norm prevails, then the more trusted, then the later one."""
    found = verdict(Act(["pickUp"], "mug", frozenset({"red"})), *rules)

    assert (found.forbidding is not None) is is_forbidden
    assert [each.reason for each in found.conflicts] == [reason]


def test_norm_is_inherited_by_kinds():
    """A bread knife is a knife, and a prohibition of knives holds for it."""
    rule = norm("forbidden", "pass", "knife", interval=SURE)

    assert verdict(Act(["pass"], "bread knife"), rule).forbidding == rule
    assert verdict(Act(["pass"], "mug"), rule).forbidding is None


def test_norm_of_nobody_who_is_trusted_does_not_hold():
    """Trust discounts it to nothing."""
    assert verdict(Act(["pickUp"], "mug"), replace(NEVER, trust=0.0)).forbidding is None


def test_proof_has_the_place_and_its_interval():
    """An uncertain place makes the prohibition less sure, but it holds."""
    kitchen = Atom("place", "kitchen")
    rule = norm("forbidden", "pass", "knife", interval=CERTAIN, contexts=[kitchen])

    found = verdict(Act(["pass"], "knife", contexts={kitchen: Interval(0.9, 1.0)}), rule)

    assert found.proof is not None
    assert found.proof.interval == Interval(0.9, 1.0)


def test_obligation_is_met_once_for_each_act():
    """What must come first is done again before the next time."""
    rule = norm("obliged", "pass", "knife", Atom("action", "pointTo"), interval=SURE)
    pointed, passed = ("pointTo", "knife"), ("pass", "knife")

    def is_free(*done: tuple[str, str]) -> bool:
        return verdict(Act(["pass"], "knife", done=done), rule).forbidding is None

    assert is_free(pointed)
    assert not is_free()
    assert not is_free(pointed, passed)
    assert not is_free(("pointTo", "mug"))


def test_hand_must_be_emptied_of_what_is_named():
    """Only while it holds that."""
    first = Atom("action", "putDown")
    rule = norm("obliged", "pass", "*", first, interval=SURE, contexts=[Atom("object", "mug")])

    assert verdict(Act(["pass"], "knife", holding="mug"), rule).first == first
    assert verdict(Act(["pass"], "knife", holding="spoon"), rule).forbidding is None
