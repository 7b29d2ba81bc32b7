"""A more specific rule overrides a general one; equal and incomparable ones are fused."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.inference.affordance import Affordances
from hilt.inference.settings import Settings
from hilt.inference.taxonomy import Taxonomy
from hilt.inference.types import Candidate, Conclusion, Goal, Observation, Target
from hilt.kb.interval import CERTAIN, EPSILON, Interval
from hilt.kb.rule import Atom, Rule, functional, grasping

from .rule_sources import Told

G, S, NEVER = Interval(0.95, 1.0), Interval(0.5, 1.0), Interval(0.0, 0.05)
CUTTING = Goal("pass", Target(used_for="cutting"))
KNIFE = Goal("pass", Target(object="knife"))
FIND, GRASP = "pass/findObject", "pass/graspObject"
PARTS = (Atom("part", "handle"), Atom("part", "blade"))
BLUNT, RED = Atom("property", "blunt"), Atom("property", "red")
KITCHEN = Atom("place", "kitchen")
KINDS = Taxonomy([(Atom("object", "bread knife"), Atom("object", "knife"))])


def knife(*shown: Atom, name: str = "knife", without: Atom | None = None) -> Observation:
    """Return an observation of a knife with further features, and one that it does not show."""
    atoms = dict.fromkeys((Atom("object", name), *shown), CERTAIN)
    return Observation(name, name, atoms | ({without: Interval(0.0, 0.0)} if without else {}))


def used(rules: Sequence[Rule], seen: Observation, goal: Goal = CUTTING) -> Candidate:
    """Return what is inferred of one object at the find node."""
    [candidate] = Affordances(Told(*rules), taxonomy=KINDS).infer(FIND, goal, [seen]).candidates
    return candidate


def grip(rules: Sequence[Rule], *shown: Atom, name: str = "knife") -> str | None:
    """Return the part by which an object is passed; None if none is accepted."""
    seen = knife(*PARTS, *shown, name=name)
    goal = Goal("pass", Target(object=name))
    best = Affordances(Told(*rules), taxonomy=KINDS).infer(GRASP, goal, [seen]).best
    return best.argument.name if best and best.argument else None


CUTS = functional("knife", "cutting", interval=G)
BLUNT_DOES_NOT = functional("knife", "cutting", interval=NEVER, properties=["blunt"])


@pytest.mark.parametrize(
    ("seen", "verdict"),
    [
        (knife(BLUNT), "denied"),
        (knife(without=BLUNT), "accepted"),
        (knife(BLUNT, RED), "denied"),
        (knife(BLUNT, name="bread knife"), "denied"),
        (knife(without=BLUNT, name="bread knife"), "accepted"),
    ],
)
def test_blunt_knife_is_denied_and_others_are_not(seen: Observation, verdict: str):
    """A rule about blunt knives overrides that about knives where the knife looks blunt."""
    assert used([CUTS, BLUNT_DOES_NOT], seen).verdict == verdict


def test_proof_shows_the_overruled_rule_and_why():
    """The proof, its JSON and the reason name the rule that a more specific one overrides."""
    candidate = used([CUTS, BLUNT_DOES_NOT], knife(BLUNT))

    assert candidate.overruled == (CUTS,)
    assert candidate.reason.endswith(f"more specific than {CUTS!r}")
    assert any(
        "overruled by a more specific rule" in line and repr(CUTS) in line
        for line in candidate.proof.lines()
    )
    assert candidate.proof.as_json()["overruled"] == [CUTS.id]


def test_incomparable_rules_are_fused():
    """Of a blunt knife and a red knife neither is more specific than the other."""
    red = functional("knife", "cutting", interval=G, properties=["red"])

    candidate = used([red, BLUNT_DOES_NOT], knife(BLUNT, RED))

    assert set(candidate.rules) == {red, BLUNT_DOES_NOT}
    assert candidate.interval.lower == pytest.approx(0.95 * 0.05)


def test_kind_and_property_together_are_compared_along_the_taxonomy():
    """A blunt bread knife is more specific than a blunt knife, and that than a knife."""
    sharp_enough = functional("bread knife", "cutting", interval=S, properties=["blunt"])

    candidate = used([CUTS, BLUNT_DOES_NOT, sharp_enough], knife(BLUNT, name="bread knife"))

    assert (candidate.rules, set(candidate.overruled)) == ((sharp_enough,), {CUTS, BLUNT_DOES_NOT})


@pytest.mark.parametrize(
    ("sure", "verdict"), [(1.0, "denied"), (0.6, "denied"), (0.0, "accepted"), (None, "accepted")]
)
def test_rule_for_a_place_overrides_where_the_place_holds(sure: float | None, verdict: str):
    """Not cutting in the kitchen goes before cutting anywhere, if it is likely the kitchen."""
    there = replace(BLUNT_DOES_NOT, features=CUTS.features, contexts=frozenset({KITCHEN}))
    contexts = {} if sure is None else {KITCHEN: Interval(sure, sure)}
    goal = replace(CUTTING, contexts=contexts)

    assert used([CUTS, there], knife(), goal).verdict == verdict


@pytest.mark.parametrize("sure", [Interval(0.0, 1.0), Interval(EPSILON, 1.0)])
def test_doubtful_property_overrides_nothing(sure: Interval):
    """Where it is as likely sharp as blunt, what is told of blunt ones goes before nothing."""
    seen = Observation("knife", "knife", {Atom("object", "knife"): CERTAIN, BLUNT: sure})

    assert used([CUTS, BLUNT_DOES_NOT], seen).overruled == ()


def test_rule_for_a_kind_of_place_overrides_one_for_the_place_above():
    """The kitchen is a room: what is told of it goes before what is told of rooms."""
    room = Atom("place", "room")
    in_room, in_kitchen = (
        replace(CUTS, contexts=frozenset({place}), interval=interval)
        for place, interval in ((room, G), (KITCHEN, NEVER))
    )
    goal = replace(CUTTING, contexts={KITCHEN: CERTAIN})
    engine = Affordances(Told(in_room, in_kitchen), taxonomy=Taxonomy([(KITCHEN, room)]))

    [candidate] = engine.infer(FIND, goal, [knife()]).candidates

    assert (candidate.rules, candidate.overruled) == ((in_kitchen,), (in_room,))


def test_material_is_no_premise_where_none_is_named():
    """What is told of cutting wood and of cutting is fused, and both count for cutting."""
    on_wood = functional("knife", "cutting", interval=S, material="wood")

    assert set(used([CUTS, on_wood], knife()).rules) == {CUTS, on_wood}


def test_taxonomy_decides_even_if_the_object_is_hardly_seen():
    """A rule about bread knives adds no premise to one about knives that could be doubted."""
    special = functional("bread knife", "cutting", interval=S)
    faint = Observation("it", "bread knife", {Atom("object", "bread knife"): Interval(0.3, 0.3)})
    affordances = Affordances(Told(CUTS, special), Settings(detection="point"), KINDS)

    [candidate] = affordances.infer(FIND, CUTTING, [faint]).candidates

    assert candidate.rules == (special,)


def test_rule_about_the_argument_that_is_asked_for_overrides_one_about_any():
    """What is told of cutting bread goes before what is told of cutting, of actions too."""
    for asked in (Atom("object", "bread"), Atom("action", "serve")):
        wanted = Conclusion("cutWith", asked)
        features = CUTS.features
        rules = [
            Rule(features, frozenset(), "cutWith", argument, interval)
            for argument, interval in ((None, G), (asked, NEVER))
        ]

        candidate = used(rules, knife(), Goal("pass", Target(affords=wanted)))

        assert (candidate.rules, candidate.overruled) == ((rules[1],), (rules[0],))


def test_rule_about_another_argument_than_the_one_asked_for_does_not_apply():
    """What is told of cutting a mug says nothing of cutting bread."""
    bread, mug = Atom("object", "bread"), Atom("object", "mug")
    rules = [
        Rule(CUTS.features, frozenset(), "cutWith", argument, interval)
        for argument, interval in ((bread, G), (mug, NEVER))
    ]

    candidate = used(rules, knife(), Goal("pass", Target(affords=Conclusion("cutWith", bread))))

    assert (candidate.rules, candidate.overruled) == ((rules[0],), ())


def test_object_that_is_asked_for_is_no_feature_of_the_one_that_is_seen():
    """That something sharp cuts a bread knife is not more specific than that a knife does."""
    asked, sharp = Atom("object", "bread knife"), Atom("property", "sharp")
    by_sharp = Rule(frozenset({sharp}), frozenset(), "cutWith", asked, NEVER)
    by_knife = Rule(CUTS.features, frozenset(), "cutWith", None, G)
    goal = Goal("pass", Target(affords=Conclusion("cutWith", asked)))

    candidate = used([by_sharp, by_knife], knife(sharp), goal)

    assert set(candidate.rules) == {by_sharp, by_knife}


BY_HANDLE = grasping("*", "handle", "pass", interval=G)
KNIFE_BY_BLADE = grasping("knife", "blade", "pass", interval=S)
BREAD_KNIFE_BY_BLADE = grasping("bread knife", "blade", "pass", interval=S)


@pytest.mark.parametrize(
    ("rules", "shown", "part"),
    [
        ([BY_HANDLE], (), "handle"),
        ([BY_HANDLE, KNIFE_BY_BLADE], (), "blade"),
        ([BY_HANDLE, grasping("knife", "blade", interval=NEVER)], (), "handle"),
        ([BY_HANDLE, grasping("knife", "handle", "pass", interval=NEVER)], (), None),
        ([grasping("*", "blade", "pass", interval=NEVER), KNIFE_BY_BLADE], (), "blade"),
        (
            [
                BY_HANDLE,
                KNIFE_BY_BLADE,
                grasping("knife", "blade", "pass", interval=NEVER, properties=["blunt"]),
            ],
            (BLUNT,),
            "handle",
        ),
        ([grasping("knife", "handle", interval=G), KNIFE_BY_BLADE], (), "blade"),
        ([grasping("knife", "handle", "pass", interval=G), BREAD_KNIFE_BY_BLADE], (), "handle"),
    ],
)
def test_part_of_the_most_specific_rule_is_grasped(
    rules: Sequence[Rule], shown: Sequence[Atom], part: str | None
):
    """A rule goes before a general one on the same part, and before another part it replaces."""
    for order in permutations(rules):
        assert grip(order, *shown) == part


def test_grip_of_a_kind_goes_before_that_of_the_kind_above():
    """In one context, a rule about bread knives is more specific than one about knives."""
    by_handle = grasping("knife", "handle", "pass", interval=G)

    assert grip([by_handle, BREAD_KNIFE_BY_BLADE], name="bread knife") == "blade"


def test_prohibition_of_a_part_is_not_lifted_by_a_rule_about_anything():
    """Neither of the two is more specific: they contradict each other, and nothing is accepted."""
    never = grasping("knife", "blade", interval=NEVER)

    assert grip([never, grasping("*", "blade", "pass", interval=G)]) is None


# --- Laws ----------------------------------------------------------------------------------

FEATURES = (Atom("object", "knife"), RED, *PARTS, BLUNT)
FEWER = st.frozensets(st.sampled_from(FEATURES[:-1]), min_size=1)
INTERVALS = st.sampled_from([G, S, NEVER, Interval(0.25, 1.0), Interval(0.2, 0.6)])
SPEAKERS = st.sampled_from(["sam", "kim"])
CONTEXT = frozenset({Atom("action", "pass")})


def cuts(features: frozenset[Atom], interval: Interval, speaker: str) -> Rule:
    """Return the rule that what has these features is used for cutting."""
    argument = Atom("affordance", "cutting")
    return Rule(features, frozenset(), "usedFor", argument, interval, speaker)


def grasped(features: frozenset[Atom], part: Atom, interval: Interval, speaker: str) -> Rule:
    """Return the rule that what has these features is passed by a part."""
    return Rule(features, CONTEXT, "graspObject", part, interval, speaker)


SETS = st.frozensets(st.sampled_from(FEATURES), min_size=1)
USES = st.builds(cuts, SETS, INTERVALS, SPEAKERS)
GRIPS = st.builds(grasped, SETS, st.sampled_from(PARTS), INTERVALS, SPEAKERS)
ALL_SHOWN = knife(BLUNT, RED, *PARTS)


def by_id(rules: Sequence[Rule]) -> list[Rule]:
    """Return the rules, each once."""
    return list({rule.id: rule for rule in rules}.values())


def parts_of(rules: Sequence[Rule]) -> dict[Atom | None, Interval]:
    """Return the interval of each part at the grasp node."""
    found = Affordances(Told(*rules)).infer(GRASP, KNIFE, [ALL_SHOWN]).candidates
    return {each.argument: each.interval for each in found}


@given(st.lists(USES, max_size=6), INTERVALS, FEWER, INTERVALS)
def test_more_general_rule_changes_nothing(
    others: list[Rule], interval: Interval, fewer: frozenset[Atom], level: Interval
):
    """Where a more specific rule applies, a general one makes no difference to the decision."""
    rules = [*by_id(others), cuts(frozenset(FEATURES), interval, "eve")]

    more = [*rules, cuts(fewer, level, "ann")]

    assert used(more, ALL_SHOWN).interval == used(rules, ALL_SHOWN).interval


@given(st.lists(GRIPS, max_size=5), GRIPS, FEWER, INTERVALS)
def test_more_general_rule_changes_no_grip(
    others: list[Rule], rule: Rule, fewer: frozenset[Atom], level: Interval
):
    """Beside a more specific rule on the same part, a general one makes no difference."""
    assert rule.part
    part = Atom("part", rule.part)
    rules = [*by_id(others), grasped(frozenset(FEATURES), part, rule.interval, "eve")]

    more = [*rules, grasped(fewer, part, level, "ann")]

    assert parts_of(more) == parts_of(rules)


@given(st.lists(USES, min_size=1, max_size=5), st.randoms())
def test_specificity_does_not_depend_on_the_order_of_teaching(rules: list[Rule], random):
    """The same rules in another order give the same interval to the last bit."""
    rules = by_id(rules)
    shuffled = random.sample(rules, len(rules))

    assert used(rules, ALL_SHOWN).interval == used(shuffled, ALL_SHOWN).interval
    assert set(used(rules, ALL_SHOWN).overruled) == set(used(shuffled, ALL_SHOWN).overruled)


@given(SETS, st.lists(INTERVALS, min_size=1, max_size=4))
def test_rules_with_one_feature_set_are_all_fused(
    features: frozenset[Atom], levels: list[Interval]
):
    """With one set of features no rule is more specific: the intervals are fused as ever."""
    rules = [cuts(features, each, f"speaker {i}") for i, each in enumerate(levels)]

    candidate = used(rules, ALL_SHOWN)

    assert candidate.overruled == ()
    fused = Settings().operators.fuse(levels)
    assert candidate.interval.lower == pytest.approx(fused.lower)
    assert candidate.interval.upper == pytest.approx(fused.upper)
