"""Films of the robot with its decisions as captions.

Every picture shows the utterance, the node of the action tree, and the constraint there with its
interval. The part to act on is tinted; before the hand moves, the planned grasps are drawn: the
possible ones, those ruled out, and the chosen one.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...inference.node_rules import FIND
from ..execution.outcome import WalkStep

if TYPE_CHECKING:
    from ...sim.body import Body
    from ...sim.grasping.planner import RankedGrasps
    from ...sim.media.recording import WorldRecorder
    from ...sim.robot.path_planner import Grasp
    from ..execution.action_tree_executor import GoalManager

SHOW_FOUND, SHOW_GRASPS, SHOW_ANSWER = 1.0, 2.0, 1.0  # [s] of the film that rests on them
LEGEND = "grasps: green possible, red ruled out, thick taken"


class Film:
    """A film of one body, as long as its `with` block runs.

    `goals` tells at which node of an action tree it is; the path ends in .mp4, .gif or .png.
    DataError if the file cannot be written; MissingExtraError without the extra of the simulator.
    """

    def __init__(self, body: "Body", goals: "GoalManager", path: Path) -> None:
        self.path = path
        self._body, self._goals = body, goals
        self._recorder: WorldRecorder = body.record(path)
        self._utterance = self._bound = ""

    def __enter__(self) -> "Film":
        self._recorder.__enter__()
        self._goals.watchers.append(self._at)
        self._body.on_plan = self._planned
        return self

    def __exit__(self, *raised: Any) -> None:
        self._body.on_plan = None
        self._goals.watchers.remove(self._at)
        self._recorder.__exit__(*raised)

    def begin(self, utterance: str) -> None:
        """Something is said to the robot."""
        self._utterance, self._bound = utterance, ""
        self._write()

    def end(self, said: str) -> None:
        """The robot answers."""
        self._recorder.tint, self._recorder.grasps = None, {}
        self._write(said)
        self._recorder.pause(SHOW_ANSWER)

    def _at(self, step: WalkStep) -> None:
        if step.action:
            self._recorder.grasps = {}
            return
        if bound := step.constraint:  # what the hand is bound to goes on holding
            what = " by the ".join(filter(None, (bound.object, bound.part)))
            self._bound = f"{what} {bound.interval}"
        self._write(node=step.node)
        if bound and step.node.endswith(FIND):
            self._recorder.pause(SHOW_FOUND)

    def _planned(
        self, name: str, part: str | None, plan: "RankedGrasps", taken: "Grasp | None"
    ) -> None:
        from ...sim.media.pictures import ACCEPTED, CHOSEN, REJECTED

        chosen = (taken,) if taken else ()
        shown = (*chosen, *plan.grasps, *plan.examples)
        if not shown:
            return
        recorder, words = self._recorder, self._recorder.caption
        recorder.tint = (name, part) if part else None
        recorder.grasps = {REJECTED: plan.examples, ACCEPTED: plan.grasps, CHOSEN: chosen}
        recorder.caption = f"{words}\n{LEGEND}"
        recorder.pause(SHOW_GRASPS, at=shown[0].world_from_grip[:3, 3])
        recorder.caption = words

    def _write(self, answer: str = "", *, node: str = "") -> None:
        spoken = f'"{self._utterance}"' if self._utterance else ""
        moment = ": ".join(filter(None, (node, self._bound))) if node else ""
        self._recorder.caption = "\n".join(filter(None, (spoken, moment, answer)))
