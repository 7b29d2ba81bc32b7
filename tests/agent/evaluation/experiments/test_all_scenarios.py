"""The verification of all learning scenarios: its cases, its hypotheses and its certificate."""

from __future__ import annotations

import json
import runpy
from copy import deepcopy
from decimal import Decimal
from math import comb, factorial
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.agent.evaluation.experiment import Case, CaseResult, to_json_line
from hilt.agent.evaluation.experiments.all_scenarios import (
    AllScenariosExperiment,
    RandomScenariosExperiment,
)
from hilt.agent.evaluation.verification.checks import (
    check_growth,
    check_scores,
    check_situations,
    check_teaching,
)
from hilt.agent.evaluation.verification.scenario_space import ScenarioSpace, belief
from hilt.agent.evaluation.verification.taught_agent import RuleKey, TaughtAgent, TracingSource
from hilt.agent.evaluation.verification.weak_orders import (
    OpaqueScore,
    WeakOrderClass,
    check_choices,
    surjections,
    weak_order_blocks,
)
from hilt.inference.affordance import Affordances, DecisionRule
from hilt.inference.interval_operators import EPSILON, Operators
from hilt.inference.settings import Settings
from hilt.inference.types import Inference, Target
from hilt.kb import Interval, KnowledgeBase, functional

CHECKER = Path(__file__).parents[4] / "examples" / "check_certificate.py"
SMALL = AllScenariosExperiment(objects=2, affordances=2, taught=3, traced=2, grown=2)


@pytest.fixture(scope="module")
def results() -> list[CaseResult]:
    """What comes of the verification for two objects and two affordances."""
    sent = [Case(**json.loads(to_json_line(case))) for case in SMALL.cases()]
    return [SMALL.run(case) for case in sent]


@pytest.fixture(scope="module")
def checker() -> dict[str, object]:
    """What the checker defines, for the small run."""
    defined = runpy.run_path(str(CHECKER))
    assert defined["NUMBERS"] == numbers_of_runs(AllScenariosExperiment())
    defined["NUMBERS"].update(numbers_of_runs(SMALL))
    return defined


def numbers_of_runs(experiment: AllScenariosExperiment) -> dict[str, int]:
    """How many scenarios and orders an experiment draws."""
    drawn = experiment.taught, experiment.traced, experiment.grown
    return dict(zip(("teaching", "situations", "growth"), drawn, strict=True))


@pytest.fixture(scope="module")
def certificate(results):
    """The certificate as the checker reads it."""
    document = SMALL.files(results)["certificate.json"]
    return json.loads(json.dumps(document), parse_float=Decimal)


def numbers_of(document, path=()):
    """The paths of all numbers in a document, and of all digests."""
    if isinstance(document, (dict, list)):
        pairs = document.items() if isinstance(document, dict) else enumerate(document)
        return [found for key, each in pairs for found in numbers_of(each, (*path, key))]
    is_number = isinstance(document, (int, Decimal)) or (path and path[-1] == "digest")
    return [path] if is_number else []


def test_every_finite_case_is_right(results):
    """The program does what the definition says in all blocks of cases."""
    assert [result.found for result in results if not result.right] == []


def test_the_paper_has_2189146_finite_cases():
    """The blocks hold as many cases as the counting formulas say."""

    def size(block: WeakOrderClass) -> int:
        stirling = sum(
            (-1) ** i * comb(block.levels, i) * (block.levels - i) ** block.ranked
            for i in range(block.levels + 1)
        ) // factorial(block.levels)
        ranked = comb(8, block.ranked) * 2 ** (8 - block.ranked)
        return ranked * factorial(block.levels) * stirling

    choices = sum(size(block) for block in weak_order_blocks(8))

    assert choices == 2_183_339
    assert choices + 559 + 72 * 16 + 8 * 2 * 16**2 == 2_189_146


def test_blocks_hold_each_weak_order_once():
    """The orders of all blocks of three objects are distinct, and as many as counted."""
    orders = [order for block in weak_order_blocks(3) for order in block.orders()]

    assert len(orders) == len(set(orders)) == sum(comb(3, k) * 2 ** (3 - k) * f for k, f in
                                                  enumerate((1, 1, 3, 13)))  # fmt: skip
    assert len(surjections(3, 2)) == 6


def test_rule_states_are_counted_over_the_whole_space(results):
    """The weak orders, weighted, are all 17^n ways to teach one affordance and lay a scene."""
    states = SMALL.summary(results)["rule_states"]

    unique = sum(2 * (code + 1) for code in range(1, 16))
    assert states == {"none": 4, "unique": unique, "ties": 17**2 - unique - 4}


def test_certificate_passes_its_checker(certificate, checker):
    """What the program did is what the definition says, number by number."""
    assert list(checker["differences"](certificate, checker["expected"](certificate))) == []


@settings(max_examples=80, deadline=None)
@given(data=st.data())
def test_checker_refuses_any_changed_number(certificate, checker, data):
    """A certificate in which one number or digest is another one is refused."""
    path = data.draw(st.sampled_from(numbers_of(certificate)))
    changed = deepcopy(certificate)
    inner = changed
    for key in path[:-1]:
        inner = inner[key]
    before = inner[path[-1]]
    inner[path[-1]] = "0" + before[1:] if isinstance(before, str) else before + data.draw(
        st.sampled_from([1, -1, Decimal("0.000000001")]))  # fmt: skip

    wanted = checker["expected"](changed)

    assert inner[path[-1]] == before or any(checker["differences"](changed, wanted))


@pytest.mark.parametrize("key", ["format", "seed", "threshold", "tolerance"])
def test_checker_refuses_other_settings(certificate, checker, key):
    """Nor does it pass with another seed, threshold or tolerance than the program's."""
    changed = certificate | {key: certificate[key] + 1}

    assert any(checker["differences"](changed, checker["expected"](changed)))


def test_checker_says_what_a_certificate_stands_for(results, tmp_path, checker, capsys):
    """Run as a script it names the situations and learning scenarios, or the first difference."""
    file = tmp_path / "certificate.json"
    file.write_text(json.dumps(SMALL.files(results)["certificate.json"]), encoding="utf-8")
    assert not checker["main"](file)

    file.write_text(json.dumps(SMALL.files(results[:-1])["certificate.json"]), encoding="utf-8")
    assert checker["main"](file)

    said = capsys.readouterr().out.splitlines()
    assert said[0].endswith("right for all 24 * 2^48 situations and learning scenarios.")
    assert said[1].endswith("certificate[choices]: other keys, or another number of them.")


def test_another_fusion_is_found_out(monkeypatch):
    """Scores by the mean of what was told are not those of the definition."""
    other = Settings(operators=Operators(fusion="mean"))
    monkeypatch.setattr(Settings, "load", classmethod(lambda cls: other))

    _, wrong = check_scores(ScenarioSpace.from_paper(1, 1), shift=3)

    assert wrong


@pytest.fixture(scope="module")
def taught_space() -> ScenarioSpace:
    """Three objects, one affordance: a node has up to 12 or 24 rules."""
    return ScenarioSpace.from_paper(3, 1)


def hide_at_node(monkeypatch, hidden, owner=KnowledgeBase, name="rules_at_nodes"):
    """Patch what finds the rules of a node: `hidden` returns those that are left out."""
    original = getattr(owner, name)

    def fewer(self, key):
        rules = list(original(self, key))
        return [rule for rule in rules if rule not in hidden(self, rules)]

    monkeypatch.setattr(owner, name, fewer)


def a_rule_of_9_or_10(_, rules):
    """The last rule of a node that holds 9 or 10."""
    return rules[-1:] if len(rules) in {9, 10} else []


def a_rule_after_40_changes(base, rules):
    """The first rule of every node, while the base has been changed just so often."""
    return rules[:1] if base.sequence == 40 else []


def the_knife_without_the_spoon(_, rules):
    """The rules about knives, if nothing was told of spoons."""
    without = not any(rule.object == "spoon" for rule in rules)
    return [rule for rule in rules if rule.object == "knife"] if without else []


def what_another_object_shares(_, rules):
    """Rules that are as sure as one about an object earlier in the alphabet."""
    said = {(rule.object, rule.interval) for rule in rules}
    return [r for r in rules if any(o < r.object and i == r.interval for o, i in said)]


def more_than_11_rules(_, rules):
    """All rules of a node behind the eleventh."""
    return rules[11:]


def test_scores_do_not_change_while_the_base_grows(taught_space):
    """Without any of the faults below nothing is refused."""
    assert check_growth(taught_space, 0, 0)[1] == []


@pytest.mark.parametrize("owner", [(KnowledgeBase, "rules_at_nodes"), (Affordances, "_rules_at")])
@pytest.mark.parametrize(
    "hidden",
    [
        a_rule_of_9_or_10,
        a_rule_after_40_changes,
        the_knife_without_the_spoon,
        what_another_object_shares,
        more_than_11_rules,
    ],
)
def test_rules_hidden_by_the_presence_of_others_are_found_out(
    monkeypatch, taught_space, hidden, owner
):
    """Wherever rules get lost because of others: while the base grows, the scores are wrong."""

    def hidden_there(self, rules):
        return hidden(getattr(self, "source", self), rules)

    hide_at_node(monkeypatch, hidden_there, *owner)

    _, wrong = check_growth(taught_space, 0, 0)

    assert wrong


def test_rules_that_are_remembered_too_long_are_found_out(monkeypatch, taught_space):
    """A cache that is not emptied at every fifth change is noticed while the base grows."""
    sequence = TracingSource.sequence.fget
    assert sequence is not None
    stale = property(lambda source: sequence(source) - (sequence(source) % 5 == 0))
    monkeypatch.setattr(TracingSource, "sequence", stale)

    _, wrong = check_growth(taught_space, 0, 0)

    assert wrong


@pytest.mark.parametrize(("attribute", "trace"), [("contexts", 1), ("interval", 2)])
def test_looking_at_rules_of_another_node_is_found_out(monkeypatch, taught_space, attribute, trace):
    """Meeting a rule of another node is traced, and so is reading it."""
    original = Affordances._rules_at

    def curious(self, key):
        for rule in original(self, "pickUp.graspObject"):
            getattr(rule, attribute)
        return original(self, key)

    monkeypatch.setattr(Affordances, "_rules_at", curious)

    _, wrong = check_situations(taught_space, 0, 0, 2)

    found, wanted = (eval(each)[-2:] for each in wrong[-1].split(", not "))  # noqa: S307
    assert [one == other for one, other in zip(found, wanted, strict=True)] == [trace == 1, False]


def test_random_teaching_finds_rules_out_that_hide_others(monkeypatch):
    """A few scenarios taught by sentence show that all but three rules of a node are lost."""
    experiment = RandomScenariosExperiment(objects=3, affordances=1, scenarios=8)
    hide_at_node(monkeypatch, lambda _, rules: rules[3:])

    results = [experiment.run(case) for case in experiment.cases()]

    assert not all(result.right for result in results)


def test_random_run_is_right_and_counts_what_it_did():
    """Every random scenario is taught, read back, and decided upon."""
    experiment = RandomScenariosExperiment(objects=2, affordances=2, scenarios=4, seed=1)

    results = [experiment.run(case) for case in experiment.cases()]

    assert [result.found for result in results] == ["0 wrong"] * 4
    told = sum(result.facts["told"] for result in results)
    assert experiment.summary(results) == {"sentences": told, "decisions": 20}
    assert experiment.files(results) == {}


@pytest.mark.parametrize("key", ["teaching", "situations", "growth"])
def test_checker_refuses_a_certificate_that_was_cut(certificate, checker, key):
    """The number of scenarios that were taught, traced and grown is pinned."""
    cut = certificate | {key: certificate[key][:-1]}

    assert any(checker["differences"](cut, checker["expected"](cut)))


def test_base_that_forgets_is_found_out(monkeypatch):
    """A base in which a rule takes the place of others of its node is no set of what was told."""
    believe = KnowledgeBase.believe

    def forgetful(self, text, predicate, speaker, rules, **more):
        told = list(rules)
        before = [rule.id for rule in self.rules_at_nodes([rule.node for rule in told])]
        return believe(self, text, predicate, speaker, told, **more | {"supersedes": before})

    monkeypatch.setattr(KnowledgeBase, "believe", forgetful)

    _, wrong = check_teaching(ScenarioSpace.from_paper(1, 1), 0, 0)

    assert "the beliefs are not the union of the beliefs from each sentence" in wrong


def test_choice_that_drops_ties_is_found_out(monkeypatch):
    """A program that hides what ties with the best is not right."""
    ranked = DecisionRule.ranked
    monkeypatch.setattr(
        DecisionRule,
        "ranked",
        lambda judge, found: Inference("", 0.0, ranked(judge, found).candidates),
    )

    facts, wrong = check_choices(ScenarioSpace.from_paper(2, 1), 2, 1)

    assert facts["ties"] == 0
    assert wrong == ["(2, 2) ranked (0, 0) gives 1"]


def test_choice_that_looks_at_scores_is_found_out(monkeypatch):
    """Scores cannot be added, rounded or hashed."""
    with pytest.raises(TypeError):
        OpaqueScore(1) + 1
    with pytest.raises(TypeError):
        round(OpaqueScore(1))
    with pytest.raises(TypeError, match="only be compared"):
        hash(OpaqueScore(1))
    with pytest.raises(TypeError, match="tolerance"):
        OpaqueScore(1) - 0.5


@given(st.integers(0, 20), st.integers(0, 20))
def test_opaque_scores_compare_like_their_levels(one, other):
    """Order, reversal, and a little less than a score is still more than the next one below."""
    assert (OpaqueScore(one) < OpaqueScore(other)) == (one < other)
    assert (-OpaqueScore(one) < -OpaqueScore(other)) == (other < one)
    assert (OpaqueScore(one) > OpaqueScore(other) - EPSILON) == (one >= other)


def test_trace_notes_what_is_read_of_a_rule():
    """Which cell a rule is about may be asked freely; how sure it is, is noted."""
    with KnowledgeBase.open("memory:") as base:
        base.believe("", "", "sam", [functional("mug", "containing", interval=Interval(0.5, 1))])
        traced = TracingSource(base)
        (rule,) = traced.rules_at_nodes(["findObject.containing"])
        assert (rule.object, rule.affordance, traced.read) == ("mug", "containing", set())
        assert traced.listed == {RuleKey("mug", "containing")}

        assert rule.support == Interval(0.5, 1)

    assert traced.read == {RuleKey("mug", "containing")}


def test_decision_reads_only_what_is_on_the_table():
    """Rules about what is not in the scene are met, since they are at the node, but not read."""
    rules = [functional(name, "cutting", interval=Interval(0.5, 1)) for name in ("knife", "spoon")]
    with TaughtAgent(rules) as taught:
        decided = taught.decide("pointTo", Target(used_for="cutting"), ["knife"])

    assert decided.read == {RuleKey("knife", "cutting")}
    assert decided.listed == {RuleKey("knife", "cutting"), RuleKey("spoon", "cutting")}


@pytest.mark.parametrize(
    ("code", "wanted"), [(0, 0.0), (1, 0.25), (8, 0.95), (9, 0.9625), (15, 0.9953125)]
)
def test_belief_of_a_code_is_what_its_levels_leave(code, wanted):
    """One minus the product of what each level leaves open."""
    assert belief(code) == wanted
