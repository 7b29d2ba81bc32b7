# SPDX-License-Identifier: Apache-2.0
"""The preorder walk of an action tree, with four operations at each node.

Paper, section 3.3 and Figure 3. At each node: getFeatures (which features matter here), visual
search for exactly those, getAffordance (what the things seen afford, as constraints), and the
action itself under these constraints. A tree's own action is its steps. A failure is an ordinary
outcome with something to say; the branches of a tree say what else to try before it is the end.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...inference.affordance import FIND
from ...inference.types import Candidate, Goal, Inference, Target
from ...kb.rule import Atom
from ...ontology.actions import FIXED, ActionTree, Condition, Loop
from ...ontology.actions import Step as TreeStep
from ...ontology.errors import ConflictError
from ...sim.vision.percept import Percept
from . import answers
from .outcome import Constraint, Decision, ExecutionResult, Rejected, SpokenAnswer, WalkStep
from .perception import observed
from .primitives import Hands, Task

if TYPE_CHECKING:
    from ..protocols import Motion
    from .goal_manager import GoalManager, Request

Argument = Target | str
GRASP = "graspObject"
WORTH_TRYING = ("accepted", "unsure")  # verdicts of what may be taken instead


@dataclass(frozen=True)
class Found:
    """What was found for a target, and among what."""

    percept: Percept
    candidate: Candidate
    inference: Inference


class Walk:
    """One walk of one tree: what was found so far, and what was done.

    Attributes:
        steps: the nodes, in the order in which they were reached.
        decision: which thing and part, once they are chosen.
        setbacks: failures that were mended, to be told all the same.
    """

    def __init__(self, manager: GoalManager, request: Request, motion: Motion | None) -> None:
        self.manager = manager
        self.request = request
        self.hands = Hands(motion, manager.vision) if motion else None
        self.steps: list[WalkStep] = []
        self.decision: Decision | None = None
        self.setbacks: list[SpokenAnswer] = []
        self._found: dict[Target, Found] = {}
        self._rejected: dict[str, Rejected] = {}

    @property
    def world(self) -> ExecutionResult:
        """What happened in the world so far."""
        return self.hands.world if self.hands else ExecutionResult()

    # --- The four operations ---------------------------------------------------------------

    def visit(self, node: str, arguments: Mapping[str, Argument]) -> SpokenAnswer | None:
        """Perform the four operations at a node, then its steps; returns the failure, if any."""
        goal = self._goal(arguments)
        features = self.manager.affordances.features(node, goal)
        percepts = self._search(node, features, arguments)
        point = self.manager.affordances.settings.detection == "point"
        observations = [observed(percept, features, point=point) for percept in percepts]
        try:
            inference = self.manager.affordances.infer(node, goal, observations)
        except ConflictError as error:
            return SpokenAnswer("contradicted", {"reason": str(error)}, "failed", "conflict")
        index = len(self.steps)
        self.steps.append(_step(node, features, percepts, inference))
        self._tell(self.steps[index])
        failure = self._act(node, arguments, percepts, inference)
        did = failure.key if failure else self._did(node)
        self.steps[index] = replace(self.steps[index], action=did)
        self._tell(self.steps[index])
        return failure

    def _tell(self, step: WalkStep) -> None:
        for watcher in self.manager.watchers:
            watcher(step)

    def _goal(self, arguments: Mapping[str, Argument]) -> Goal:
        """The goal as this node sees it: about the thing already found, or the one looked for."""
        target = self._target(arguments)
        if target in self._found:
            target = Target(object=self._found[target].percept.object)
        return Goal(self.request.action, target, self.request.contexts)

    def _target(self, arguments: Mapping[str, Argument]) -> Target:
        """The thing a node is about: its own argument, or what was found last."""
        targets = [value for value in arguments.values() if isinstance(value, Target)]
        return (targets or list(self._found) or [Target()])[-1]

    def _search(
        self, node: str, features: Sequence[Atom], arguments: Mapping[str, Argument]
    ) -> Sequence[Percept]:
        if not features:
            return ()
        percepts = self.manager.vision.search([str(feature) for feature in features])
        found = self._found.get(self._target(arguments))
        if _action(node) == FIND:
            return [each for each in percepts if each.name not in self._rejected]
        return [each for each in percepts if found is None or each.name == found.percept.name]

    def _act(
        self,
        node: str,
        arguments: Mapping[str, Argument],
        percepts: Sequence[Percept],
        inference: Inference,
    ) -> SpokenAnswer | None:
        action = _action(node)
        if action in self.manager.actions.trees:
            return self._walk_tree(node, self.manager.actions.trees[action], arguments)
        if action == FIND:
            return self._find(arguments, percepts, inference)
        found = self._found.get(self._target(arguments))
        part = None
        if action == GRASP and found:
            part, failure = self._how_to_grasp(found.percept, inference)
            if failure:
                return failure
        if self.hands is None:
            return None
        things = {
            parameter: self._found[value].percept
            for parameter, value in arguments.items()
            if isinstance(value, Target) and value in self._found
        }
        percept = found.percept if found else None
        bound = _constraint(inference)
        return self.hands.perform(Task(action, arguments, percept, part, bound, things))

    # --- Trees: steps, loops, conditions and branches ----------------------------------------

    def _walk_tree(
        self, node: str, tree: ActionTree, arguments: Mapping[str, Argument]
    ) -> SpokenAnswer | None:
        failure = self._unmet(tree, arguments) or self._walk_steps(node, tree.steps, arguments)
        tries = [branch.again for branch in tree.otherwise]
        while failure:
            index = self._branch(tree, failure, arguments, tries)
            if index is None:
                return failure
            branch = tree.otherwise[index]
            if branch.steps and self._walk_steps(node, branch.steps, arguments):
                return failure
            self.setbacks.append(failure)
            if branch.steps:
                return None
            tries[index] -= 1
            if branch.next:
                self._reject(arguments[branch.next], failure)
            failure = self._walk_steps(node, tree.steps, arguments)
        return None

    def _branch(
        self,
        tree: ActionTree,
        failure: SpokenAnswer,
        arguments: Mapping[str, Argument],
        tries: Sequence[int],
    ) -> int | None:
        """The index of the first branch of a tree that can still be taken after a failure."""
        for index, branch in enumerate(tree.otherwise):
            is_possible = bool(branch.steps) or tries[index] > 0
            if branch.next:
                is_possible = bool(self._others(arguments[branch.next]))
            if is_possible and branch.handles(failure.cause):
                return index
        return None

    def _others(self, argument: Argument) -> list[Candidate]:
        """What else was seen that may do instead of what was found."""
        found = self._found.get(argument) if isinstance(argument, Target) else None
        if found is None:
            return []
        tried = {found.percept.name, *self._rejected}
        others = [each for each in found.inference.candidates if each.name not in tried]
        return [each for each in others if each.verdict in WORTH_TRYING]

    def _reject(self, argument: Argument, failure: SpokenAnswer) -> None:
        """Go on without a thing that was chosen but did not do."""
        if isinstance(argument, Target) and argument in self._found:
            found = self._found.pop(argument)
            self._rejected[found.percept.name] = Rejected(found.candidate, failure.cause)

    def _unmet(self, tree: ActionTree, arguments: Mapping[str, Argument]) -> SpokenAnswer | None:
        """The first thing that a tree requires and that does not hold."""
        if self.hands is None:  # nothing is going to be done
            return None
        for condition in tree.requires:
            if not self._holds(condition, arguments.get(condition.parameter)):
                name = _named(arguments.get(condition.parameter)) or condition.parameter
                key = {"sees": "nothing_seen", "holds": "not_held"}[condition.kind]
                return SpokenAnswer(key, {"object": name}, "failed", "required")
        return None

    def _holds(self, condition: Condition, argument: Argument | None) -> bool:
        if condition.kind == "sees":
            return bool(self.manager.vision.search([f"object:{_named(argument)}"]))
        found = self._found.get(argument) if isinstance(argument, Target) else None
        holding = self.hands.holding if self.hands else None
        return found is not None and holding == found.percept.name

    def _walk_steps(
        self, node: str, steps: Sequence[TreeStep | Loop], arguments: Mapping[str, Argument]
    ) -> SpokenAnswer | None:
        for step in steps:
            if isinstance(step, Loop):
                failure = self._repeat(node, step, arguments)
            else:
                failure = self.visit(f"{node}/{step.action}", self._passed(step, arguments))
            if failure:
                return failure
        return None

    def _repeat(
        self, node: str, loop: Loop, arguments: Mapping[str, Argument]
    ) -> SpokenAnswer | None:
        # Without a robot nothing can be sensed: what would be done once is told once.
        for _ in range(loop.times if self.hands else 1):
            failure = self._walk_steps(node, loop.steps, arguments)
            if failure:
                return failure
            if self.hands and loop.until in self.hands.sensed:
                return None
        return self.hands.not_sensed(loop.until) if self.hands and loop.until else None

    def _passed(self, step: TreeStep, arguments: Mapping[str, Argument]) -> dict[str, Argument]:
        """The arguments that a step hands down, reviewed if it is a tree of its own."""
        passed = {
            parameter: word.removeprefix(FIXED) if word.startswith(FIXED) else arguments[word]
            for parameter, word in step.arguments.items()
        }
        if step.action in self.manager.actions.trees:
            return self.manager.reviewed(step.action, replace(self.request, arguments=passed))
        return passed

    # --- Choosing ----------------------------------------------------------------------------

    def _find(
        self, arguments: Mapping[str, Argument], percepts: Sequence[Percept], inference: Inference
    ) -> SpokenAnswer | None:
        target = self._target(arguments)
        patient = self.request.arguments.get("patient")
        if target != patient or self.decision is None:
            # What a tool is used on may be looked for too; the decision is about the tool.
            self.decision = Decision(
                inference,
                named_part=self.request.part,
                patient=_named(patient),
                rejected=tuple(self._rejected.values()),
            )
        best = inference.best
        if best is None:
            return answers.not_found(target, inference)
        percept = next(each for each in percepts if each.name == best.name)
        self._found[target] = Found(percept, best, inference)
        if self.hands and target != patient:
            self.hands.tool, self.hands.patient = best.object, _named(patient)
        return None

    def _how_to_grasp(
        self, percept: Percept, inference: Inference
    ) -> tuple[str | None, SpokenAnswer | None]:
        """By which part, or why that is not clear."""
        if self.decision:
            self.decision = replace(self.decision, part=inference)
        part = self._part(percept, inference)
        if part and self.hands and self._lacks(percept, part):
            slots = {"object": percept.object, "part": part}
            return None, SpokenAnswer("no_part", slots, "failed", "no_part")
        unsure = [each for each in inference.candidates if each.verdict == "unsure"]
        if part is None and unsure:
            return None, answers.not_sure_how(self.request.action, percept.object, unsure[0])
        return part, None

    def _lacks(self, percept: Percept, part: str) -> bool:
        """Whether a thing is known to have no such part, rather than that it is not in view."""
        known = self.manager.parts.get(percept.object)
        return known is not None and part not in known and part not in percept.parts

    def _part(self, percept: Percept, inference: Inference) -> str | None:
        """The part to grasp by: named, concluded, the only one not forbidden, a tool's grip."""
        chosen = self.decision.chosen_part if self.decision else None
        if chosen:
            return self._own_part(chosen, percept)
        forbidden = {
            self._own_part(c.argument.name, percept) for c in inference.denied if c.argument
        }
        allowed = [part for part in percept.parts if part not in forbidden]
        if forbidden and allowed:
            return allowed[0]
        is_tool = "patient" in self.request.arguments
        return self.manager.grips.get(percept.object) if is_tool else None

    def _own_part(self, name: str, percept: Percept) -> str:
        """The thing's own part of a kind: the serrated blade of a bread knife for "blade"."""
        above = self.manager.affordances.taxonomy.above
        kinds = {part: [each for each, _ in above(Atom("part", part))] for part in percept.parts}
        if name in kinds:
            return name
        fitting = [part for part, found in kinds.items() if Atom("part", name) in found]
        return fitting[0] if fitting else name

    def _did(self, node: str) -> str:
        if _action(node) in self.manager.actions.trees:
            return "walked"
        return "executed" if _action(node) == FIND or self.hands else "not executed"


def _constraint(inference: Inference) -> Constraint | None:
    """What the action is bound to: this thing, this part or other argument."""
    best = inference.best
    if best is None:
        return None
    argument = best.argument
    is_part = argument is not None and argument.kind == "part"
    return Constraint(
        best.object,
        argument.name if argument and is_part else None,
        best.interval.lower,
        best.interval.upper,
        str(argument) if argument and not is_part else None,
    )


def _named(argument: Argument | None) -> str | None:
    return argument.object if isinstance(argument, Target) else argument


def _action(node: str) -> str:
    return node.rsplit("/", 1)[-1]


def _step(
    node: str, features: Sequence[Atom], percepts: Sequence[Percept], inference: Inference
) -> WalkStep:
    confidences = {percept.name: percept.confidence for percept in percepts}
    bound = _constraint(inference)
    return WalkStep(node, tuple(map(str, features)), confidences, inference, bound, "")
