"""Which of two norms in conflict prevails, and when a norm applies at all."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hilt.inference.affordance import Affordances
from hilt.inference.norms import ALLOWED, Act, NormChecker, NormVerdict
from hilt.inference.taxonomy import Taxonomy
from hilt.kb.interval import CERTAIN, EPSILON, Interval
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


# --- Parts -----------------------------------------------------------------------------------

BLADE, HANDLE = Atom("part", "blade"), Atom("part", "handle")


@pytest.mark.parametrize(
    ("functor", "against"), [("forbidden", {"blade", "edge"}), ("obliged", {"handle", "rim"})]
)
def test_norm_on_a_part_is_about_that_part_and_its_kinds(functor: str, against: set[str]):
    """What is not known to be held by a part is held against no norm on parts."""
    rule = norm(functor, "pass", "knife", BLADE, interval=SURE)
    kinds = Taxonomy([(Atom("part", "edge"), BLADE)])
    checker = NormChecker(Affordances(Told(rule), taxonomy=kinds))

    for part in ("blade", "edge", "handle", "rim", None):
        found = checker.judge(Act(["pass"], "knife", part=part))
        assert (found.forbidding == rule) is (part in against)
        assert found.first is None


def test_parts_that_are_obliged_are_in_the_order_of_trust():
    """The part of whom is trusted more comes first, and of one speaker the later one."""
    first = replace(norm("obliged", "pass", "knife", BLADE, interval=SURE), utterance=1)
    later = replace(norm("obliged", "pass", "knife", HANDLE, interval=SURE), utterance=2)
    doubted = replace(
        norm("obliged", "pass", "knife", Atom("part", "tip"), interval=SURE), utterance=3, trust=0.9
    )
    checker = NormChecker(Affordances(Told(doubted, first, later)))

    assert checker.obliged_parts(Act(["pass"], "knife")) == ["handle", "blade", "tip"]


# --- Which permission lifts what ---------------------------------------------------------------

POINT = replace(
    norm("obliged", "pickUp", "mug", Atom("action", "pointTo"), interval=SURE), utterance=1
)


@pytest.mark.parametrize(
    ("argument", "conflicts", "is_lifted"),
    [
        (None, 1, False),  # the obligation is more specific
        (Atom("action", "pointTo"), 1, True),
        (Atom("action", "putDown"), 0, False),
        (HANDLE, 1, True),
    ],
)
def test_what_need_not_come_first_lifts_only_that_obligation(
    argument: Atom | None, conflicts: int, is_lifted: bool
):
    """A permission of the act itself is in conflict with any norm against it."""
    may = replace(MAY, argument=argument)

    found = verdict(Act(["pickUp"], "mug", part="handle"), POINT, may)

    assert (len(found.conflicts), found.forbidding is None) == (conflicts, is_lifted)


def test_norm_for_now_is_later_than_all_that_are_stored():
    """What is said with a command counts after what was said before."""
    now = replace(MAY, utterance=None)
    stored = Affordances(Told(NEVER))

    assert NormChecker(stored, momentary=[now]).judge(Act(["pickUp"], "mug")).forbidding is None


def test_permission_for_a_material_is_more_specific():
    """To cut bread is more special than to cut."""
    never = replace(norm("forbidden", "cut", "knife", interval=SURE), utterance=2)
    bread = Atom("material", "bread")
    may = replace(norm("permitted", "cut", "knife", interval=SURE, contexts=[bread]), utterance=1)

    found = verdict(Act(["cut"], "knife", contexts={bread: CERTAIN}), never, may)

    assert [each.reason for each in found.conflicts] == ["more specific"]


# --- What is not known -------------------------------------------------------------------------

HOT = norm("forbidden", "pickUp", "mug", interval=SURE, properties=["hot"])


def test_norm_on_what_nobody_sees_holds_and_says_so():
    """Not what is seen or known, and not what could be seen and is not."""
    blind = NormChecker(Affordances(Told(HOT)))
    seeing = NormChecker(Affordances(Told(HOT)), visible=frozenset({"hot"}))
    cold, hot = Act(["pickUp"], "mug"), Act(["pickUp"], "mug", frozenset({"hot"}))

    assert (blind.judge(cold).forbidding, blind.judge(cold).unseen) == (HOT, ("hot",))
    assert seeing.judge(cold).forbidding is None
    for checker in (blind, seeing):
        assert (checker.judge(hot).forbidding, checker.judge(hot).unseen) == (HOT, ())


def test_norm_that_needs_nothing_unseen_is_named_first():
    """Even where the other one was told by somebody who is trusted more."""
    certain = replace(NEVER, trust=0.9)

    assert verdict(Act(["pickUp"], "mug"), HOT, certain).forbidding == certain


@pytest.mark.parametrize(("name", "is_forbidden"), [("mug", False), ("*", True)])
def test_norm_on_an_object_waits_until_it_is_chosen(name: str, is_forbidden: bool):
    """Before, only those on anything apply."""
    rule = norm("forbidden", "pickUp", name, interval=SURE)

    assert (verdict(Act(["pickUp"]), rule).forbidding is not None) is is_forbidden


def test_norm_does_not_hold_where_its_place_is_in_doubt():
    """It must be more likely than not, by more than a rounding error."""
    kitchen = Atom("place", "kitchen")
    rule = norm("forbidden", "pass", "knife", interval=SURE, contexts=[kitchen])

    for lower, is_forbidden in ((EPSILON, False), (0.1, True)):
        act = Act(["pass"], "knife", contexts={kitchen: Interval(lower, 1.0)})
        assert (verdict(act, rule).forbidding is not None) is is_forbidden


def test_what_came_first_counts_until_the_act_is_done_with_the_same_thing():
    """Passing a mug, or lifting the knife, is not passing the knife."""
    rule = norm("obliged", "pass", "knife", Atom("action", "pointTo"), interval=SURE)

    for between in (("pass", "mug"), ("pickUp", "knife")):
        act = Act(["pass"], "knife", done=[("pointTo", "knife"), between])
        assert verdict(act, rule).forbidding is None


def test_json_names_the_norm_and_the_conflicts():
    """Each by the ids of its rules."""
    act = Act(["pickUp"], "mug")

    assert ALLOWED.first is None
    assert verdict(act).as_json() == {"rule": None, "conflicts": []}
    assert verdict(act, NEVER).as_json() == {"rule": NEVER.id, "conflicts": []}
    assert verdict(act, NEVER, MAY).as_json() == {
        "rule": None,
        "conflicts": [{"prevails": MAY.id, "over": NEVER.id, "because": "later"}],
    }
