"""Somebody else's detector, motion stack and dialogue manager behind Hilt: no simulator needed.

`Camera` stands for your detector, `Arm` for your motion stack and `Butler` for your dialogue
manager; Hilt asks of them what the protocols `Vision`, `Motion`, `Skills` and `Dialogue` say, and
nothing else. Replace the bodies of the methods by calls into your own system.
Run: python examples/own_robot.py
"""

from collections.abc import Mapping, Sequence

from hilt.agent import Agent
from hilt.agent.execution.outcome import AnswerContent
from hilt.inference import Candidate
from hilt.nlu.semantics.meaning import Command, Meaning, ObjectReference
from hilt.sim.manipulation.motion_report import MotionReport
from hilt.sim.vision.percept import Percept

DETECTIONS = (("knife", 0.91), ("spoon", 0.97))  # what your detector sees: class, confidence
LESSONS = ("A knife is used for cutting", "To pass a knife grab the knife by the blade")


class Camera:
    """Your detector: asked only for the features that matter now."""

    def search(self, features: Sequence[str]) -> list[Percept]:
        """The detections that show one of the features ("object:knife", "property:red")."""
        wanted = {
            name for kind, _, name in (f.partition(":") for f in features) if kind == "object"
        }
        return [
            Percept(name=name, object=name, confidence=sure, parts={})
            for name, sure in DETECTIONS
            if name in wanted
        ]


class Arm:
    """Your motion stack: told which thing, and by which part."""

    abilities = frozenset({"graspObject", "moveTo", "handOver"})

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Plan and close the hand on the part; say what was touched."""
        print(f"arm: grasp {percept.name} by the {part or 'best place'}")
        return MotionReport("grasp", ok=True, touched=(part,) if part else (), attempts=1)

    def lift(self) -> MotionReport:
        """Raise what is held, and hold it."""
        print("arm: lift")
        return MotionReport("lift", ok=True, touched=("blade",), lifted_m=0.2, held_s=1.0)

    def hand_over(self) -> MotionReport:
        """Bring it to the person."""
        print("arm: hand over")
        return MotionReport("hand_over", ok=True)

    def point_at(self, percept: Percept) -> MotionReport:
        """This arm cannot point; Hilt does not ask for what is not among the abilities."""
        raise NotImplementedError(percept.name)

    def move_above(self, percept: Percept) -> MotionReport:
        """This arm does not use tools."""
        raise NotImplementedError(percept.name)

    def raise_(self) -> MotionReport:
        """This arm does not use tools."""
        raise NotImplementedError

    def lower(self) -> MotionReport:
        """This arm does not use tools."""
        raise NotImplementedError

    def perform(
        self, action: str, arguments: Mapping[str, Percept | str], constraint: Candidate | None
    ) -> MotionReport:
        """A skill of your own, named in `abilities` and in a file of actions (docs/actions.md)."""
        print(f"arm: {action} {arguments}, bound to {constraint}")
        return MotionReport(action, ok=True)


class Butler:
    """Your dialogue manager: it has words of its own, and leaves the rest to Hilt's grammar."""

    def understand(self, text: str, *, speaker: str) -> Meaning | None:
        """What your parser makes of an utterance; None where Hilt is to read it."""
        if text == "scalpel!":
            return Command("pass", ObjectReference(used_for="cutting"))
        return None

    def say(self, answer: AnswerContent, spoken: str) -> str:
        """The answer in your words, or in Hilt's."""
        return f"At your service. {spoken}" if answer.ending == "done" else f"Alas. {spoken}"


def main() -> None:
    """Teach, ask, and show what the arm was told to do."""
    robot = {"vision": Camera(), "motion": Arm(), "dialogue": Butler()}
    with Agent.open("memory:", **robot) as agent:
        for said in (*LESSONS, "scalpel!", "point to the knife"):
            print(f"sam: {said}\nhilt: {agent.hear(said).said}")


if __name__ == "__main__":
    main()
