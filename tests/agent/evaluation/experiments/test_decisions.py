"""The paper's evaluation: what is asked, what is right, and that it is what the agent does."""

import json
from collections import Counter
from typing import cast

import pytest

from hilt.agent.cli import main
from hilt.agent.evaluation.experiment import (
    Case,
    CaseResult,
    TimedResult,
    make_experiment,
    to_json_line,
)
from hilt.agent.evaluation.experiments.decisions import PaperExperiment, SituationsExperiment
from hilt.agent.evaluation.experiments.ground_truth import CorrectChoices
from hilt.agent.evaluation.learning_scenarios import LEVELS, load_scenarios
from hilt.agent.evaluation.reports.report import EvaluationReport
from hilt.agent.evaluation.runners.runner import run_experiment

A, B = load_scenarios()
EVERY = 101  # a prime, so that a slice of the situations meets every action, affordance and size


def truth(case: Case) -> CorrectChoices:
    """What the table of its scenario allows for a case."""
    spec = cast("dict[str, str]", case.spec)
    scenario = {"A": A, "B": B}[spec["scenario"]]
    return CorrectChoices.from_scenario(scenario, spec["action"], spec["affordance"], spec["scene"])


def test_a_scenario_is_32_sentences():
    """16 say what is used for what, 16 by which part to grasp."""
    sentences = A.sentences()

    assert len(sentences) == len({*sentences}) == 32
    assert sentences[0] == "a mug is generally used for containing"
    assert "To pass a shoe generally grab the shoe by the sole" in sentences


def test_scenario_b_mirrors_the_columns():
    """What A ranks first B ranks last."""
    opposite = dict(zip(LEVELS, reversed(LEVELS), strict=True))

    for affordance, levels in A.affordances.items():
        assert B.affordances[affordance] == {opposite[k]: v for k, v in levels.items()}


@pytest.mark.parametrize(
    ("scenario", "affordance", "scene", "objects", "principle"),
    [
        (A, "cutting", ["knife", "spoon", "mug"], {"knife"}, 1),
        (A, "cutting", ["screwdriver", "spoon"], {"screwdriver"}, 2),
        (A, "cutting", ["spatula", "spoon"], {"spatula", "spoon"}, 3),
        (A, "cutting", ["mug", "shoe"], set[str](), 4),
        (B, "containing", ["mug", "shoe"], {"shoe"}, 1),
        (B, "containing", ["mug", "glass"], {"mug", "glass"}, 3),
    ],
)
def test_truth_is_read_off_the_table(
    scenario: str, affordance: str, scene: list[str], objects: set[str], principle: int
):
    """The best object of the scene, and which of the four principles says so."""
    found = CorrectChoices.from_scenario(scenario, "pointTo", affordance, scene)

    assert (found.objects, found.principle) == (objects, principle)


def test_truth_allows_only_the_part_for_the_action():
    """A knife is right by its blade when it is passed, and by its handle when it is picked up."""
    passed = CorrectChoices.from_scenario(A, "pass", "cutting", ["knife"])
    picked = CorrectChoices.from_scenario(A, "pickUp", "cutting", ["knife"])

    assert passed.allows("knife", "blade") and not passed.allows("knife", "handle")
    assert picked.allows("knife", "handle") and not picked.allows("knife", None)
    assert not passed.allows(None, None)


def test_paper_run_has_ten_scenes_of_every_size_and_asks_for_all_principles():
    """2 scenarios x 10 scenes x 15 commands; the first scene has all objects, no two are alike."""
    experiment = PaperExperiment(seed=3)
    scenes, cases = experiment.drawn_scenes(), experiment.cases()

    assert len(cases) == len({case.key for case in cases}) == 300
    assert len(scenes[0]) == 8 and len({tuple(scene) for scene in scenes}) == 10
    assert {len(scene) for scene in scenes} == {1, 2, 3, 4, 5, 6, 7, 8}
    assert {truth(case).principle for case in cases} == {1, 2, 3, 4}


def test_situations_are_as_many_as_the_paper_counts():
    """6,144 have one right answer, 480 several, 1,056 none: by the tables alone."""
    cases = SituationsExperiment().cases()

    assert len({case.key for case in cases}) == 7680
    assert Counter(truth(case).kind for case in cases) == {"unique": 6144, "tie": 480, "none": 1056}


def test_paper_run_is_right():
    """Taught by sentence and asked by sentence, the agent decides as the tables say."""
    experiment = PaperExperiment(scenes=4)

    report = EvaluationReport("paper", experiment.options, run_experiment(experiment)).as_json()

    assert (report["runs"], report["right"], report["wrong"]) == (120, 120, [])
    assert set(cast("dict[str, object]", report["by_principle"])) == {"1", "2", "3", "4"}


def test_slice_of_the_situations_is_right():
    """Every 101st of all 7,680, each through parser, base and inference."""
    experiment = SituationsExperiment()

    done = run_experiment(experiment, experiment.cases()[::EVERY])

    assert [each.result.key for each in done if not each.result.right] == []
    assert {each.result.kind for each in done} == {"unique", "tie", "none"}


def test_agent_that_was_taught_otherwise_is_wrong(monkeypatch: pytest.MonkeyPatch):
    """The judge does not agree with whatever is decided: taught A, the agent fails B."""
    sentences = A.sentences()
    monkeypatch.setattr(type(A), "sentences", lambda self: sentences)
    experiment = PaperExperiment(scenes=1)

    wrong = [each.result.key for each in run_experiment(experiment) if not each.result.right]

    assert wrong
    assert {key[0] for key in wrong} == {"B"}


def test_results_survive_json():
    """A case and a result come back from their own lines."""
    case = PaperExperiment(scenes=1).cases()[0]
    result = CaseResult(case.key, True, "tie", 3, "mug", "glass or mug", {"ties": ["mug", "glass"]})

    timed = TimedResult(result, 0.5, attempts=2)

    assert Case(**json.loads(to_json_line(case))) == case
    assert TimedResult.from_json(json.loads(to_json_line(timed))) == timed


def test_report_tells_decisions_from_what_the_hand_did():
    """A slipped thing is a failure of the run, not of the principle by which it was chosen."""
    slipped = {"decided": True, "success": False, "right_part": True}
    result = CaseResult("A/0/pass/cutting", False, "unique", 1, "knife", "knife", slipped)

    counted = EvaluationReport("paper", {"seed": 7}, (TimedResult(result, 2.0),)).as_json()

    assert counted["by_principle"] == {"1": {"runs": 1, "right": 1}}
    assert (counted["right"], counted["executed"], counted["succeeded"]) == (0, 1, 0)
    assert (counted["grasps"], counted["right_part"], counted["seed"]) == (1, 1, 7)


def test_command_prints_one_document(capfd: pytest.CaptureFixture[str]):
    """`hilt evaluate paper --json` ends with 0 and prints what scripts rely on."""
    with pytest.raises(SystemExit) as ended:
        main(["evaluate", "paper", "--scenes", "1", "--json"])
    (line,) = capfd.readouterr().out.splitlines()
    document = json.loads(line)

    assert ended.value.code == 0
    assert document.keys() >= {"runs", "right", "by_principle", "unique", "ties", "none", "grasps"}
    assert (document["runs"], document["right"]) == (30, 30)


@pytest.mark.sim
def test_robot_does_what_it_decided():
    """Three commands of the paper's run, carried out: the right thing, by the right part."""
    experiment = make_experiment("paper", {"sim": True, "seed": 2})
    cases = [c for c in experiment.cases() if c.key in {"A/7/pass/cutting", "A/7/pointTo/cutting"}]

    for each in run_experiment(experiment, cases):
        assert each.result.right, each.result


@pytest.mark.sim
def test_grasp_is_judged_by_the_world():
    """A rule taught by sentence, the fingers on that part, lifted and held."""
    experiment = make_experiment("grasps", {"poses": 1, "seed": 3})
    (case,) = [case for case in experiment.cases() if case.key == "spoon/pass/3"]

    (done,) = run_experiment(experiment, [case])

    assert done.result.right
    assert done.result.facts["touched"] == ["bowl"]
