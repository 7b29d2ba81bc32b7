"""Which rules are induced, in a household that is made for each question."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest

from hilt.inference.induction import InducedRuleSource, induce, needed_features, similarity
from hilt.kb.interval import Interval
from hilt.kb.rule import Atom, Rule, functional, grasping
from hilt.ontology.objects import ObjectType, PartType, load_household

G, S = Interval(0.95, 1.0), Interval(0.5, 1.0)
NEVER = Interval(0.0, 0.05)
MODEL = load_household().objects["knife"]


def thing(name: str, *properties: str, is_a: str | None = None, **roles: str) -> ObjectType:
    """An object with these properties and parts by role."""
    parts = {each: part(each, role) for each, role in roles.items()}
    return replace(MODEL, name=name, is_a=is_a, properties=frozenset(properties), parts=parts)


def part(name: str, role: str, *properties: str) -> PartType:
    """A part of this role."""
    return replace(MODEL.part("handle"), name=name, role=role, properties=frozenset(properties))


def names(rules: Sequence[Rule], *objects: ObjectType) -> list[str | None]:
    """The objects about which something is induced."""
    return [each.rule.object for each in induce(rules, {each.name: each for each in objects})]


PICK, NEEDLE = thing("pick", "pointed"), thing("needle", "pointed")
POKING = functional("pick", "poking", interval=G, properties=["pointed"])


def test_use_is_transferred_to_what_has_no_more_than_it_rests_on():
    """A needle that is pointed and nothing else pokes as a pointed pick does."""
    assert names([POKING], PICK, NEEDLE) == ["needle"]


def test_rule_about_anything_with_the_feature_leaves_nothing_to_guess():
    """Only if it is about the same use."""
    general = functional("*", "poking", interval=S, properties=["pointed"])

    assert names([POKING, general], PICK, NEEDLE) == []
    assert names(
        [POKING, replace(general, argument=Atom("affordance", "sewing"))], PICK, NEEDLE
    ) == ["needle"]


def test_another_use_that_was_taught_prevents_no_guess():
    """What a needle is used for besides does not matter; that it is not used for this does."""
    sewing = functional("needle", "sewing", interval=G)
    denied = functional("needle", "poking", interval=NEVER)

    assert names([POKING, sewing], PICK, NEEDLE) == ["needle"]
    assert names([POKING, denied], PICK, NEEDLE) == []


def test_use_on_a_material_is_not_guessed_where_the_use_was_taught():
    """What was told of the use on anything is about this material, too."""
    on_wood = functional("pick", "poking", interval=G, properties=["pointed"], material="wood")

    assert names([on_wood], PICK, NEEDLE) == ["needle"]
    assert names([on_wood, functional("needle", "poking", interval=S)], PICK, NEEDLE) == []


def test_of_two_examples_the_surer_one_is_followed():
    """Of equally sure ones the first."""
    awl = thing("awl", "pointed")
    other = functional("awl", "poking", interval=S, properties=["pointed"])
    objects = {each.name: each for each in (PICK, NEEDLE, awl)}

    for rules in ([POKING, other], [other, POKING]):
        [found] = [each for each in induce(rules, objects) if each.rule.object == "needle"]
        assert found.source == POKING
    equal = replace(other, interval=G)
    for rules in ([POKING, equal], [equal, POKING]):
        [found] = [each for each in induce(rules, objects) if each.rule.object == "needle"]
        assert found.source == rules[0]


def test_nothing_is_known_of_what_a_single_plain_object_needs():
    """What it has may have nothing to do with its use; what a denied object lacks has."""
    using = functional("pick", "poking", interval=G)
    denied = functional("spoon", "poking", interval=NEVER)
    objects = {"pick": PICK, "spoon": thing("spoon", "round")}

    assert needed_features(using, [using], objects) == frozenset()
    assert needed_features(using, [using, denied], objects) == {"property:pointed"}


def test_objects_that_are_not_in_the_household_say_nothing():
    """Neither does a property that was told of another object."""
    unknown = functional("unicorn", "poking", interval=G)
    using = functional("pick", "poking", interval=G)
    told = functional("needle", "poking", interval=G, properties=["thin"])
    objects = {"pick": PICK, "needle": NEEDLE}

    assert needed_features(unknown, [unknown], objects) == frozenset()
    assert needed_features(using, [using, told, unknown], objects) == {"property:pointed"}


def test_part_without_counterpart_is_not_guessed():
    """A part that the example has not, or an object without parts, gives no grasp."""
    tongs = thing("tongs", "long", grip="grip")
    by_grip = grasping("tongs", "grip", "pass", interval=G)
    by_lid = grasping("tongs", "lid", "pass", interval=G)

    assert names([by_grip], tongs, thing("pliers", "long", hold="grip")) == ["pliers"]
    assert names([by_lid], tongs, thing("pliers", "long", hold="grip")) == []
    assert names([by_grip], tongs, thing("stick", "long")) == []


def test_parts_that_have_nothing_in_common_correspond_for_want_of_others():
    """Where the other parts of two alike objects correspond, the last ones do."""
    tongs = thing("tongs", "long", handle="grip", jaw="jaw")
    pole = thing("pole", "long", hold="grip", end="tip")

    [found] = induce([grasping("tongs", "jaw", "pass", interval=G)], {"tongs": tongs, "pole": pole})

    assert (found.rule.part, found.similarity, found.needed) == ("end", 0.5, ())
    assert found.shared == ("property:long",)


def test_json_has_the_reasons_with_six_digits():
    """Similarity is rounded, and what is needed stands there for uses only."""
    long = thing("tongs", "long", "thin", "bent", grip="grip")
    other = thing("pliers", "long", grip="grip")

    [found] = induce(
        [grasping("tongs", "grip", "pass", interval=G)], {"tongs": long, "pliers": other}
    )
    [use] = induce([POKING], {"pick": PICK, "needle": NEEDLE})

    assert found.as_json()["similarity"] == 0.666667
    assert "needed" not in found.as_json()
    assert use.as_json()["needed"] == ["property:pointed"]


def test_things_of_which_nothing_is_known_are_not_alike():
    """There is no division by nothing."""
    assert similarity(frozenset(), frozenset()) == (0.0, ())


class Taught:
    """A source that counts how often its rules are read."""

    sequence = -2

    def __init__(self) -> None:
        self.read = 0

    def rules(self) -> list[Rule]:
        """Return the only rule."""
        self.read += 1
        return [POKING]

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """Return the only rule."""
        return [POKING] if POKING.node in nodes else []


@pytest.mark.parametrize("sequence", [-2, -1, 0])
def test_rules_are_induced_once_for_each_change(sequence: int):
    """Asking again takes nothing; a change is seen at once."""
    taught = Taught()
    taught.sequence = sequence
    source = InducedRuleSource(taught, {"pick": PICK, "needle": NEEDLE}, {})

    for _ in range(2):
        found = source.rules_at_nodes([POKING.node])
        assert [rule.object for rule in found] == ["pick", "needle"]
    assert taught.read == 1
    taught.sequence += 1
    source.rules_at_nodes([POKING.node])
    assert taught.read == 2


def test_grasp_rests_on_no_feature():
    """Even where it was taught for long things alone."""
    tongs, pliers = thing("tongs", "long", grip="grip"), thing("pliers", "long", hold="grip")
    taught = grasping("tongs", "grip", "pass", interval=G, properties=["long"])

    [found] = induce([taught], {"tongs": tongs, "pliers": pliers})

    assert found.needed == ()
