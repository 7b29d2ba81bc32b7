# SPDX-License-Identifier: Apache-2.0
"""The goal manager: executes the action tree of a request, and chooses the answer."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence

from ...inference.affordance import Affordances
from ...inference.node_rules import FIND
from ...ontology.actions import Actions
from ...sim.robot.interruption import Interruption
from ..protocols import Motion, ReleasingMotion, Vision
from . import outcome_answer
from .action_tree_executor import ExecutionContext, TreeExecutor
from .outcome import AnswerContent, Decision, GoalResult, WalkStep
from .request import Request, review_arguments

_EMPTIED = {"release": "released", "putDown": "put_down", "putBack": "put_back"}
"""The answer when the hand was emptied by a control."""


class GoalManager:
    """Carries out goals by walking their action trees.

    Args:
        actions: the action trees.
        affordances: inference over the rules.
        vision: the vision of the robot.
        motion: the motion of the robot; None decides but does not act.
        grips: object -> the part that is made for holding it; a tool is grasped by it when no rule
            says otherwise.
        parts: object -> its known parts; the robot does not look for others.
        interruption: pauses or ends what is done, also from other threads.

    Attributes:
        watchers: called at every node before its action is done, when `WalkStep.action` is still
            empty, and again afterwards.
    """

    def __init__(
        self,
        actions: Actions,
        affordances: Affordances,
        vision: Vision,
        motion: Motion | None,
        *,
        grips: Mapping[str, str] | None = None,
        parts: Mapping[str, Collection[str]] | None = None,
        interruption: Interruption | None = None,
    ) -> None:
        self.actions = actions
        self.affordances = affordances
        self.vision = vision
        self.motion = motion
        self.watchers: list[Callable[[WalkStep], None]] = []
        self.interruption = interruption or Interruption()
        self._grips = grips or {}
        self._parts = parts or {}

    def achieve(self, request: Request) -> GoalResult:
        """Execute the tree of a goal to its end, or to the first failure that no branch handles.

        Raises:
            UnknownNameError: there is no tree of that name.
        """
        tree = self.actions.tree(request.action)
        arguments = review_arguments(self.actions, tree.name, request)
        unable = self._missing_abilities(tree.name)
        context = ExecutionContext(
            self.actions,
            self.affordances,
            self.vision,
            None if unable else self.motion,
            self._grips,
            self._parts,
            self.interruption,
            tuple(self.watchers),
        )
        execution = TreeExecutor(context, request)
        failure = execution.visit(tree.name, arguments)
        if failure and failure.cause == outcome_answer.INTERRUPTED:
            failure = outcome_answer.stopped(self.holding)
        recipient = str(arguments.get("recipient", ""))
        answer = failure or self._answer(request, execution.decision, recipient, unable)
        return execution.result(answer)

    @property
    def holding(self) -> str | None:
        """The type of the object in the hand, None when it is empty or there is no hand."""
        held = self.motion.held if isinstance(self.motion, ReleasingMotion) else None
        return held.object if held else None

    def empty_hand(self, control: str, named: str | None = None) -> AnswerContent:
        """Release, put down or put back what the hand holds; `named` is what it should be."""
        held = self.holding
        if not isinstance(self.motion, ReleasingMotion) or held is None:
            return AnswerContent("nothing_held", {}, "failed", "nothing_held")
        if named not in {None, held}:
            return AnswerContent("not_held", {"object": str(named)}, "failed", "nothing_held")
        moves = {"release": self.motion.release, "putDown": self.motion.put_down}
        report = moves.get(control, self.motion.put_back)()
        if report.ok:
            return AnswerContent(_EMPTIED[control], {"object": held})
        if report.reason == outcome_answer.INTERRUPTED:
            return outcome_answer.stopped(self.holding)
        key = "dropped" if report.reason == "dropped" else "no_place"
        return AnswerContent(key, {"object": held}, "failed", report.reason)

    def _answer(
        self, request: Request, decision: Decision | None, recipient: str, unable: Sequence[str]
    ) -> AnswerContent:
        if decision is None or decision.object.best is None:  # nothing was looked for or needed
            return AnswerContent("okay")
        if unable:
            return outcome_answer.unable(request.action, unable[0], decision)
        if self.motion is None:
            return outcome_answer.decided(request.action, decision)
        return outcome_answer.done(request.action, decision, request.speaker, recipient)

    def _missing_abilities(self, tree: str) -> list[str]:
        """The primitives of a tree that the motion of the robot cannot perform."""
        if self.motion is None:
            return []
        below = (node for node in self.actions.nodes if node.startswith(f"{tree}/"))
        needed = {node.rsplit("/", 1)[-1] for node in below} & self.actions.primitives.keys()
        return sorted(needed - self.motion.abilities - {FIND})
