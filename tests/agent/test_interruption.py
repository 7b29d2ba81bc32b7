"""Control words: what runs is interrupted at once, and the next command works."""

import time
from collections.abc import Callable, Iterator
from threading import Thread

import numpy as np
import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.dialogue.reply import Reply
from hilt.sim.robot.robot import NAME

LATEST = 0.05  # [s] of simulated time until the arm reacts
AT_REST = 0.05  # [rad/s]
IN_GRASP, IN_LIFT, IN_HANDOVER = 0.8, 2.6, 4.8  # [s] of simulated time after the command

sim = pytest.mark.sim


@pytest.fixture
def robot() -> Iterator[Agent]:
    """A robot that was taught how to pass a knife."""
    with Agent.open("memory:", AgentConfig(scene="objects:knife,mug", seed=3)) as agent:
        agent.hear("To pass a knife grab the knife by the blade")
        yield agent


def while_doing(
    agent: Agent, command: str, after: float, act: Callable[[], Reply]
) -> tuple[Reply, Reply]:
    """The reply to a command, and the result of an act at a simulated time after its start."""
    replies: list[Reply] = []
    start = agent.body.world.time
    thread = Thread(target=lambda: replies.append(agent.hear(command)))
    thread.start()
    while thread.is_alive() and agent.body.world.time < start + after:
        time.sleep(0.001)
    said = act()
    thread.join()
    return replies[0], said


def speed(agent: Agent) -> float:
    """The speed of the fastest joint [rad/s]."""
    joints = agent.body.robot.chain.names
    return float(np.abs(agent.body.world.engine.joints.states(NAME, joints)[1]).max())


@sim
@pytest.mark.parametrize(
    ("after", "held"), [(IN_GRASP, None), (IN_LIFT, "knife"), (IN_HANDOVER, "knife")]
)
def test_stop_ends_the_motion_and_the_next_command_works(
    robot: Agent, after: float, held: str | None
):
    """The arm is at rest, the answer says what is in the hand, and the mug is passed."""
    command, stopped = while_doing(
        robot, "pass me the knife", after, lambda: robot.hear("Stop! Stop!")
    )

    assert (command.ending, command.is_interrupted) == ("failed", True)
    assert robot.body.holding == held
    assert speed(robot) < AT_REST
    holding = f" I'm still holding the {held}." if held else ""
    assert (stopped.ending, stopped.said) == ("done", f"I stopped.{holding}")
    assert robot.hear("pass me the mug").is_done


@sim
def test_what_is_forbidden_is_stopped(robot: Agent):
    """Also when it is being done."""
    command, _ = while_doing(
        robot, "pass me the knife", IN_LIFT, lambda: robot.hear("stop passing me the knife")
    )

    assert command.is_interrupted


@sim
def test_arm_reacts_within_fifty_milliseconds(robot: Agent):
    """Of simulated time, from the request until the arm brakes."""
    world, asked, braked = robot.body.world, list[float](), list[float]()
    halt = robot.body.robot.halt

    def watch() -> None:
        if world.time > IN_GRASP and not asked:
            asked.append(world.time)
            robot.interrupt()

    def note() -> None:
        braked.append(world.time)
        halt()

    world.engine.watchers.append(watch)
    robot.body.robot.halt = note
    robot.hear("pass me the knife")

    assert braked[0] - asked[0] <= LATEST


@sim
def test_command_goes_on_after_a_stop(robot: Agent):
    """The knife, which is still in the hand, is handed over by the same part."""
    while_doing(robot, "pass me the knife", IN_HANDOVER, lambda: robot.hear("halt"))

    reply = robot.hear("ok, go on")

    assert reply.said == "Here is the knife. I'm holding it by the blade, as you told me."


@sim
def test_paused_motion_stands_still_and_goes_on(robot: Agent):
    """Time stands still in the pause; then the command is carried out to its end."""

    def pause() -> Reply:
        waiting = robot.hear("please wait")
        time.sleep(0.3)
        before = robot.body.world.time
        time.sleep(0.1)
        assert (robot.body.world.time, speed(robot) < AT_REST) == (before, True)
        assert robot.hear("go on").said == "I'm going on."
        return waiting

    command, waiting = while_doing(robot, "pass me the knife", IN_HANDOVER, pause)

    assert waiting.said == "I'm waiting. Tell me when to go on."
    assert command.is_done


@sim
def test_what_is_said_in_a_pause_ends_the_command(robot: Agent):
    """A question is answered at once, and "go on" takes the command up again."""

    def ask() -> Reply:
        robot.hear("wait")
        return robot.hear("how do you pass a knife?")

    command, answered = while_doing(robot, "pass me the knife", IN_LIFT, ask)

    assert command.is_interrupted
    assert answered.is_done
    assert robot.hear("go on").is_done


@sim
@pytest.mark.parametrize(
    ("control", "said", "is_back"),
    [
        ("put it down", "I put the knife down.", False),
        ("put it back", "I put the knife back.", True),
        ("let go", "I let go of the knife.", False),
        ("put the knife back", "I put the knife back.", True),
    ],
)
def test_hand_is_emptied_as_was_said(robot: Agent, control: str, said: str, is_back: bool):
    """The knife lies on the table: near the hand, where it was, or where it fell."""
    before = robot.body.world.pose("knife")[:2, 3]

    _, reply = while_doing(robot, "pass me the knife", IN_HANDOVER, lambda: robot.hear(control))

    assert (reply.said, robot.body.holding) == (said, None)
    robot.body.world.settle()
    assert robot.body.world.points("knife")[:, 2].min() < 0.005
    shift = float(np.linalg.norm(robot.body.world.pose("knife")[:2, 3] - before))
    assert shift < 0.01 or not is_back


@sim
def test_another_thing_than_the_held_one_is_not_put_down(robot: Agent):
    """The answer says so, and the knife stays in the hand."""
    robot.hear("pass me the knife")

    reply = robot.hear("put the mug down")

    assert (reply.said, robot.body.holding) == ("I'm not holding the mug.", "knife")


@pytest.mark.parametrize(
    ("control", "said"),
    [
        ("stop", "I'm not doing anything."),
        ("please wait", "I'm waiting. Tell me when to go on."),
        ("put it down", "I'm not holding anything."),
        ("drop it", "I'm not holding anything."),
        ("go on", "There is nothing to go on with."),
    ],
)
def test_control_without_anything_to_control_is_answered(agent: Agent, control: str, said: str):
    """Nothing is done, and nothing is believed."""
    assert agent.hear(control).said == said
    assert not agent.base.rules()


def test_go_on_confirms_what_was_asked(agent: Agent):
    """Like "yes"."""
    agent.base.set_trust("kim", 0.05)
    agent.hear("A mug is used for pounding", speaker="kim")
    asked = agent.hear("pass me something used for pounding")

    assert asked.ending == "asked"
    assert agent.hear("go on").is_done


def test_anybody_may_stop_and_only_the_trusted_may_release(agent: Agent):
    """A stranger's "stop" is obeyed, their "let go" is not."""
    assert agent.hear("stop", speaker="eve").is_done
    assert agent.hear("let go", speaker="eve").ending == "refused"
