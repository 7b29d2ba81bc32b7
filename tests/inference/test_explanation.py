"""Proofs have the numbers of the inference, and explanations are made from proofs."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations_with_replacement

import hypothesis
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.inference.affordance import Affordances, DecisionRule
from hilt.inference.explanation import counterfactuals, rejection_reason
from hilt.inference.interval_operators import Operators
from hilt.inference.proof import Proof, apply_operator
from hilt.inference.settings import Settings
from hilt.inference.types import Goal, Inference, Observation, Target
from hilt.kb.interval import VACUOUS, Interval
from hilt.kb.rule import Atom, Rule, functional

from .rule_sources import Told

CUTTING = Goal("pass", Target(used_for="cutting"))
NAMES = ("knife", "spoon", "screwdriver")
levels = st.sampled_from([0.95, 0.75, 0.5, 0.25, 0.0])
bounds = st.tuples(levels, st.sampled_from([1.0, 0.95, 0.3])).map(
    lambda pair: Interval(min(pair), max(pair))
)
rules = st.lists(
    st.builds(
        lambda name, interval, speaker, trust: replace(
            functional(name, "cutting", interval=interval, speaker=speaker), trust=trust
        ),
        st.sampled_from(NAMES),
        bounds,
        st.sampled_from(["sam", "kim"]),
        st.sampled_from([1.0, 0.5]),
    ),
    max_size=8,
    unique_by=lambda rule: rule.id,
)
operators = st.builds(
    Operators,
    conjunction=st.sampled_from(["product", "frechet", "min"]),
    modus_ponens=st.sampled_from(["conditional", "published", "material"]),
    fusion=st.sampled_from(["yager", "mean"]),
)


def decided(
    rules: Sequence[Rule], sure: float = 0.9, settings: Settings | None = None
) -> Inference:
    """Return what the find node infers for named objects that are detected with one confidence."""
    seen = [Observation(n, n, {Atom("object", n): Interval(sure, 1.0)}) for n in NAMES]
    return Affordances(Told(*rules), settings).infer("pass/findObject", CUTTING, seen)


def rule(name: str, degree: float) -> Rule:
    """Return a rule that an object is used for cutting."""
    return functional(name, "cutting", interval=Interval(degree, 1.0))


@given(rules, st.floats(0.05, 1.0), operators, st.sampled_from(["rules", "conclusions"]))
def test_evaluated_proof_gives_the_interval_of_the_decision(
    told: list[Rule], sure: float, chosen: Operators, stage: str
):
    """A proof evaluated from its leaves gives the interval of the decision, bit for bit."""
    settings = Settings(operators=chosen, stage=stage)

    for candidate in decided(told, sure, settings).candidates:
        assert candidate.proof.evaluate(chosen) == candidate.interval


@given(rules)
def test_proof_has_exactly_the_rules_that_apply(told: list[Rule]):
    """The proof of each object has all rules about it that say something, and no others."""
    for candidate in decided(told).candidates:
        about = [each for each in told if each.object == candidate.name]
        about = {each.id for each in about if not each.interval.is_vacuous}
        assert {each.id for each in candidate.rules} == about


def test_why_prints_the_proof_from_the_conclusion_down():
    """Each line has the interval, the step and the statement."""
    proof = decided([rule("knife", 0.95)]).candidates[0].proof

    lines = [line.strip() for line in proof.lines()]
    assert lines[0] == "[0.85, 1.00]  modus ponens  knife affords affordance:cutting"
    assert lines[1] == "[0.90, 1.00]  seen  object:knife seen on knife"
    assert lines[2].startswith("[0.95, 1.00]  told  <Rule object:knife => usedFor(cutting)")


@pytest.mark.parametrize(
    ("name", "reason"),
    [("spoon", "I am surer of the knife"), ("screwdriver", "nobody has told me so")],
)
def test_why_not_says_what_is_against_the_rejected_object(name: str, reason: str):
    """A rejected object is explained by its own verdict, or by the chosen one, without figures."""
    inference = decided([rule("knife", 0.95), rule("spoon", 0.5)])

    candidate = next(each for each in inference.candidates if each.name == name)
    assert reason in rejection_reason(inference, candidate)


def test_as_good_as_the_choice_is_told_from_worse():
    """Of two equal objects the first one in the scene is chosen, and the reason says so."""
    inference = decided([rule("knife", 0.95), rule("spoon", 0.95)])

    assert rejection_reason(inference, inference.candidates[1]) == (
        "the knife is as good, and I saw it first"
    )


def test_smallest_change_makes_the_rival_as_good_as_the_choice():
    """A spoon with .5 is chosen as soon as its rule has the interval of the knife's rule."""
    inference = decided([rule("knife", 0.75), rule("spoon", 0.5)], sure=1.0)

    change = counterfactuals(inference, Settings())[0]

    assert change.chosen == "spoon"
    assert change.size == pytest.approx(0.25, abs=1e-6)


@hypothesis.settings(deadline=None, max_examples=30)
@given(rules)
def test_each_listed_change_changes_the_decision(told: list[Rule]):
    """The choice after each listed change is another candidate, or none."""
    settings = Settings()
    inference = decided(told)

    for change in counterfactuals(inference, settings):
        instead = {change.evidence: change.after}
        again = [
            (c.proof.evaluate(settings.operators, instead), c.name) for c in inference.candidates
        ]
        best = inference.best
        assert change.chosen != (best.name if best else None)
        assert change.chosen is None or change.chosen in {name for _, name in again}


STEPS = 12  # of the grid on which brute force looks for a smaller change


@hypothesis.settings(deadline=None, max_examples=10)
@given(rules, st.sampled_from([1.0, 0.9, 0.6]))
def test_no_smaller_change_of_one_interval_changes_the_decision(told: list[Rule], sure: float):
    """A search over all intervals of a grid finds no smaller change for any leaf."""
    inference = decided(told, sure)
    decision = DecisionRule(inference.node, inference.threshold, Operators())
    found = {
        change.evidence: change.size for change in reversed(counterfactuals(inference, Settings()))
    }
    now = decision.best_index([each.interval for each in inference.candidates])

    for leaf in {leaf for each in inference.candidates for leaf in each.proof.leaves}:
        for low, high in combinations_with_replacement(range(STEPS + 1), 2):
            instead = Interval(low / STEPS, high / STEPS)
            size = abs(instead.lower - leaf.interval.lower) + abs(
                instead.upper - leaf.interval.upper
            )
            if size < found.get(leaf, 3.0) - 1e-6:
                then = [
                    c.proof.evaluate(Operators(), {leaf: instead}) for c in inference.candidates
                ]
                assert decision.best_index(then) == now, (leaf, instead)


def test_change_of_a_denied_interval_moves_both_bounds():
    """The lower bound alone cannot rise, because it would exceed the upper bound."""
    denied = decided([functional("knife", "cutting", interval=Interval(0, 0.05))], sure=1.0)

    change = next(c for c in counterfactuals(denied, Settings()) if c.evidence.rule)

    assert change.chosen == "knife"
    assert change.after.lower == pytest.approx(change.after.upper)
    assert change.after.lower > 0.5


def test_absent_object_has_a_proof_and_a_change():
    """A rule about an unseen object gives [0, 1]; a weak detection would change the decision."""
    inference = Affordances(Told(rule("hammer", 0.95))).infer("pass/findObject", CUTTING, [])

    (absent,) = inference.absent
    (change,) = counterfactuals(inference, Settings())

    assert (absent.verdict, absent.interval) == ("absent", VACUOUS)
    assert (change.evidence.label, change.chosen) == ("object:hammer not seen", "hammer")
    assert change.after.lower == pytest.approx(0.162, abs=1e-3)


def test_json_of_a_proof_has_its_rules_and_intervals():
    """The JSON of a proof has the tree of the proof."""
    document = decided([rule("knife", 0.95)]).candidates[0].proof.as_json()

    assert (document["step"], document["lower"]) == ("modus ponens", pytest.approx(0.855))
    seen, told = document["inputs"]
    assert seen["about"] == "object:knife seen on knife"
    assert told["rule"].startswith("rule/")


def test_json_of_a_proof_says_nothing_of_what_is_not_there():
    """A leaf has no inputs, an operator no description, and most proofs overrule nothing."""
    proof = decided([rule("knife", 0.95)]).candidates[0].proof
    plain = replace(proof, label="")

    assert set(plain.as_json()) == {"step", "lower", "upper", "inputs"}
    assert set(proof.inputs[0].as_json()) == {"step", "lower", "upper", "about"}
    assert set(proof.inputs[1].as_json()) == {"step", "lower", "upper", "about", "rule"}


def test_lines_of_a_proof_are_indented_by_depth():
    """Two spaces for each step down; what is overruled stands with the inputs."""
    proof = decided([rule("knife", 0.95)]).candidates[0].proof
    above = Proof("and", proof.interval, inputs=(replace(proof, overruled=(rule("fork", 0.5),)),))

    depths = [len(line) - len(line.lstrip()) for line in above.lines()]

    assert depths == [0, 2, 4, 4, 4]


def test_conjunction_in_a_proof_is_no_modus_ponens():
    """Each step has its own operator."""
    half = Interval(0.5, 0.5)

    assert apply_operator("and", [half, half], Operators()) == Interval(0.25, 0.25)
    assert apply_operator("modus ponens", [half, half], Operators()) == Interval(0.25, 0.75)
