"""Section 4.2 through sentences: tools chosen by what they afford, and what comes next.

The hands are scripted: they say which thing cannot be had and why, so that each way in which a walk
can go on is met without a simulator.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import FrozenInstanceError
from itertools import chain, repeat
from pathlib import Path

import numpy as np
import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.dialogue.reply import Reply
from hilt.agent.execution.action_tree_executor import FoundObject
from hilt.inference.affordance import Affordances
from hilt.inference.settings import Settings
from hilt.inference.taxonomy import Taxonomy
from hilt.inference.types import Candidate
from hilt.kb.interval import Interval
from hilt.kb.rule import Atom, Rule
from hilt.sim.manipulation.motion_report import MotionReport
from hilt.sim.vision.percept import Percept

POUND = "pound the nail"
POINT = np.zeros((1, 3))
PARTS = ("blade", "handle")


class Eyes:
    """Sees things of these kinds, each with a confidence."""

    def __init__(self, **things: float) -> None:
        self.things = {name.replace("_", " "): sure for name, sure in things.items()}
        self.asked: list[list[str]] = []

    def search(self, features: Sequence[str]) -> list[Percept]:
        """The things that show one of the features."""
        self.asked.append([*features])
        wanted = {feature.partition(":")[2] for feature in features}
        return [
            Percept(name=name, object=name, confidence=sure, parts={})
            for name, sure in self.things.items()
            if name in wanted
        ]


class OneThing:
    """Sees this one thing, whatever is looked for."""

    def __init__(self, seen: Percept) -> None:
        self.seen = seen

    def search(self, features: Sequence[str]) -> list[Percept]:
        """The one thing."""
        return [self.seen]


class Labelled:
    """Sees a mug and a glass, of which one has a property."""

    def __init__(self, **having: str) -> None:
        self.having = having

    def search(self, features: Sequence[str]) -> list[Percept]:
        """Those that are named, or have a property that is."""
        wanted = {feature.partition(":")[2] for feature in features}
        wanted |= {name for prop, name in self.having.items() if prop in wanted}
        return [Percept(each, each, 1.0, {}) for each in ("mug", "glass") if each in wanted]


class Fleeting:
    """Sees these things at first, and those from then on."""

    def __init__(self, first: Sequence[Percept], then: Sequence[Percept]) -> None:
        self._views = chain([first], repeat(then))

    def search(self, features: Sequence[str]) -> Sequence[Percept]:
        """What is there now."""
        return next(self._views)


class Arm:
    """Does as it is told, but for the things that it cannot do it with.

    Attributes:
        fails: (action, thing held or meant) -> how often, and why.
        done: what it did, in order.
        parts: by which parts it took hold.
    """

    abilities = frozenset(
        {"graspObject", "moveTo", "handOver", "pointAt", "moveAbove", "raise", "lower", "shake"}
    )

    def __init__(self, fails: Mapping[tuple[str, str], str], *, drives: bool = True) -> None:
        self.fails = dict(fails)
        self.drives = drives
        self.done: list[str] = []
        self.held = ""
        self.parts: list[str | None] = []

    def _report(self, action: str, thing: str, **facts: bool) -> MotionReport:
        reason = self.fails.get((action, thing), "")
        once = reason.removesuffix("!")
        if reason.endswith("!"):
            del self.fails[action, thing]
        self.done.append(f"{action} {thing}".strip())
        return MotionReport(action, ok=not reason, reason=once, **facts)

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Take a thing."""
        self.held = percept.name
        self.parts.append(part)
        return self._report("grasp", percept.name)

    def lift(self) -> MotionReport:
        """Lift it."""
        return self._report("lift", self.held)

    def hand_over(self) -> MotionReport:
        """Hand it over."""
        return self._report("hand over", self.held)

    def point_at(self, percept: Percept) -> MotionReport:
        """Point."""
        return self._report("point", percept.name)

    def move_above(self, percept: Percept) -> MotionReport:
        """Bring what is held above a thing."""
        return self._report("above", percept.name)

    def raise_(self) -> MotionReport:
        """Raise."""
        return self._report("raise", self.held)

    def lower(self) -> MotionReport:
        """Strike."""
        return self._report("lower", self.held, driven=self.drives)

    def perform(
        self, action: str, arguments: Mapping[str, Percept | str], constraint: Candidate | None
    ) -> MotionReport:
        """Do something of its own."""
        names = [each.name if isinstance(each, Percept) else each for each in arguments.values()]
        bound = f" ({constraint.argument})" if constraint else ""
        return self._report(action, " ".join(names) + bound)


@contextmanager
def robot(
    arm: Arm | None = None, actions: Path | None = None, **things: float
) -> Iterator[tuple[Agent, Arm]]:
    """An agent with scripted hands that sees these things."""
    arm = arm or Arm({})
    with Agent.open(
        "memory:", AgentConfig(actions=actions), vision=Eyes(**things), motion=arm
    ) as agent:
        for lesson in (
            "A hammer is used for pounding",
            "A shoe is sometimes used for pounding",
            "A spoon is never used for pounding",
        ):
            agent.hear(lesson)
        yield agent, arm


def tool(reply: Reply) -> str | None:
    """What the command was carried out with."""
    assert reply.result is not None and reply.result.decision is not None
    best = reply.result.decision.object.best
    return best.object if best else None


# --- Which tool ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("things", "said"),
    [
        ({"hammer": 1.0, "shoe": 1.0}, "I pounded the nail with the hammer."),
        ({"shoe": 1.0}, "I pounded the nail with the shoe."),
        (
            {},
            "I don't see anything for pounding nails. "
            "I know of a hammer and a shoe, but I don't see any here.",
        ),
        (
            {"shoe": 0.2},
            "I'm not sure enough that a shoe is used for pounding nails. Should I take it?",
        ),
    ],
    ids=["the best", "the next best when it is absent", "tool absent", "not sure enough"],
)
def test_tool_nobody_named_is_chosen_by_what_it_affords(things: dict[str, float], said: str):
    """Section 4.2: the argument review looks for something used for pounding."""
    with robot(nail=1.0, **things) as (agent, _):
        assert agent.hear(POUND).said == said


def test_tool_that_is_named_is_used_whatever_it_affords():
    """Who says which tool has decided."""
    with robot(nail=1.0, hammer=1.0, spoon=1.0) as (agent, arm):
        reply = agent.hear("pound the nail with the spoon")

    assert reply.said == "I pounded the nail with the spoon."
    assert arm.done[:2] == ["grasp spoon", "lift spoon"]


def test_tool_that_is_named_and_absent_is_not_replaced():
    """The hammer was meant; a shoe is no hammer."""
    with robot(nail=1.0, shoe=1.0) as (agent, arm):
        reply = agent.hear("pound the nail with the hammer")

    assert (reply.said, arm.done) == ("I don't see a hammer.", [])


def test_what_is_known_not_to_do_is_told_from_what_is_not_known():
    """To believe not is not the same as not to know, nor as not to see."""
    said: list[str] = []
    for lesson in ("A spoon is never used for rolling", "A mug is used for rolling", "hello"):
        with robot(nail=1.0, spoon=1.0) as (agent, _):
            agent.hear(lesson)
            said.append(agent.hear("pass me something used for rolling").said)

    assert said == [
        "I don't see anything for rolling. I was told that a spoon won't do.",
        "I don't see anything for rolling. I know of a mug, but I don't see any here.",
        "I don't see anything for rolling. What is used for rolling?",
    ]


def test_yes_settles_a_tool_that_was_not_sure_enough():
    """Asked and confirmed, the shoe is used."""
    with robot(nail=1.0, shoe=0.2) as (agent, _):
        asked = agent.hear(POUND)
        done = agent.hear("yes")

    assert (asked.ending, done.said) == ("asked", "I pounded the nail with the shoe.")


# --- What comes next -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("failure", "excuse"),
    [
        (("grasp", "hammer", "unreachable"), "I can't reach the handle of the hammer."),
        (("grasp", "hammer", "too_wide"), "The handle of the hammer is too wide for my hand."),
        (("raise", "hammer", "unreachable"), "I can't strike the nail with the hammer the way"),
    ],
)
def test_next_best_tool_is_taken_when_the_best_cannot_be(
    failure: tuple[str, str, str], excuse: str
):
    """It says why, and what it did instead; both are among the candidates."""
    action, thing, reason = failure
    with robot(Arm({(action, thing): reason}), nail=1.0, hammer=1.0, shoe=1.0) as (agent, arm):
        reply = agent.hear(POUND)

    assert reply.said.startswith(excuse)
    assert reply.said.endswith("I pounded the nail with the shoe.")
    assert arm.done[-1] == "lower shoe"
    document = reply.as_do_json()["decision"]
    assert [(each["object"], each["accepted"]) for each in document["candidates"]] == [
        ("shoe", True),
        ("hammer", False),
    ]
    assert (
        document["candidates"][1]["reason"]
        == f"it was tried first, but: {reason.replace('_', ' ')}"
    )


def test_next_best_that_is_not_sure_enough_is_asked_about():
    """The hammer cannot be had, and the shoe is hardly seen."""
    arm = Arm({("grasp", "hammer"): "unreachable"})
    with robot(arm, nail=1.0, hammer=1.0, shoe=0.2) as (agent, _):
        asked = agent.hear(POUND)
        done = agent.hear("yes")

    assert asked.said.startswith("I can't reach the handle of the hammer. I'm not sure enough")
    assert (asked.ending, tool(done)) == ("asked", "shoe")


def test_last_failure_is_told_when_nothing_is_left():
    """Neither can be reached."""
    arm = Arm({("grasp", "hammer"): "unreachable", ("grasp", "shoe"): "blocked"})
    with robot(arm, nail=1.0, hammer=1.0, shoe=1.0) as (agent, _):
        reply = agent.hear(POUND)

    assert reply.ending == "failed"
    assert reply.said.startswith(
        "I can't reach the handle of the hammer. I can't get my fingers around"
    )


def test_what_is_known_not_to_do_is_never_the_next_best():
    """A spoon is never used for pounding, and stays on the table."""
    arm = Arm({("grasp", "hammer"): "unreachable"})
    with robot(arm, nail=1.0, hammer=1.0, spoon=1.0) as (agent, _):
        reply = agent.hear(POUND)

    assert (reply.ending, arm.done) == ("failed", ["grasp hammer"])


def test_nothing_is_picked_up_for_a_nail_that_is_not_there():
    """What a tree requires is asked for before its first step."""
    with robot(hammer=1.0) as (agent, arm):
        reply = agent.hear(POUND)

    assert (reply.said, arm.done) == ("I don't see a nail.", [])


def test_pounding_ends_when_the_nail_does_not_go_in():
    """Every blow of the loop is tried, with each tool that is sure enough."""
    arm = Arm({}, drives=False)
    with robot(arm, nail=1.0, hammer=1.0) as (agent, _):
        reply = agent.hear(POUND)

    assert reply.said == "I pounded the nail with the hammer, but it didn't go in."
    assert arm.done.count("lower hammer") == 12


# --- Actions of one's own ------------------------------------------------------------------

OWN = """
primitives:
  shake: [object]
failures: [spilled]
trees:
  season:
    parameters: [patient, tool]
    defaults: {tool: {usedFor: seasoning}}
    requires: [{sees: patient}]
    steps:
      - pickUp: tool
      - shake: tool
    otherwise:
      - {after: [spilled], again: 2}
      - {after: any, steps: [{handOver: tool}]}
"""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """A file with an action of one's own."""
    path = tmp_path / "own.yaml"
    path.write_text(OWN, encoding="utf-8")
    return path


def test_action_of_ones_own_is_asked_for_by_its_name(own: Path):
    """The verb, the tool it needs and the robot's own primitive all come from the file."""
    with robot(actions=own, glass=1.0, mug=1.0) as (agent, arm):
        agent.hear("A glass is used for seasoning")
        reply = agent.hear("season the mug")

    assert reply.said == "I seasoned the mug with the glass."
    assert arm.done == ["grasp glass", "lift glass", "shake glass"]


@pytest.mark.parametrize(
    ("reason", "shaken", "ending"), [("spilled!", 2, "done"), ("slipped!", 1, "failed")]
)
def test_branches_mend_what_failed(own: Path, reason: str, shaken: int, ending: str):
    """Spilling is tried again; anything else ends in putting it down, and is told."""
    arm = Arm({("shake", "glass"): reason})
    with robot(arm, own, glass=1.0, mug=1.0) as (agent, _):
        agent.hear("A glass is used for seasoning")
        reply = agent.hear("season the mug")

    assert (arm.done.count("shake glass"), reply.ending) == (shaken, ending)
    assert ("hand over glass" in arm.done) == (reason == "slipped!")


def test_command_whose_tries_all_failed_is_not_claimed_to_be_done(own: Path):
    """A failure of one's own is said by its name, once, and other steps are not what was asked."""
    arm = Arm({("shake", "glass"): "spilled"})
    with robot(arm, own, glass=1.0, mug=1.0) as (agent, _):
        agent.hear("A glass is used for seasoning")
        reply = agent.hear("season the mug")

    assert arm.done.count("shake glass") == 3
    assert arm.done[-1] == "hand over glass"
    assert reply.ending == "failed"
    assert reply.said == "It did not work with the glass: spilled. I did something else instead."


def test_failure_is_the_answer_where_there_is_no_robot_for_other_steps(own: Path):
    """Without a tool and without a robot nothing else is done instead."""
    with Agent.open("memory:", AgentConfig(simulate=False, actions=own)) as agent:
        reply = agent.hear("season the mug")

    assert (reply.ending, reply.said) == (
        "failed",
        "I don't see anything for seasoning mugs. What is used for seasoning?",
    )


NESTED = """
  spice:
    parameters: [patient, tool]
    defaults: {tool: {usedFor: seasoning}}
    steps:
      - season: {patient: patient, tool: tool}
      - pointAt: tool
"""


def test_tree_goes_on_after_other_steps_of_a_tree_in_it(own: Path):
    """Only a command itself fails with its tree; one in another tree is mended."""
    own.write_text(OWN + NESTED, encoding="utf-8")
    arm = Arm({("shake", "glass"): "slipped"})
    with robot(arm, own, glass=1.0, mug=1.0) as (agent, _):
        agent.hear("A glass is used for seasoning")
        reply = agent.hear("spice the mug")

    assert (reply.ending, arm.done[-2:]) == ("done", ["hand over glass", "point glass"])


@pytest.mark.parametrize(
    ("reason", "tries", "ending"), [("missed!", 2, "done"), ("slipped!", 1, "failed")]
)
def test_taught_action_ends_where_it_was_told_to_stop(reason: str, tries: int, ending: str):
    """To stop if it slips goes before what is done about any failure."""
    arm = Arm({("grasp", "mug"): reason})
    with robot(arm, mug=1.0) as (agent, _):
        agent.hear("To inspect a mug, pick it up. If it slips, stop. If that fails, try again.")
        reply = agent.hear("inspect the mug")

    assert (arm.done.count("grasp mug"), reply.ending) == (tries, ending)


def test_event_that_was_never_sensed_is_said(own: Path):
    """A loop that ends without its event has failed, and says which event it waited for."""
    steps = "      - repeat: 2\n        until: mixed\n        steps: [{shake: tool}]\n"
    own.write_text(OWN.replace("      - shake: tool\n", steps), encoding="utf-8")
    with robot(actions=own, glass=1.0, mug=1.0) as (agent, arm):
        agent.hear("A glass is used for seasoning")
        reply = agent.hear("season the mug")

    assert (arm.done.count("shake glass"), reply.ending) == (2, "failed")
    assert reply.said.startswith("It did not work with the glass: not mixed.")


HOLDING = """
trees:
  polish:
    parameters: [object]
    requires: [{holds: object}]
    steps: [{pointAt: object}]
"""


def test_object_that_must_be_held_and_is_not_is_said(own: Path):
    """A precondition that does not hold ends the goal before its first step."""
    own.write_text(HOLDING, encoding="utf-8")
    with robot(actions=own, glass=1.0) as (agent, arm):
        reply = agent.hear("polish the glass")

    assert (reply.said, arm.done) == ("I'm not holding the glass.", [])


HELD_FIRST = """
trees:
  polish:
    parameters: [object]
    requires: [{holds: object}]
    steps: [{pointAt: object}]
  shine:
    parameters: [object]
    steps: [{pickUp: object}, {polish: object}]
"""


def test_object_that_must_be_held_and_is_held_will_do(own: Path):
    """The object that was picked up before is in the hand."""
    own.write_text(HELD_FIRST, encoding="utf-8")
    with robot(actions=own, glass=1.0) as (agent, arm):
        reply = agent.hear("shine the glass")

    assert (reply.ending, arm.done) == ("done", ["grasp glass", "lift glass", "point glass"])


def test_rule_of_any_functor_binds_a_primitive_of_ones_own(own: Path, tmp_path: Path):
    """What a rule concludes at a node reaches the hands as their constraint."""
    gently = Rule(
        frozenset({Atom("object", "glass")}), frozenset({Atom("action", "season")}), "shake",
        Atom("property", "gentle"), Interval(0.9, 1),
    )  # fmt: skip
    with robot(actions=own, glass=1.0, mug=1.0) as (agent, arm):
        agent.base.believe("Shake glasses gently", "", "sam", [gently])
        agent.hear("A glass is used for seasoning")
        reply = agent.hear("season the mug")

    assert arm.done[-1] == "shake glass (property:gentle)"
    steps = {step["node"]: step for step in reply.as_do_json()["steps"]}
    assert steps["season/shake"]["constraint"]["argument"] == "property:gentle"


# --- By which part -------------------------------------------------------------------------


@pytest.mark.parametrize("threshold", [0.005, 0.5])
def test_guess_about_a_part_is_asked_about_first(threshold: float):
    """What follows by likeness alone is asked about before its first use, and "yes" settles it."""
    config = AgentConfig(simulate=False, induce=True, settings=Settings(threshold=threshold))
    with Agent.open("memory:", config) as agent:
        agent.hear("To pass a knife grab it by the blade")
        asked = agent.hear("pass me the screwdriver")
        done = agent.hear("yes")

    assert asked.said == (
        "Nobody has told me how to pass a screwdriver, but I know something similar. By the shaft?"
    )
    assert (asked.ending, done.said) == ("asked", "I would pass the screwdriver by the shaft.")


def test_guess_about_a_part_is_not_asked_about_where_another_one_is_obliged():
    """What must be done needs no guess."""
    with Agent.open("memory:", AgentConfig(simulate=False, induce=True)) as agent:
        agent.hear("To pass a knife grab it by the blade")
        agent.hear("Only pass the screwdriver by the handle")
        done = agent.hear("pass me the screwdriver")

    assert done.said == "I would pass the screwdriver by the handle."


@pytest.mark.parametrize("threshold", [0.005, 0.5])
def test_guess_about_a_use_is_said_to_be_one_and_asked_about(threshold: float):
    """Nobody said that a glass is used for containing: Hilt says so before it acts."""
    config = AgentConfig(
        simulate=False,
        induce=True,
        scene="objects:glass,shoe",
        settings=Settings(threshold=threshold),
    )
    with Agent.open("memory:", config) as agent:
        agent.hear("A mug is used for containing")
        asked = agent.hear("pass me something used for containing")
        done = agent.hear("yes")
        other = agent.hear("pass me something used for containing")
        named = agent.hear("the shoe")

    assert asked.said == (
        "I have not been told that a glass is used for containing, but I know something similar. "
        "Should I take it?"
    )
    assert (asked.ending, done.said) == ("asked", "I would pass the glass.")
    assert (other.ending, named.said) == ("asked", "I would pass the shoe.")


@pytest.mark.parametrize(
    ("lessons", "part"),
    [
        (["To pass a knife, never grab it by the blade"], "handle"),
        (["To pass a knife, never grab it by the handle"], "blade"),
        (["Never grab a knife by the blade"], "handle"),
        (["Never grab anything by the blade"], "handle"),
        (["To pass anything grab it by the handle"], "handle"),
        (
            ["To pass anything grab it by the handle", "To pass a knife grab it by the blade"],
            "blade",
        ),
    ],
)
def test_part_that_is_forbidden_is_avoided_and_another_one_named(lessons: list[str], part: str):
    """The plan without a robot names the part, and a robot takes hold of it."""
    seen = Percept("knife", "knife", 1.0, dict.fromkeys(PARTS, POINT))
    arm = Arm({})
    with (
        Agent.open("memory:", AgentConfig(simulate=False)) as planner,
        Agent.open("memory:", vision=OneThing(seen), motion=arm) as robot_,
    ):
        for lesson in lessons:
            assert planner.hear(lesson).is_done
            robot_.hear(lesson)
        planned = planner.hear("pass me the knife")
        done = robot_.hear("pass me the knife")

    assert planned.said == f"I would pass the knife by the {part}."
    assert planned.as_do_json()["decision"]["part"] == part
    assert planned.as_do_json()["decision"]["rules"]
    assert (done.ending, arm.parts) == ("done", [part])


def test_part_made_for_holding_is_taken_first_where_others_are_forbidden():
    """Of the parts that are left, the stem of a glass is made for a hand."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        agent.hear("Never grab a glass by the handle")
        reply = agent.hear("pass me the glass")

    assert reply.said == "I would pass the glass by the stem."


def test_object_that_may_not_be_held_by_any_part_is_left():
    """With both parts forbidden nothing is done."""
    seen = Percept("knife", "knife", 1.0, dict.fromkeys(PARTS, POINT))
    arm = Arm({})
    with Agent.open("memory:", vision=OneThing(seen), motion=arm) as agent:
        for part in PARTS:
            agent.hear(f"Never grab a knife by the {part}")
        reply = agent.hear("pass me the knife")

    assert (reply.ending, arm.done) == ("failed", [])
    assert reply.said == "I know no part of the knife that I may hold it by."


def test_part_of_a_kind_is_the_part_that_the_thing_has():
    """What was told of blades holds for the serrated blade of a bread knife."""
    blade, serrated = Atom("part", "blade"), Atom("part", "serrated blade")
    seen = Percept("bread knife", "knife", 1.0, {"serrated blade": POINT})
    arm = Arm({})
    with Agent.open("memory:", vision=Eyes(), motion=arm) as agent:
        agent.affordances = Affordances(agent.base, taxonomy=Taxonomy([(serrated, blade)]))
        agent.goals.vision = OneThing(seen)
        agent.hear("To pass a knife grab it by the blade")
        reply = agent.hear("pass me the knife")

    assert (reply.ending, arm.parts) == ("done", ["serrated blade"])


# --- What is recorded ----------------------------------------------------------------------


def steps(reply: Reply) -> dict[str, str]:
    """What became of each node."""
    assert reply.result is not None
    return {step.node: step.action for step in reply.result.steps}


def test_steps_say_what_became_of_them():
    """Trees are walked, primitives executed; a failure stands at all nodes that it ends."""
    with robot(nail=1.0, hammer=1.0) as (agent, _):
        done = agent.hear(POUND)
        acts = list(agent.goals.done)
    with robot(Arm({("grasp", "hammer"): "slipped"}), nail=1.0, hammer=1.0) as (agent, _):
        slipped = agent.hear(POUND)
        began = list(agent.goals.done)

    assert set(steps(done).values()) == {"walked", "executed"}
    assert steps(done)["pound/pickUp"] == "walked"
    assert steps(done)["pound/lower"] == "executed"
    assert {key for key, value in steps(slipped).items() if value == "slipped"} == {
        "pound", "pound/pickUp", "pound/pickUp/graspObject",
    }  # fmt: skip
    assert acts[:3] == [("graspObject", "hammer"), ("moveTo", "hammer"), ("pickUp", "hammer")]
    assert ("findObject", "hammer") not in acts
    assert began == []


def test_without_a_robot_things_are_found_and_not_taken():
    """The steps of a plan say so, though none failed."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        planned = steps(agent.hear("pass me the hammer"))

    assert planned["pass/findObject"] == "executed"
    assert planned["pass/graspObject"] == planned["pass/handOver"] == "not executed"


def test_without_a_robot_a_loop_is_gone_through_once():
    """One pass shows what would be done."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        agent.hear("A hammer is used for pounding")
        result = agent.hear(POUND).result

    assert result is not None
    nodes = [step.node for step in result.steps]
    assert len(nodes) == len(set(nodes))


@pytest.mark.parametrize(("empty", "ending"), [("mug", "done"), ("glass", "asked")])
def test_property_that_an_action_needs_must_be_seen_on_its_object(empty: str, ending: str):
    """That something else is empty says nothing of the mug."""
    arm = Arm({})
    with Agent.open("memory:", vision=Labelled(empty=empty), motion=arm) as agent:
        agent.hear("To dry a mug, pick it up, only if it is empty.")
        reply = agent.hear("dry the mug")

    assert (reply.ending, arm.done) == (ending, ["grasp mug", "lift mug"] * (ending == "done"))


def test_result_has_the_grasps_and_what_the_world_came_to():
    """A grasp that slipped is one trial; without a robot there is neither."""
    with robot(Arm({("grasp", "hammer"): "slipped"}), nail=1.0, hammer=1.0) as (agent, _):
        dropped = agent.hear(POUND).result
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        planned = agent.hear("pass me the hammer").result

    assert dropped is not None and planned is not None
    assert [trial.outcome for trial in dropped.trials] == ["slipped"]
    assert dropped.world.executed
    assert (planned.trials, planned.world.executed) == ((), False)


@pytest.mark.parametrize(("detection", "upper"), [("open", 1.0), ("point", 0.5)])
def test_confidence_of_a_detection_is_a_bound_or_a_point(detection: str, upper: float):
    """By the setting, what is seen with .5 is [.5, 1] or [.5, .5]."""
    settings = Settings(detection=detection)
    config = AgentConfig(settings=settings)
    with Agent.open("memory:", config, vision=Eyes(mug=0.5), motion=Arm({})) as agent:
        agent.hear("A mug is used for containing")
        result = agent.hear("pass me something used for containing").result

    assert result is not None and result.decision is not None
    [mug] = result.decision.object.candidates
    assert mug.proof.leaves[0].interval == Interval(0.5, upper)


# --- What is looked for --------------------------------------------------------------------


def test_nothing_is_looked_for_where_the_command_itself_is_forbidden():
    """What the command names is enough to refuse it."""
    eyes = Eyes(mug=1.0)
    with Agent.open("memory:", vision=eyes, motion=Arm({})) as agent:
        agent.hear("Never pick up the mug")
        eyes.asked.clear()
        reply = agent.hear("pick up the mug")

    assert (reply.ending, eyes.asked) == ("refused", [])


def test_only_what_was_found_is_looked_for_from_then_on():
    """To grasp a hammer, what was told of shoes does not matter; for nothing there is no search."""
    eyes = Eyes(nail=1.0, hammer=1.0, shoe=1.0)
    with Agent.open("memory:", vision=eyes, motion=Arm({})) as agent:
        for name, part in (("hammer", "handle"), ("shoe", "sole")):
            agent.hear(f"A {name} is used for pounding")
            agent.hear(f"To pick up a {name} grab it by the {part}")
        result = agent.hear(POUND).result

    assert result is not None
    features = {step.node: step.features for step in result.steps}
    assert features["pound/pickUp/findObject"] == ("object:hammer", "object:shoe")
    assert features["pound/pickUp/graspObject"] == ("object:hammer",)
    assert [] not in eyes.asked


@pytest.mark.parametrize(("is_gone", "looked_at"), [(False, ["knife"]), (True, [])])
def test_another_thing_of_the_kind_does_not_stand_for_the_one_that_was_found(
    is_gone: bool, looked_at: list[str]
):
    """Once a knife was found, only that one is looked at, and none if it is gone."""
    names = ("knife", "knife 2")
    knives = [Percept(each, "knife", 1.0, dict.fromkeys(PARTS, POINT)) for each in names]
    eyes = Fleeting(knives, knives[1:] if is_gone else knives)
    with Agent.open("memory:", vision=eyes, motion=Arm({})) as agent:
        agent.hear("To pass a knife grab it by the blade")
        result = agent.hear("pass me the knife").result

    assert result is not None
    [grasped] = [step for step in result.steps if step.node == "pass/graspObject"]
    assert [*grasped.percepts] == looked_at


def test_object_that_is_forbidden_is_not_even_grasped_in_thought():
    """Where all that would do is forbidden, the walk ends where it is looked for."""
    with robot(hammer=1.0) as (agent, _):
        agent.hear("Never pass the hammer")
        reply = agent.hear("pass me something used for pounding")

    assert reply.ending == "refused"
    assert list(steps(reply)) == ["pass", "pass/findObject"]


def test_part_that_was_named_is_not_replaced_by_the_one_that_is_obliged():
    """Who asks for the blade is told that it must be the handle."""
    seen = Percept("knife", "knife", 1.0, dict.fromkeys(PARTS, POINT))
    arm = Arm({})
    with Agent.open("memory:", vision=OneThing(seen), motion=arm) as agent:
        agent.hear("You must pass a knife only by the handle")
        named = agent.hear("pass me the knife by the blade")
        free = agent.hear("pass me the knife")

    assert (named.ending, free.ending, arm.parts) == ("refused", "done", ["handle"])


@pytest.mark.parametrize(("part", "ending"), [("handle", "done"), ("rim", "asked")])
def test_part_that_is_obliged_settles_what_was_not_sure(part: str, ending: str):
    """It is not asked about, unless the thing lacks it."""
    seen = Percept("knife", "knife", 0.6, dict.fromkeys(PARTS, POINT))
    arm = Arm({})
    with Agent.open("memory:", vision=OneThing(seen), motion=arm) as agent:
        agent.hear("To pass a knife, occasionally grab it by the blade")
        agent.hear(f"Only pass the knife by the {part}")
        reply = agent.hear("pass me the knife")

    assert (reply.ending, arm.parts) == (ending, ["handle"] * (ending == "done"))


def test_nothing_else_is_done_instead_of_what_is_forbidden(own: Path):
    """What is done about any failure is not done about that."""
    with robot(actions=own, glass=1.0, mug=1.0) as (agent, arm):
        agent.hear("A glass is used for seasoning")
        agent.hear("Never pick up the glass")
        reply = agent.hear("season the mug")

    assert (reply.ending, arm.done) == ("refused", [])


POINTED = """
  spice:
    parameters: [patient]
    steps:
      - season: {patient: patient}
  adorn:
    parameters: [patient, tool]
    defaults: {tool: {usedFor: seasoning}}
    steps:
      - pickUp: tool
      - pointTo: patient
"""


def test_tree_in_a_tree_has_its_own_defaults(own: Path):
    """The tool that the outer one does not name is looked for by the inner one."""
    own.write_text(OWN + POINTED, encoding="utf-8")
    with robot(actions=own, glass=1.0, mug=1.0) as (agent, arm):
        agent.hear("A glass is used for seasoning")
        agent.hear("spice the mug")

    assert arm.done == ["grasp glass", "lift glass", "shake glass"]


def test_decision_is_about_the_tool_though_its_patient_is_looked_for_later(own: Path):
    """What is pointed to with it was named."""
    own.write_text(OWN + POINTED, encoding="utf-8")
    with robot(actions=own, glass=1.0, mug=1.0) as (agent, arm):
        agent.hear("A glass is used for seasoning")
        reply = agent.hear("adorn the mug")

    assert arm.done == ["grasp glass", "lift glass", "point mug"]
    assert tool(reply) == "glass"


def test_what_was_found_cannot_be_changed():
    """It is shared by all steps after it."""
    with pytest.raises(FrozenInstanceError):
        FoundObject(*[None] * 3).percept = None
