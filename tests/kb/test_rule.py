"""Claims about rules and their atoms."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.kb.interval import Interval
from hilt.kb.rule import Atom, Rule, functional, grasping, norm
from hilt.ontology.errors import ValidationError

HIGH = Interval(0.95, 1)


@pytest.mark.parametrize("text", ["object:knife", "object:wine glass", "action:pickUp"])
def test_atom_reads_back_what_it_prints(text: str):
    """`parse` is the inverse of `str`."""
    assert str(Atom.parse(text)) == text


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("object", ""),
        ("object", "wine  glass"),
        ("object", "wine_glass"),
        ("object", "Knife"),
        ("object", "knife> <urn:x"),
        ("object", "a\nb"),
        ("object", "x" * 101),
        ("colour", "red"),
    ],
)
def test_malformed_atom_is_refused(kind: str, name: str):
    """A name that could not be told apart in the graph never becomes an atom."""
    with pytest.raises(ValidationError, match="expected"):
        Atom(kind, name)


def test_grasping_rule_is_that_of_the_paper():
    """r3: knife and the context pass imply graspObject of the blade."""
    rule = grasping("knife", "blade", "pass", interval=HIGH)

    assert (rule.kind, rule.object, rule.context, rule.part) == ("action", "knife", "pass", "blade")
    assert rule.affordance is None
    assert rule.node == "pass.graspObject"


def test_functional_rule_hangs_on_finding():
    """r1: a knife is used for cutting, which matters when something for cutting is to be found."""
    rule = functional("knife", "cutting", interval=HIGH)

    assert (rule.kind, rule.object, rule.affordance) == ("functional", "knife", "cutting")
    assert (rule.context, rule.part) == (None, None)
    assert rule.node == "findObject.cutting"


def test_material_is_a_context_of_a_use():
    """A use on bread is another rule than the use on anything, found at the same node."""
    general, on_bread = (
        functional("knife", "cutting", interval=HIGH, material=material)
        for material in (None, "bread")
    )

    assert on_bread.contexts == {Atom("material", "bread")}
    assert (on_bread.node, on_bread.material) == (general.node, "bread")
    assert on_bread.id != general.id
    assert (on_bread.as_json()["material"], "material" in general.as_json()) == ("bread", False)


def test_rule_has_at_most_one_material():
    """Cutting bread and cutting wood are two rules."""
    contexts = frozenset({Atom("material", "bread"), Atom("material", "wood")})

    with pytest.raises(ValidationError, match="one material"):
        replace(functional("knife", "cutting", interval=HIGH), contexts=contexts)


def test_grasping_without_context_hangs_on_the_action_alone():
    """A way of grasping that holds in any context is found at every grasp."""
    assert grasping("mug", "handle", interval=HIGH).node == "graspObject"


def test_other_functor_makes_a_general_rule():
    """Any functor, several features and contexts, and no argument are allowed."""
    rule = Rule(
        frozenset([Atom("object", "mug"), Atom("property", "full")]),
        frozenset([Atom("action", "pass"), Atom("place", "kitchen")]),
        "moveSlowly",
        None,
        HIGH,
    )

    assert (rule.kind, rule.node) == ("general", "pass.moveSlowly")
    assert rule.as_json()["functor"] == "moveSlowly"
    assert rule.as_json()["contexts"] == ["place:kitchen"]


def test_norm_hangs_on_its_action():
    """What is forbidden is found at the action, whatever the object; JSON has who and where."""
    rule = norm("forbidden", "pass", interval=HIGH, contexts=[Atom("role", "child")])

    assert (rule.kind, rule.node, rule.context) == ("norm", "pass.forbidden", "pass")
    assert rule.as_json()["contexts"] == ["role:child"]
    assert rule.as_json()["functor"] == "forbidden"


@pytest.mark.parametrize(
    ("functor", "argument", "said"),
    [
        ("forbidden", Atom("action", "pass"), "forbidden takes a part, not action:pass"),
        ("obliged", None, "obliged takes a part or an action, not None"),
        ("permitted", Atom("object", "mug"), "permitted takes a part or an action, not object:mug"),
    ],
)
def test_norm_is_about_a_part_or_what_comes_first(functor: str, argument: Atom | None, said: str):
    """A norm that nothing could keep is refused."""
    with pytest.raises(ValidationError, match=said):
        norm(functor, "pass", "knife", argument, interval=HIGH)


def test_norm_needs_its_action():
    """Without an action nothing is forbidden."""
    with pytest.raises(ValidationError, match="forbidden needs the action"):
        Rule(frozenset([Atom("object", "mug")]), frozenset(), "forbidden", None, HIGH)


@pytest.mark.parametrize(
    ("functor", "argument", "said"),
    [
        ("usedFor", None, r"usedFor needs an affordance, .*; found none\."),
        ("usedFor", Atom("part", "blade"), r"an affordance, .*; found part:blade\."),
        (
            "graspObject",
            None,
            r"graspObject needs a part, as graspObject\(part:blade\); found none",
        ),
        ("graspObject", Atom("object", "knife"), r"a part, .*; found object:knife\."),
    ],
)
def test_known_functors_need_what_they_are_about(functor: str, argument: Atom | None, said: str):
    """They would never be found; functors of one's own take anything."""
    knife = frozenset([Atom("object", "knife")])

    with pytest.raises(ValidationError, match=said):
        Rule(knife, frozenset(), functor, argument, HIGH)
    assert Rule(knife, frozenset(), "holdStill", argument, HIGH).argument == argument


def test_same_content_is_the_same_rule_whenever_it_was_told():
    """The id knows speaker, atoms and interval, not the utterance."""
    rule = grasping("knife", "blade", "pass", interval=HIGH)

    again = replace(rule, utterance=17, status="retracted")

    assert again.id == rule.id
    assert len(rule.id) == len("rule/") + 16


@pytest.mark.parametrize(
    "other",
    [
        grasping("knife", "handle", "pass", interval=HIGH),
        grasping("knife", "blade", "pickUp", interval=HIGH),
        grasping("knife", "blade", interval=HIGH),
        grasping("spoon", "blade", "pass", interval=HIGH),
        grasping("knife", "blade", "pass", interval=Interval(0.95, 0.99)),
        grasping("knife", "blade", "pass", interval=HIGH, speaker="eve"),
        grasping("knife", "blade", "pass", interval=HIGH, properties=["red"]),
    ],
)
def test_other_content_is_another_rule(other: Rule):
    """Each of speaker, atoms and interval makes a rule another one."""
    assert other.id != grasping("knife", "blade", "pass", interval=HIGH).id


@given(st.floats(0, 1), st.floats(0, 1))
def test_rule_keeps_six_digits(one: float, two: float):
    """A rule holds the interval that the store gives back."""
    rule = functional("knife", "cutting", interval=Interval(min(one, two), max(one, two)))

    assert rule.interval == rule.interval.rounded()


def test_json_is_the_contract():
    """The keys of `hilt tell --json`, and no others for the two common kinds."""
    told = grasping("knife", "blade", "pass", interval=HIGH).as_json()

    assert told.pop("id") == grasping("knife", "blade", "pass", interval=HIGH).id
    assert told == {
        "kind": "action",
        "object": "knife",
        "affordance": None,
        "context": "pass",
        "part": "blade",
        "lower": 0.95,
        "upper": 1.0,
        "speaker": "sam",
    }


def test_any_object_is_a_star():
    """A rule about properties alone names no object."""
    rule = grasping("*", "handle", "pass", interval=HIGH, properties=["sharp"])

    assert rule.object is None
    assert rule.as_json()["object"] == "*"
    assert rule.as_json()["props"] == ["sharp"]


def test_rule_about_nothing_is_refused():
    """Neither feature nor context is no rule."""
    with pytest.raises(ValidationError, match="at least one feature or context"):
        functional("*", "cutting", interval=HIGH)


@pytest.mark.parametrize("speaker", ["", " sam", "sam\n", "a/b", "<x>", "s" * 101])
def test_malformed_speaker_is_refused(speaker: str):
    """A speaker has a name that prints."""
    with pytest.raises(ValidationError, match="no speaker's name"):
        functional("knife", "cutting", interval=HIGH, speaker=speaker)


def test_rule_speaks_for_or_against():
    """Above one half in sum it asserts; "never" and "as likely as not" do not."""
    assert functional("knife", "cutting", interval=Interval(0.25, 1)).asserts
    assert not functional("shoe", "cutting", interval=Interval(0, 0.05)).asserts
    assert not functional("shoe", "cutting", interval=Interval(0.5, 0.5)).asserts


def test_trust_discounts_the_support_but_not_the_rule():
    """What was told stays; what it weighs depends on who said it."""
    rule = replace(functional("knife", "cutting", interval=HIGH), trust=0.5)

    assert rule.interval == HIGH
    assert rule.support == Interval(0.475, 1)
    assert rule.id == functional("knife", "cutting", interval=HIGH).id
