"""getFeatures and getAffordance at the nodes of an action tree."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.inference.affordance import Affordances, DecisionRule
from hilt.inference.interval_operators import Operators
from hilt.inference.node_rules import ObjectRules
from hilt.inference.proof import Proof
from hilt.inference.settings import Settings
from hilt.inference.taxonomy import Taxonomy
from hilt.inference.types import Conclusion, Goal, Observation, Target
from hilt.kb.interval import EPSILON, Interval
from hilt.kb.rule import Atom, Rule, functional, grasping
from hilt.ontology.errors import UnknownNameError

G, O, S, C = (Interval(p, 1.0) for p in (0.95, 0.75, 0.5, 0.25))  # noqa: E741
NEVER = Interval(0.0, 0.05)
FIND, GRASP = "pass/findObject", "pass/graspObject"
CUTTING = Goal("pass", Target(used_for="cutting"))
KNIFE = Goal("pass", Target(object="knife"))


class Rules:
    """A rule source that looks rules up in a list by their nodes."""

    def __init__(self, *rules: Rule) -> None:
        self.rules = list(rules)
        self.asked: list[str] = []

    @property
    def sequence(self) -> int:
        """The number of rules."""
        return len(self.rules)

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """Return the rules at these nodes."""
        self.asked += nodes
        return [rule for rule in self.rules if rule.node in nodes]


def seen(name: str, sure: float = 1.0, *others: Atom) -> Observation:
    """Return an observation of an object, with further features."""
    interval = Interval(sure, 1.0)
    return Observation(
        name, name, {Atom("object", name): interval, **dict.fromkeys(others, interval)}
    )


def found(*rules: Rule, goal: Goal = CUTTING, scene: Sequence[str], settings=None):
    """Return what the find node infers for a scene with these objects."""
    affordances = Affordances(Rules(*rules), settings)
    return affordances.infer(FIND, goal, [seen(name) for name in scene])


def knife_rules() -> tuple[Rule, Rule, Rule]:
    """Rules r1 to r3 of the paper's section 3.3."""
    return (
        functional("knife", "cutting", interval=G),
        grasping("knife", "handle", "pickUp", interval=G),
        grasping("knife", "blade", "pass", interval=G),
    )


# --- getFeatures ---------------------------------------------------------------------------


def test_features_of_the_find_node_are_those_of_the_affordance():
    """The find node searches only for objects that rules relate to cutting."""
    other = functional("mug", "containing", interval=G)

    features = Affordances(Rules(*knife_rules(), other)).features(FIND, CUTTING)

    assert features == (Atom("object", "knife"),)


def test_features_of_a_named_object_are_the_object_and_its_adjectives():
    """A named object is searched for by its name and adjectives, without any rule."""
    goal = Goal("pass", Target(object="mug", properties=frozenset({"red"})))

    assert Affordances(Rules()).features(FIND, goal) == (
        Atom("object", "mug"),
        Atom("property", "red"),
    )


def test_node_without_rules_has_no_features():
    """A node without rules searches for nothing."""
    assert Affordances(Rules(*knife_rules())).features("pass/moveTo", KNIFE) == ()


# --- getAffordance: which thing ------------------------------------------------------------


def test_without_rules_nothing_is_accepted():
    """No object is accepted without a rule, and the reason says so."""
    inference = found(scene=["knife"])

    assert inference.best is None
    assert inference.candidates[0].reason == "nothing that was told says so"


@pytest.mark.parametrize(
    ("scene", "chosen"),
    [
        (["spoon", "screwdriver", "knife"], "knife"),
        (["spoon", "screwdriver"], "screwdriver"),
        (["spoon"], "spoon"),
        (["mug"], None),
    ],
)
def test_second_best_object_is_chosen_when_the_best_is_absent(scene: list[str], chosen: str | None):
    """Principles 1, 2 and 4 of section 4.1 of the paper hold."""
    rules = [
        functional("knife", "cutting", interval=G),
        functional("screwdriver", "cutting", interval=S),
        functional("spoon", "cutting", interval=C),
    ]

    best = found(*rules, scene=scene).best

    assert (best.name if best else None) == chosen


def test_only_objects_with_the_wanted_use_are_named_as_absent():
    """A knife cuts, and is not there; that a hammer is not there does not matter."""
    rules = (
        functional("knife", "cutting", interval=G),
        functional("hammer", "pounding", interval=G),
    )

    inference = found(*rules, scene=["mug"])

    assert [absent.object for absent in inference.absent] == ["knife"]
    assert found(*rules, scene=["knife"]).absent == ()


def test_equally_ranked_objects_keep_the_order_of_the_scene():
    """Principle 3: either object may be chosen, and the order of the scene decides."""
    rules = [functional(name, "cutting", interval=C) for name in ("spoon", "spatula")]

    inference = found(*rules, scene=["spoon", "spatula"])

    assert [c.name for c in inference.ties] == ["spoon", "spatula"]
    assert inference.best is not None and inference.best.name == "spoon"


def test_numbers_of_the_running_example():
    """A knife detected with .95 and a rule [.95, 1] give [.9025, 1]."""
    affordances = Affordances(Rules(*knife_rules()))

    best = affordances.infer(FIND, CUTTING, [seen("knife", 0.95)]).best

    assert best is not None
    assert (best.interval.lower, best.interval.upper) == pytest.approx((0.9025, 1.0))
    assert best.certainty == pytest.approx(0.5674, abs=1e-3)


def test_evidence_of_several_speakers_is_fused():
    """Two speakers with "often" and "sometimes" give [.875, 1]."""
    rule = functional("knife", "cutting", interval=O)
    other = functional("knife", "cutting", interval=S, speaker="kim")

    best = found(rule, other, scene=["knife"]).best

    assert best is not None
    assert best.interval.lower == pytest.approx(0.875)
    assert len(best.rules) == 2


def test_shared_antecedent_is_counted_once():
    """Rules are fused before modus ponens, so the belief stays below the detection confidence."""
    rules = [functional("knife", "cutting", interval=level) for level in (G, O)]
    source = Rules(*rules)

    fused = Affordances(source).infer(FIND, CUTTING, [seen("knife", 0.9)]).best
    literal = Affordances(source, Settings(stage="conclusions")).infer(
        FIND, CUTTING, [seen("knife", 0.9)]
    )

    assert fused is not None and fused.interval.lower == pytest.approx(0.88875)
    assert literal.candidates[0].interval.lower > 0.9


def test_rule_of_a_half_trusted_speaker_is_discounted():
    """With trust .5 a rule with "generally" counts as [.475, 1]."""
    rule = replace(functional("knife", "cutting", interval=G), trust=0.5)

    best = found(rule, scene=["knife"]).best

    assert best is not None and best.interval.lower == pytest.approx(0.475)


def test_negative_rule_denies_and_is_not_chosen():
    """An object that is "never used for cutting" is denied, not unknown."""
    inference = found(functional("spoon", "cutting", interval=NEVER), scene=["spoon"])

    assert inference.best is None
    assert [c.name for c in inference.denied] == ["spoon"]


def test_not_used_for_accepts_denied_objects_only():
    """A mug without rules is not accepted as an object that is not used for cutting."""
    goal = Goal("pass", Target(not_used_for="cutting"))
    rules = [functional("spoon", "cutting", interval=NEVER)]

    inference = found(*rules, goal=goal, scene=["mug", "spoon"])

    assert [(c.name, c.accepted) for c in inference.candidates] == [("spoon", True), ("mug", False)]


def test_low_detection_confidence_is_not_accepted():
    """A rule with "occasionally" needs a detection confidence of .62 at the default threshold."""
    affordances = Affordances(Rules(functional("spoon", "cutting", interval=C)))

    weak, strong = (
        affordances.infer(FIND, CUTTING, [seen("spoon", sure)]).best for sure in (0.61, 0.62)
    )

    assert weak is None
    assert strong is not None


def test_threshold_of_the_nearest_context_is_used():
    """Each context may have a threshold of its own."""
    settings = Settings(thresholds={"pass": 0.9})

    inference = found(knife_rules()[0], scene=["knife"], settings=settings)

    assert (inference.threshold, inference.best) == (0.9, None)


def test_all_features_must_be_seen():
    """A rule about red mugs does not apply to a mug that is not red."""
    rule = functional("mug", "cutting", interval=G, properties=["red"])
    red = seen("mug", 1.0, Atom("property", "red"))

    best = Affordances(Rules(rule)).infer(FIND, CUTTING, [seen("mug"), red]).best

    assert best is not None and best.interval == G


# --- getAffordance: which part -------------------------------------------------------------


@pytest.mark.parametrize(
    ("node", "part"),
    [("pass/graspObject", "blade"), ("pickUp/graspObject", "handle"), ("use/graspObject", None)],
)
def test_context_decides_the_part(node: str, part: str | None):
    """The knife is passed by the blade and picked up by the handle."""
    best = Affordances(Rules(*knife_rules())).infer(node, KNIFE, [seen("knife")]).best

    assert (best.argument.name if best and best.argument else None) == part


def test_rule_of_the_nearest_context_overrules_the_contexts_above():
    """Within pounding, picking up uses its own rules, or else those of pounding."""
    pickup = grasping("hammer", "handle", "pickUp", interval=S)
    pound = grasping("hammer", "head", "pound", interval=G)
    goal = Goal("pound", Target(object="hammer"))
    node = "pound/pickUp/graspObject"

    both = Affordances(Rules(pickup, pound)).infer(node, goal, [seen("hammer")]).best
    one = Affordances(Rules(pound)).infer(node, goal, [seen("hammer")]).best

    assert both is not None and both.argument == Atom("part", "handle")
    assert one is not None and one.argument == Atom("part", "head")


def test_rules_of_other_objects_do_not_apply():
    """A rule about passing shoes does not apply to a knife."""
    rule = grasping("shoe", "sole", "pass", interval=G)

    assert Affordances(Rules(rule)).infer(GRASP, KNIFE, [seen("knife")]).candidates == ()


def test_forbidden_part_is_denied():
    """A rule with "never" by the blade denies the blade and accepts no part."""
    rule = grasping("knife", "blade", "pass", interval=NEVER)

    inference = Affordances(Rules(rule)).infer(GRASP, KNIFE, [seen("knife")])

    assert inference.best is None
    assert [c.argument for c in inference.denied] == [Atom("part", "blade")]


def test_rule_with_a_place_is_weighted_by_the_interval_of_the_place():
    """A rule for the kitchen is weighted by the belief that the place is a kitchen."""
    kitchen = Atom("place", "kitchen")
    rule = replace(knife_rules()[0], contexts=frozenset({kitchen}))
    there = Goal("pass", Target(used_for="cutting"), {kitchen: Interval(0.5, 1.0)})

    elsewhere = found(rule, scene=["knife"]).best
    best = found(rule, goal=there, scene=["knife"]).best

    assert elsewhere is None
    assert best is not None and best.interval.lower == pytest.approx(0.475)


# --- Materials -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("told", "wanted", "expected"),
    [
        ([(None, G)], "bread", G),
        ([(None, NEVER)], "bread", NEVER),
        ([("bread", G)], "bread", G),
        ([("bread", NEVER)], "bread", NEVER),
        ([("wood", G)], "bread", Interval(0, 1)),
        ([("wood", NEVER)], "bread", Interval(0, 1)),
        ([(None, G)], None, G),
        ([(None, NEVER)], None, NEVER),
        ([("bread", G)], None, G),
        ([("bread", NEVER)], None, Interval(0, 1)),
        ([("wood", G), ("bread", NEVER)], None, G),
        ([("wood", G), ("bread", NEVER)], "wood", G),
        ([("wood", G), ("bread", NEVER)], "bread", NEVER),
        ([(None, O), ("bread", S)], "bread", S),
        ([("wood", O), ("bread", S)], None, Interval(0.875, 1)),
        ([(None, G), ("bread", NEVER)], "bread", NEVER),
        ([(None, NEVER), ("bread", G)], "bread", G),
        ([("bread", G), ("rye bread", NEVER)], "rye bread", NEVER),
        ([(None, G), ("bread", NEVER)], "wood", G),
        ([("bread", S)], "rye bread", S),
        ([("rye bread", S)], "bread", Interval(0, 1)),
    ],
)
def test_rule_applies_to_its_material(
    told: list[tuple[str | None, Interval]], wanted: str | None, expected: Interval
):
    """A rule with a material is about that one; a use on any material is a use."""
    rules = [functional("saw", "cutting", interval=each, material=name) for name, each in told]
    goal = Goal("pass", Target(used_for="cutting", material=wanted))
    kinds = Taxonomy([(Atom("object", "rye bread"), Atom("object", "bread"))])

    [saw] = Affordances(Rules(*rules), taxonomy=kinds).infer(FIND, goal, [seen("saw")]).candidates

    assert saw.interval.lower == pytest.approx(expected.lower)
    assert saw.interval.upper == pytest.approx(expected.upper)


def test_uses_on_two_materials_count_the_observation_once():
    """Belief in a use stays below belief in the object, however many materials were told."""
    rules = [functional("saw", "cutting", interval=G, material=name) for name in ("wood", "bread")]

    [saw] = Affordances(Rules(*rules)).infer(FIND, CUTTING, [seen("saw", 0.9)]).candidates

    assert saw.interval.lower == pytest.approx(0.9 * (1 - 0.05**2))


# --- The set taught, nothing else ----------------------------------------------------------


@given(st.permutations(range(6)))
def test_inference_does_not_depend_on_the_order_of_teaching(order: list[int]):
    """The same rules in another order give bit-identical intervals."""
    rules = [
        functional(name, "cutting", interval=level, speaker=speaker)
        for name, level, speaker in [
            ("knife", G, "sam"), ("knife", O, "kim"), ("knife", C, "ann"),
            ("spoon", S, "sam"), ("spoon", C, "kim"), ("spoon", O, "ann"),
        ]
    ]  # fmt: skip

    shuffled = found(*(rules[i] for i in order), scene=["knife", "spoon"])
    sorted_ = found(*rules, scene=["knife", "spoon"])

    assert [c.interval for c in shuffled.candidates] == [c.interval for c in sorted_.candidates]


def test_rules_are_read_again_only_after_a_change():
    """A new sequence number of the source makes the rules be read again."""
    source = Rules(knife_rules()[0])
    affordances = Affordances(source)

    for _ in range(3):
        affordances.infer(FIND, CUTTING, [seen("knife")])
    before = len(source.asked)
    source.rules.append(functional("spoon", "cutting", interval=C))
    after = affordances.features(FIND, CUTTING)

    assert before == 2  # the kinds of objects, and the node
    assert Atom("object", "spoon") in after


def test_unknown_stage_is_an_error():
    """A misspelt stage is refused when the settings are made."""
    with pytest.raises(UnknownNameError, match="fusion stage"):
        Settings(stage="nonsense")


# --- What is shown of a decision -----------------------------------------------------------


def cutting_with(name: str, other: str, interval: Interval = G) -> Rule:
    """The rule that an object cuts another one."""
    features = frozenset({Atom("object", name)})
    return Rule(features, frozenset(), "cutWith", Atom("object", other), interval)


def test_nothing_is_absent_where_something_in_view_will_do():
    """A knife that is not there does not matter when a spoon is accepted."""
    rules = [functional(name, "cutting", interval=G) for name in ("knife", "spoon")]

    assert found(*rules, scene=["spoon"]).absent == ()


def test_object_in_view_is_not_absent_though_hardly_seen():
    """What is in view is not looked for elsewhere, accepted or not."""
    rule = functional("knife", "cutting", interval=G)

    inference = Affordances(Rules(rule)).infer(FIND, CUTTING, [seen("knife", 0.0)])

    assert inference.best is None
    assert inference.absent == ()


@pytest.mark.parametrize(
    ("wanted", "absent"), [(None, ["knife", "saw"]), (Atom("object", "bread"), ["knife"])]
)
def test_what_is_absent_affords_what_is_asked_for(wanted: Atom | None, absent: list[str]):
    """With an argument, only what affords it for this argument; otherwise for any."""
    rules = [cutting_with("knife", "bread"), cutting_with("saw", "wood")]
    goal = Goal("pass", Target(affords=Conclusion("cutWith", wanted)))

    inference = found(*rules, goal=goal, scene=["mug"])

    assert [each.object for each in inference.absent] == absent
    assert [each.inherited for each in inference.absent] == [0] * len(absent)


def test_confirmed_object_need_only_be_seen():
    """What the speaker confirmed is accepted without any rule."""
    goal = Goal("pass", Target(used_for="cutting", is_confirmed=True))

    best = found(goal=goal, scene=["knife"]).best

    assert best is not None
    assert best.interval == Interval(1.0, 1.0)
    assert best.proof.label == "knife was confirmed by the speaker"


def test_feature_that_was_not_seen_is_reported_with_its_object():
    """The evidence says on which object a property was not seen."""
    goal = Goal("pass", Target(object="mug", properties=frozenset({"red"})))

    [mug] = found(goal=goal, scene=["mug"]).candidates

    assert [leaf.label for leaf in mug.proof.leaves] == [
        "object:mug seen on mug",
        "property:red not seen on mug",
    ]


@pytest.mark.parametrize("times", [(1, 2), (2, 1), (None, 1), (1, None), (0, None), (None, 0)])
@pytest.mark.parametrize("stage", ["rules", "conclusions"])
def test_proof_has_the_rules_in_the_order_of_teaching(times: tuple[int | None, ...], stage: str):
    """What was told first stands first, for one antecedent and for several; unstored is first."""
    rule = functional("knife", "cutting", interval=G)
    red = functional("knife", "cutting", interval=C, properties=["red"])
    told = [replace(each, utterance=n) for each, n in zip((rule, red), times, strict=True)]
    sharing = [replace(rule, utterance=n, speaker=f"teacher {n}") for n in times]
    goal = Goal("pass", Target(used_for="cutting"))

    for rules in (told, sharing):
        [knife] = (
            Affordances(Rules(*rules), Settings(stage=stage))
            .infer(FIND, goal, [seen("knife", 1.0)])
            .candidates
        )
        shown = [each.utterance or 0 for each in knife.rules]
        assert shown == sorted(shown)


def test_unknown_use_is_not_shown_as_afforded():
    """Where nothing was told, the proof says so."""
    [knife] = found(scene=["knife"]).candidates

    assert knife.proof.label == "nothing was told of knife"
    assert knife.inherited == 0


def test_what_is_afforded_has_its_functor():
    """Uses and parts imply it; what else is afforded is shown with it, if a rule says so."""
    bread = Conclusion("cutWith", Atom("object", "bread"))
    goal = Goal("pass", Target(affords=bread))
    red = Goal("pass", Target(properties=frozenset({"red"}), affords=bread))

    [knife] = found(cutting_with("knife", "bread"), goal=goal, scene=["knife"]).candidates
    [unknown] = found(goal=red, scene=["knife"]).candidates
    [cutter] = found(functional("knife", "cutting", interval=G), scene=["knife"]).candidates

    assert knife.proof.label == "knife affords cutWith(object:bread)"
    assert unknown.proof.label == "knife affords object:bread"
    assert cutter.proof.label == "knife affords affordance:cutting"


def test_single_best_object_has_no_tie():
    """One candidate is not as good as itself."""
    rules = [functional("knife", "cutting", interval=G), functional("spoon", "cutting", interval=C)]

    assert found(*rules, scene=["knife", "spoon"]).ties == ()


@pytest.mark.parametrize(("steps", "end"), [(1, "1 step up"), (2, "2 steps up")])
def test_inherited_rule_is_reported_with_its_distance(steps: int, end: str):
    """The reason says how far up the hierarchy the rule stands."""
    names = ["bread knife", "knife", "cutlery"]
    atoms = [Atom("object", name) for name in names]
    kinds = Taxonomy(list(pairwise(atoms)))
    rule = functional(names[steps], "cutting", interval=G)

    inference = Affordances(Rules(rule), taxonomy=kinds).infer(FIND, CUTTING, [seen("bread knife")])

    assert inference.candidates[0].reason.endswith(f"; inherited, {end}")


def test_candidates_are_as_good_up_to_rounding_errors():
    """Less than the tolerance apart, the first one is best; from there on it is not."""
    decision = DecisionRule(FIND, 0.0, Operators(ranking="belief"))
    best = Interval(0.75, 1.0)

    for less, is_tied in ((EPSILON, False), (EPSILON / 2, True)):
        intervals = [Interval(best.lower - less, 1.0), best]
        found = [
            decision.candidate(seen(name), None, [Proof("given", interval)], ObjectRules())
            for name, interval in zip(("knife", "spoon"), intervals, strict=True)
        ]
        assert decision.best_index(intervals) == (0 if is_tied else 1)
        assert [each.name for each in decision.ranked(found).ties] == (
            ["knife", "spoon"] if is_tied else []
        )
