"""Conflicts, abduction, and induction by similarity."""

import pytest

from hilt.inference.induction import CAUTION, InducedRule, induce, needed_features
from hilt.inference.rule_analysis import find_conflicts, find_hypotheses, parse_conclusion
from hilt.inference.types import Conclusion
from hilt.kb.interval import Interval
from hilt.kb.rule import Atom, Rule, functional, grasping, kind_rule, norm
from hilt.ontology.objects import load_household

CUTTING = Conclusion("usedFor", Atom("affordance", "cutting"))
G, S, NEVER = Interval(0.95, 1.0), Interval(0.5, 1.0), Interval(0.0, 0.05)
CUTS = functional("knife", "cutting", interval=G)
BLADE = grasping("knife", "blade", "pass", interval=G)
HANDLE = grasping("knife", "handle", "pickUp", interval=G)


# --- Conflicts -----------------------------------------------------------------------------


def test_conflict_of_assertion_and_denial_is_the_mass_of_the_empty_set():
    """The degree of conflict K is the mass that Dempster's rule gives to the empty set."""
    denial = functional("knife", "cutting", interval=NEVER, speaker="kim")

    (found,) = find_conflicts([CUTS, denial, HANDLE])

    assert {found.first, found.second} == {CUTS, denial}
    assert found.weight == pytest.approx(0.95 * 0.95)


def test_rules_that_agree_do_not_conflict():
    """Rules with "often" and "generally" agree, and different contexts are independent."""
    assert find_conflicts([CUTS, functional("knife", "cutting", interval=S), BLADE, HANDLE]) == []


# --- Abduction -----------------------------------------------------------------------------


def test_abduction_lists_the_antecedents_of_a_conclusion():
    """Each sufficient antecedent is listed, the most plausible first."""
    sharp = Rule(
        frozenset({Atom("property", "sharp")}), frozenset(), "usedFor",
        Atom("affordance", "cutting"), S,
    )  # fmt: skip

    found = find_hypotheses([sharp, CUTS, BLADE], CUTTING)

    assert [each.features for each in found] == [
        frozenset({Atom("object", "knife")}),
        frozenset({Atom("property", "sharp")}),
    ]


def test_context_explains_a_grasp():
    """Passing explains that the knife was grasped by the blade."""
    given = frozenset({Atom("object", "knife")})

    (found,) = find_hypotheses(
        [BLADE, HANDLE], Conclusion("graspObject", Atom("part", "blade")), given=given
    )

    assert (found.features, found.contexts) == (frozenset(), {Atom("action", "pass")})


def test_denied_conclusion_explains_nothing():
    """A rule that denies the conclusion does not explain it."""
    denial = functional("spoon", "cutting", interval=NEVER)

    assert find_hypotheses([denial], CUTTING) == []


def test_what_is_as_plausible_as_its_negation_explains_nothing():
    """A rule that says nothing is no hypothesis."""
    assert find_hypotheses([functional("spoon", "cutting", interval=Interval(0, 1))], CUTTING) == []


def test_rules_about_other_objects_than_the_given_one_are_ignored():
    """Other features of the rules stay hypotheses; a place is no object."""
    knife, kitchen = Atom("object", "knife"), Atom("place", "kitchen")
    sharp = functional("knife", "cutting", interval=S, properties=["sharp"])
    spoon = functional("spoon", "cutting", interval=G)

    [found] = find_hypotheses([sharp, spoon], CUTTING, given=frozenset({knife}))
    anywhere = find_hypotheses([sharp, spoon], CUTTING, given=frozenset({kitchen}))

    assert found.features == {Atom("property", "sharp")}
    assert [each.rules for each in anywhere] == [(spoon,), (sharp,)]


@pytest.mark.parametrize(
    ("text", "conclusion"),
    [
        ("part:blade", Conclusion("graspObject", Atom("part", "blade"))),
        ("affordance:cutting", Conclusion("usedFor", Atom("affordance", "cutting"))),
        ("cutWith", Conclusion("cutWith")),
        ("cutWith()", Conclusion("cutWith")),
        ("cutWith(bread)", Conclusion("cutWith", Atom("object", "bread"))),
        ("cutWith ( object:bread ) ", Conclusion("cutWith", Atom("object", "bread"))),
        ("usedFor(cutting)", CUTTING),
    ],
)
def test_conclusion_is_read_in_each_notation(text: str, conclusion: Conclusion):
    """An atom, a functor, or a functor with an argument, whose kind may be left out."""
    assert parse_conclusion(text) == conclusion


# --- Induction -----------------------------------------------------------------------------


def induced(*rules: Rule) -> dict[tuple[str | None, str | None], InducedRule]:
    """Return the rules that are induced for the household, by object and context."""
    household = load_household()
    found = induce(rules, household.objects, classes=household.classes)
    return {(each.rule.object, each.rule.context): each for each in found}


def test_screwdriver_is_passed_as_the_knife_is():
    """The paper's example: a screwdriver is passed by the part that is similar to the blade."""
    found = induced(BLADE)["screwdriver", "pass"]

    assert found.rule.part == "shaft"
    assert {"property:pointed", "tool"} <= set(found.shared)
    assert (found.rule.status, found.source) == ("induced", BLADE)


def test_handles_correspond_to_handles():
    """Parts are matched one to one, so a handle never corresponds to a blade."""
    found = induced(BLADE)

    assert {each.rule.part for each in found.values()} & {"handle"} == set()
    assert found["spoon", "pass"].rule.part == "bowl"


def test_induced_rule_has_less_belief_than_the_taught_one():
    """The induced rule is discounted by the similarity and by the caution."""
    for each in induced(BLADE, HANDLE, CUTS).values():
        bound = each.source.interval.lower * CAUTION * each.similarity
        assert each.rule.interval.lower == pytest.approx(bound, abs=1e-6)
        assert each.rule.interval.lower < each.source.interval.lower


def test_nothing_is_induced_where_something_was_taught():
    """No rule is induced for an object that has a taught rule."""
    taught = grasping("screwdriver", "handle", "pass", interval=S)

    assert ("screwdriver", "pass") not in induced(BLADE, taught)


def test_taught_denial_prevents_an_induced_rule():
    """A taught rule with "never" also prevents an induced rule."""
    taught = grasping("screwdriver", "shaft", "pass", interval=NEVER)

    assert ("screwdriver", "pass") not in induced(BLADE, taught)


def test_kinds_and_norms_are_not_transferred_to_similar_objects():
    """That a knife is a weapon, or must not be picked up, says nothing about a screwdriver."""
    kind = kind_rule("knife", "weapon", interval=G)
    ban = norm("forbidden", "pickUp", "knife", interval=G)

    assert induced(kind, ban) == {}


def test_nothing_is_induced_for_dissimilar_objects():
    """A shoe is not similar to a knife."""
    assert ("shoe", "pass") not in induced(BLADE)


def test_use_is_transferred_by_the_working_part_alone():
    """A spoon is like a knife, and a screwdriver like a hammer, but for the edge and striker."""
    assert induced(CUTS, functional("hammer", "pounding", interval=G)) == {}


def test_use_that_rests_on_a_container_is_transferred_to_containers():
    """A glass and the bowl of a spoon hold things as the barrel of a mug does; a shoe is none."""
    found = induced(functional("mug", "containing", interval=G))

    assert {name for name, _ in found} == {"glass", "spoon"}
    assert {each.needed for each in found.values()} == {("role:container",)}


def test_what_a_denied_object_has_too_is_not_what_a_use_rests_on():
    """Neither can the container be it, if a spoon does not do."""
    denied = functional("spoon", "containing", interval=NEVER)

    found = induced(functional("mug", "containing", interval=G), denied)

    assert not any("role:container" in each.needed for each in found.values())
    assert ("glass", None) not in found


def test_use_rests_on_what_two_users_have_in_common():
    """A knife and a screwdriver that are used for poking are both pointed."""
    users = [functional(name, "poking", interval=G) for name in ("knife", "screwdriver")]

    needed = needed_features(users[0], users, load_household().objects)

    assert "property:pointed" in needed
    assert not any(feature.startswith("role:") for feature in needed)


@pytest.mark.parametrize(("object_name", "about_any"), [("screwdriver", False), ("*", True)])
def test_property_that_was_taught_is_what_the_use_rests_on(object_name: str, about_any: bool):
    """Told that a pointed one is used, the robot offers what is pointed and nothing else."""
    told = functional(object_name, "poking", interval=G, properties=["pointed"])
    user = functional("screwdriver", "poking", interval=G)

    needed = needed_features(user if about_any else told, [told, user], load_household().objects)

    assert needed == {"property:pointed"}
    assert about_any or {name for name, _ in induced(told)} == {"knife"}


def test_nothing_is_guessed_where_a_rule_about_anything_was_taught():
    """A screwdriver has a handle, by which anything is passed; so the knife is no example."""
    assert ("screwdriver", "pass") not in induced(
        BLADE, grasping("*", "handle", "pass", interval=S)
    )
    assert ("screwdriver", "pass") in induced(BLADE, grasping("*", "sole", "pass", interval=S))
    assert ("screwdriver", "pass") in induced(BLADE, grasping("*", "handle", "pickUp", interval=S))


def test_use_rests_on_the_reason_that_was_given():
    """Of what has it, a guess is made; a rule that asserts nothing prevents none."""
    told = functional("knife", "opening", interval=G)
    reason = functional("*", "opening", interval=Interval(0, 1), properties=["pointed"])
    objects = load_household().objects

    found = induce([told, reason], objects)

    assert needed_features(told, [told, reason], objects) == {"property:pointed"}
    assert found
    assert all("pointed" in objects[each.rule.object or ""].properties for each in found)
