"""The goal manager: executes the action tree of a request, and chooses the answer."""

from collections.abc import Sequence

from ...inference.node_rules import FIND
from ..protocols import ReleasingMotion
from . import outcome_answer
from .action_tree_executor import ExecutionContext, TreeExecutor
from .outcome import AnswerContent, Decision, GoalResult
from .primitives import EMPTYING, empty_hand
from .request import Request, review_arguments

_EMPTYING = {"release": "letGo", "putDown": "placeObject", "putBack": "returnObject"}
"""The primitive of each control that empties the hand."""


class GoalManager(ExecutionContext):
    """Carries out goals by walking their action trees."""

    def achieve(self, request: Request) -> GoalResult:
        """Execute the tree of a goal to its end, or to the first failure that no branch handles.

        UnknownNameError if there is no tree of that name.
        """
        tree = self.actions.tree(request.action)
        arguments = review_arguments(self.actions, tree.name, request)
        unable = self._missing_abilities(tree.name)
        execution = TreeExecutor(self, request, is_able=not unable)
        failure = execution.visit(tree.name, arguments)
        if failure and failure.cause == outcome_answer.INTERRUPTED:
            failure = outcome_answer.stopped(self.holding)
        recipient = str(arguments.get("recipient", ""))
        answer = failure or self._answer(request, execution.decision, recipient, unable)
        if tree.objects is not None and answer.ending == "done":
            names = tuple(map(execution.name, map(arguments.get, tree.parameters)))
            answer = outcome_answer.taught_done(request.action, names, is_done=bool(self.motion))
        return execution.result(answer)

    def empty_hand(self, control: str, named: str | None = None) -> AnswerContent:
        """Release, put down or put back what the hand holds; `named` is what it should be."""
        return empty_hand(self.motion, _EMPTYING[control], named)

    def _answer(
        self, request: Request, decision: Decision | None, recipient: str, unable: Sequence[str]
    ) -> AnswerContent:
        if request.action in _EMPTYING and self.motion and not unable:
            return outcome_answer.hand_emptied(_EMPTYING[request.action], request.name("object"))
        if decision is None or decision.object.best is None:  # nothing was looked for or needed
            return AnswerContent("okay")
        if unable:
            return outcome_answer.unable(request.action, unable[0], decision)
        if self.motion is None:
            return outcome_answer.decided(request.action, decision, request.speaker, recipient)
        return outcome_answer.done(request.action, decision, request.speaker, recipient)

    def _missing_abilities(self, tree: str) -> list[str]:
        if self.motion is None:
            return []
        below = (node for node in self.actions.nodes if node.startswith(f"{tree}/"))
        needed = {node.rsplit("/", 1)[-1] for node in below} & self.actions.primitives.keys()
        own = EMPTYING.keys() if isinstance(self.motion, ReleasingMotion) else set[str]()
        return sorted(needed - self.motion.abilities - own - {FIND})
