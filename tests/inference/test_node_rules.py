"""Rules about any object apply to those that have the part they name."""

import pytest

from hilt.inference.affordance import Affordances
from hilt.inference.taxonomy import Taxonomy
from hilt.inference.types import Goal, Observation, Target
from hilt.kb.interval import CERTAIN, Interval
from hilt.kb.rule import Atom, Rule, grasping

from .rule_sources import Told

G, NEVER = Interval(0.95, 1.0), Interval(0.0, 0.05)
HANDLE, HAFT, BLADE = (Atom("part", name) for name in ("handle", "haft", "blade"))
HAMMER = Goal("pass", Target(object="hammer"))
GRASP = "pass/graspObject"
BY_HANDLE = grasping("*", "handle", "pass", interval=G)


def test_part_of_a_rule_about_anything_is_looked_for():
    """Vision searches for handles, since a rule says to hold anything by its handle."""
    assert Affordances(Told(BY_HANDLE)).features(GRASP, HAMMER) == (HANDLE,)


@pytest.mark.parametrize(("part", "accepted"), [(HANDLE, True), (HAFT, True), (BLADE, False)])
def test_rule_about_anything_applies_to_what_has_the_part(part: Atom, accepted: bool):
    """It applies to a handle and to a haft, which is a kind of handle, but not without one."""
    seen = Observation("hammer", "hammer", {part: Interval(0.9, 1.0)})
    affordances = Affordances(Told(BY_HANDLE), taxonomy=Taxonomy([(HAFT, HANDLE)]))

    best = affordances.infer(GRASP, HAMMER, [seen]).best

    assert (best is not None) == accepted
    assert best is None or best.interval.lower == pytest.approx(0.9 * 0.95)


def test_part_that_nothing_may_be_held_by_is_denied():
    """A prohibition about anything denies the part of an object that has it."""
    never = grasping("*", "blade", "pass", interval=NEVER)
    seen = Observation("hammer", "hammer", {BLADE: CERTAIN})

    inference = Affordances(Told(never)).infer(GRASP, HAMMER, [seen])

    assert [each.argument for each in inference.denied] == [BLADE]


def test_rule_about_one_object_does_not_need_its_part_to_be_seen():
    """The part of a named object may be out of view."""
    rule = grasping("hammer", "handle", "pass", interval=G)
    seen = Observation("hammer", "hammer", {Atom("object", "hammer"): CERTAIN})

    assert Affordances(Told(rule)).infer(GRASP, HAMMER, [seen]).best is not None


def test_rule_without_any_feature_binds_the_action_on_the_found_object():
    """Where a rule says how anything is shaken, the object that was found is looked at."""
    gently = Rule(
        frozenset(), frozenset({Atom("action", "season")}), "shake", Atom("property", "gentle"), G
    )
    affordances = Affordances(Told(gently))
    goal, node = Goal("season", Target(object="hammer")), "season/shake"

    [feature] = affordances.features(node, goal)
    best = affordances.infer(node, goal, [Observation("hammer", "hammer", {feature: CERTAIN})]).best

    assert feature == Atom("object", "hammer")
    assert best is not None and best.argument == Atom("property", "gentle")


def test_rule_about_grasping_holds_whatever_an_object_is_grasped_for():
    """What is never grabbed by the blade is not passed by it, unless a rule on passing says so."""
    never = grasping("knife", "blade", "grasp", interval=NEVER)
    taught = grasping("knife", "blade", "pass", interval=G)
    goal = Goal("pass", Target(object="knife"))
    seen = Observation("knife", "knife", {Atom("object", "knife"): CERTAIN})

    alone, both = (
        Affordances(Told(*rules)).infer(GRASP, goal, [seen]) for rules in ([never], [never, taught])
    )

    assert [each.argument for each in alone.denied] == [BLADE]
    assert both.best is not None and both.best.overruled == (never,)
