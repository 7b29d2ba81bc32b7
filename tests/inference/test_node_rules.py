"""Rules about any object apply to those that have the part they name."""

from dataclasses import replace

import pytest

from hilt.inference.affordance import Affordances
from hilt.inference.taxonomy import Taxonomy
from hilt.inference.types import Conclusion, Goal, Observation, Target
from hilt.kb.interval import CERTAIN, Interval
from hilt.kb.rule import Atom, Rule, functional, grasping

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


KNIFE, SPOON = Atom("object", "knife"), Atom("object", "spoon")
BY_BLADE, BY_BOWL = (
    grasping(name, part, interval=G) for name, part in (("knife", "blade"), ("spoon", "bowl"))
)


def test_only_rules_about_a_named_object_are_of_interest_where_it_is_grasped():
    """Vision looks for the features of all rules where no object is named."""
    engine = Affordances(Told(BY_BLADE, BY_BOWL))

    assert engine.features(GRASP, Goal("pass", Target(object="knife"))) == (KNIFE,)
    assert engine.features(GRASP, Goal("pass", Target())) == (KNIFE, SPOON)


def test_rules_about_other_objects_are_of_interest_where_one_is_looked_for():
    """A thing that is named, and is to cut, is looked for among all that cuts."""
    told = [functional(name, "cutting", interval=G) for name in ("knife", "spoon")]
    goal = Goal("pass", Target(object="knife", used_for="cutting"))

    assert Affordances(Told(*told)).features("pass/findObject", goal) == (KNIFE, SPOON)


def test_only_a_grasp_is_done_in_the_context_of_grasping():
    """What holds for grasping says nothing of shaking."""
    hammer = Atom("object", "hammer")
    rules = [
        Rule(frozenset({hammer}), frozenset({Atom("action", name)}), "shake", HAFT, G)
        for name in ("grasp", "season")
    ]
    seen = Observation("hammer", "hammer", {hammer: CERTAIN})

    grasped, seasoned = (
        Affordances(Told(rule)).infer("season/shake", HAMMER, [seen]).candidates for rule in rules
    )

    assert grasped == ()
    assert [each.rules for each in seasoned] == [(rules[1],)]


@pytest.mark.parametrize("is_first", [True, False])
def test_rule_without_argument_competes_with_all(is_first: bool):
    """That a hammer is not to be shaken in the kitchen goes before how anything is shaken."""
    hammer, kitchen = Atom("object", "hammer"), Atom("place", "kitchen")
    whole = Rule(frozenset({hammer}), frozenset({kitchen}), "shake", None, NEVER)
    gently = Rule(frozenset({hammer}), frozenset(), "shake", Atom("property", "gentle"), G)
    if not is_first:
        whole, gently = replace(whole, argument=gently.argument), replace(gently, argument=None)
    goal = Goal("season", Target(object="hammer"), {kitchen: CERTAIN})
    seen = Observation("hammer", "hammer", {hammer: CERTAIN})

    [only] = Affordances(Told(gently, whole)).infer("season/shake", goal, [seen]).candidates

    assert (only.rules, only.overruled) == ((whole,), (gently,))


def test_rule_about_anything_is_not_inherited():
    """Where a rule names no feature, there is no distance to it."""
    seen = Observation("hammer", "hammer", {HANDLE: CERTAIN})

    [handle] = Affordances(Told(BY_HANDLE)).infer(GRASP, HAMMER, [seen]).candidates

    assert (handle.accepted, handle.inherited) == (True, 0)


def test_any_argument_will_do_where_none_is_asked_for():
    """Something to cut with is what cuts bread, too."""
    told = Rule(frozenset({KNIFE}), frozenset(), "cutWith", Atom("object", "bread"), G)
    goal = Goal("pass", Target(affords=Conclusion("cutWith")))
    seen = Observation("knife", "knife", {KNIFE: CERTAIN})

    assert Affordances(Told(told)).infer("pass/findObject", goal, [seen]).best is not None


def test_implied_atom_follows_from_the_nearest_one():
    """Of equally near ones from the first."""
    fork, cutlery, tool = (Atom("object", name) for name in ("fork", "cutlery", "tool"))
    kinds = Taxonomy([(KNIFE, cutlery), (fork, cutlery), (cutlery, tool)])

    assert kinds.implied([KNIFE, fork])[cutlery] == (1, KNIFE)
    for atoms in ([KNIFE, cutlery], [cutlery, KNIFE]):
        assert kinds.implied(atoms)[tool] == (1, cutlery)
