"""The judge of decisions and grasps, with a hand whose failures are known."""

from collections.abc import Iterator

import pytest

from hilt.agent.agent import Agent
from hilt.agent.evaluation.experiment import Case, CaseResult
from hilt.agent.evaluation.experiments.ground_truth import CorrectChoices, judge_command
from hilt.agent.evaluation.learning_scenarios import load_scenarios
from hilt.agent.execution.perception import PerfectVision
from hilt.ontology.objects import load_objects
from hilt.sim.manipulation.motion_report import MotionReport
from hilt.sim.scene.scene import scene_with
from hilt.sim.vision.percept import Percept

A = load_scenarios()[0]
SCENE = ["knife", "screwdriver", "spoon"]
CASE = Case("paper", "A/0/pass/cutting", {})


class Hand:
    """A hand that cannot take some things, and touches what it is told or something else."""

    abilities = frozenset({"graspObject", "moveTo", "handOver"})

    def __init__(self, refused: str = "", touched: str = "", lifted_m: float = 0.15) -> None:
        self.refused, self.touched, self.lifted_m = refused, touched, lifted_m

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Close on the part, unless it is one of the things that it cannot take."""
        self.last = (self.touched or part or "",)
        if percept.object == self.refused:
            return MotionReport("grasp", ok=False, reason="blocked")
        return MotionReport("grasp", ok=True, touched=self.last, attempts=1)

    def lift(self) -> MotionReport:
        """Lift it as high as this hand does."""
        return MotionReport(
            "lift", ok=True, touched=self.last, lifted_m=self.lifted_m, held_s=1.0, attempts=1
        )

    def hand_over(self) -> MotionReport:
        """Give it."""
        return MotionReport("hand_over", ok=True)

    def point_at(self, percept: Percept) -> MotionReport:
        """Not asked for."""
        raise NotImplementedError(percept.name)

    move_above = point_at

    def raise_(self) -> MotionReport:
        """Not asked for."""
        raise NotImplementedError

    lower = raise_


@pytest.fixture
def hand() -> Hand:
    """A hand that can do everything."""
    return Hand()


@pytest.fixture
def agent(hand: Hand) -> Iterator[Agent]:
    """An agent with that hand, which was taught Scenario A and sees three things."""
    objects = load_objects()
    eyes = PerfectVision(scene_with(SCENE, seed=0, objects=objects), objects)
    with Agent.open("memory:", vision=eyes, motion=hand) as taught:
        for sentence in A.sentences():
            taught.hear(sentence)
        yield taught


def passed(agent: Agent) -> CaseResult:
    """What "pass me something used for cutting" comes to."""
    reply = agent.hear("pass me something used for cutting")
    return judge_command(CASE, CorrectChoices.from_scenario(A, "pass", "cutting", SCENE), reply)


def test_right_thing_by_the_right_part_is_a_success(agent: Agent):
    """The knife by its blade, high enough and long enough."""
    result = passed(agent)

    assert result.right
    assert result.facts["success"] and result.facts["right_part"] and result.facts["decided"]


@pytest.mark.parametrize("hand", [Hand(touched="handle")], ids=["handle"])
def test_other_part_is_no_success(agent: Agent):
    """Told the blade, but on the handle: well decided, wrongly done."""
    result = passed(agent)

    assert (result.right, result.found) == (False, "knife by the blade, not carried out")
    assert (result.facts["decided"], result.facts["right_part"]) == (True, False)


@pytest.mark.parametrize("hand", [Hand(lifted_m=0.05)], ids=["5 cm"])
def test_thing_that_is_hardly_lifted_is_no_success(agent: Agent):
    """10 cm is the least."""
    assert passed(agent).facts["success"] is False


@pytest.mark.parametrize("hand", [Hand(refused="knife")], ids=["no knife"])
def test_next_best_thing_is_told_from_the_best(agent: Agent):
    """A robot that takes the screwdriver instead chose well, and did not succeed."""
    result = passed(agent)

    assert (result.right, result.found) == (False, "knife by the blade, not carried out")
    assert (result.facts["decided"], result.facts["taken"]) == (True, "screwdriver")
    assert (result.facts["right_part"], result.facts["success"]) == (True, False)


def test_grasp_by_name_is_judged_by_the_part(agent: Agent):
    """A thing asked for by its name has one right part."""
    reply = agent.hear("pass me the spoon")

    for part, right in (("bowl", True), ("handle", False)):
        truth = CorrectChoices(frozenset({"spoon"}), 0, {"spoon": frozenset({part})})
        assert judge_command(CASE, truth, reply).facts["success"] is right
