# SPDX-License-Identifier: Apache-2.0
"""The goal manager: the preorder walk of an action tree, with four operations at each node.

Paper, section 3.3 and Figure 3. At each node: getFeatures (which features matter here), visual
search for exactly those, getAffordance (what the things seen afford, as constraints), and the
action itself under these constraints. A tree's own action is its steps. The first failure ends the
walk; it is an ordinary outcome with something to say.

Arguments are reviewed before the walk (section 4.2): what the command left unsaid is filled in from
the tree's defaults, so "pound the nail" looks for something used for pounding.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ..inference.affordance import FIND, Affordances
from ..inference.goal import Candidate, Goal, Inference, Target
from ..kb.interval import Interval
from ..kb.rule import Atom
from ..ontology.actions import FIXED, Actions, ActionTree, Affords, Loop
from ..ontology.actions import Step as TreeStep
from ..sim.percept import Percept
from ..sim.report import MotionReport
from . import answers
from .outcome import Achievement, Answer, Constraint, Decision, Step, World
from .perception import observed
from .protocols import Motion, Vision

Argument = Target | str
DRIVEN = "driven"  # what the robot senses when something is in all the way
MM = 1e3  # in a metre


@dataclass(frozen=True)
class Request:
    """A goal with what the speaker said about it.

    Attributes:
        action: the tree ("pass").
        arguments: parameter -> the thing meant, or a name.
        speaker: who asked.
        part: the part to act on, when the command itself names it.
        contexts: what else holds now, with how surely.
    """

    action: str
    arguments: Mapping[str, Argument]
    speaker: str
    part: str | None = None
    contexts: Mapping[Atom, Interval] = field(default_factory=dict[Atom, Interval])

    def settled_on(self, came: Achievement) -> Request | None:
        """This request about the likeliest thing, once its speaker has said yes to it."""
        if came.decision is None or not came.decision.object.candidates:
            return None
        likeliest = Target(object=came.decision.object.candidates[0].object, is_confirmed=True)
        parameter = "tool" if "tool" in self.arguments or "patient" in self.arguments else "object"
        return replace(self, arguments={**self.arguments, parameter: likeliest})


class GoalManager:
    """Carries out goals by walking their action trees.

    Args:
        actions: the trees.
        affordances: inference over the rules.
        vision: the eyes.
        motion: the hands; None decides but does not move.
        grips: object -> the part that is made for holding it, by which a tool is taken when
            nobody has said by which.

    Attributes:
        watchers: called after every node of a walk, with what was done there.
    """

    def __init__(
        self,
        actions: Actions,
        affordances: Affordances,
        vision: Vision,
        motion: Motion | None,
        *,
        grips: Mapping[str, str] | None = None,
    ) -> None:
        self.grips = grips or {}
        self.actions = actions
        self.affordances = affordances
        self.vision = vision
        self.motion = motion
        self.watchers: list[Callable[[Step], None]] = []

    def achieve(self, request: Request) -> Achievement:
        """Walk the tree of a goal to its end, or to its first failure.

        Raises:
            UnknownNameError: there is no tree of that name.
        """
        tree = self.actions.tree(request.action)
        arguments = _reviewed(tree, request)
        unable = self._unable(tree.name)
        walk = _Walk(self, request, motion=None if unable else self.motion)
        failure = walk.visit(tree.name, arguments)
        answer = failure or self._answer(walk, request, str(arguments.get("recipient", "")), unable)
        return Achievement(answer, walk.decision, tuple(walk.steps), walk.world)

    def _answer(
        self, walk: _Walk, request: Request, recipient: str, unable: Sequence[str]
    ) -> Answer:
        if walk.decision is None:  # a tree that looks for nothing
            return Answer("okay")
        if unable:
            return answers.unable(request.action, unable[0], walk.decision)
        if self.motion is None:
            return answers.decided(request.action, walk.decision)
        return answers.done(request.action, walk.decision, request.speaker, recipient)

    def _unable(self, tree: str) -> list[str]:
        """The primitives of a tree that the robot's motion cannot perform."""
        if self.motion is None:
            return []
        below = (node for node in self.actions.nodes if node.startswith(f"{tree}/"))
        needed = {node.rsplit("/", 1)[-1] for node in below} & self.actions.primitives.keys()
        return sorted(needed - self.motion.abilities - {FIND})


def _reviewed(tree: ActionTree, request: Request) -> dict[str, Argument]:
    """All arguments of a tree: those said, then the tree's defaults."""
    arguments = dict(request.arguments)
    for parameter, default in tree.defaults.items():
        if parameter not in arguments:
            said = Target(used_for=default.affordance) if isinstance(default, Affords) else None
            arguments[parameter] = said or request.speaker
    return arguments


class _Walk:
    """One walk of one tree: what was found so far, and what was done."""

    def __init__(self, manager: GoalManager, request: Request, motion: Motion | None) -> None:
        self.manager = manager
        self.request = request
        self.motion = motion
        self.steps: list[Step] = []
        self.decision: Decision | None = None
        self.world = World()
        self._depth_before_mm = 0.0
        self._found: dict[Target, tuple[Percept, Candidate]] = {}
        self._primitives: dict[str, Callable[[Mapping[str, Argument], Inference], Answer | None]]
        self._primitives = {
            FIND: self._find,
            "graspObject": self._grasp,
            "moveTo": self._move_to,
            "handOver": self._hand_over,
            "pointAt": self._point_at,
            "moveAbove": self._move_above,
            "raise": self._raise,
            "lower": self._lower,
        }
        self._sensed: set[str] = set()

    # --- The four operations ---------------------------------------------------------------

    def visit(self, node: str, arguments: Mapping[str, Argument]) -> Answer | None:
        """Perform the four operations at a node, then its steps; returns the failure, if any."""
        goal = self._goal(arguments)
        features = self.manager.affordances.features(node, goal)
        percepts = self._search(node, features, arguments)
        observations = [observed(percept, features) for percept in percepts]
        inference = self.manager.affordances.infer(node, goal, observations)
        index = len(self.steps)
        self.steps.append(_step(node, features, percepts, inference))
        failure = self._act(node, arguments, percepts, inference)
        self.steps[index] = replace(
            self.steps[index],
            constraint=self._constraint(node, arguments, inference),
            action=failure.key if failure else self._did(node),
        )
        for watcher in self.manager.watchers:
            watcher(self.steps[index])
        return failure

    def _goal(self, arguments: Mapping[str, Argument]) -> Goal:
        """The goal as this node sees it: about the thing already found, or the one looked for."""
        target = self._target(arguments)
        if target in self._found:
            target = Target(object=self._found[target][0].object)
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
        target = self._target(arguments)
        if target not in self._found or node.endswith(FIND):
            return percepts
        return [p for p in percepts if p.name == self._found[target][0].name]

    def _act(
        self,
        node: str,
        arguments: Mapping[str, Argument],
        percepts: Sequence[Percept],
        inference: Inference,
    ) -> Answer | None:
        action = node.rsplit("/", 1)[-1]
        if action in self.manager.actions.trees:
            return self._walk_steps(node, self.manager.actions.trees[action], arguments)
        if action == FIND and inference.best:
            chosen = next(p for p in percepts if p.name == inference.best.name)
            self._found[self._target(arguments)] = (chosen, inference.best)
        perform = self._primitives.get(action)
        return perform(arguments, inference) if perform else None

    def _walk_steps(
        self, node: str, tree: ActionTree, arguments: Mapping[str, Argument]
    ) -> Answer | None:
        for step in tree.steps:
            if isinstance(step, Loop):
                failure = self._repeat(node, step, arguments)
            else:
                failure = self.visit(f"{node}/{step.action}", self._passed(step, arguments))
            if failure:
                return failure
        return None

    def _repeat(self, node: str, loop: Loop, arguments: Mapping[str, Argument]) -> Answer | None:
        # Without a robot nothing can be sensed: what would be done once is told once.
        for _ in range(loop.times if self.motion else 1):
            for step in loop.steps:
                failure = self.visit(f"{node}/{step.action}", self._passed(step, arguments))
                if failure:
                    return failure
            if loop.until in self._sensed:
                return None
        return self._not_driven() if loop.until == DRIVEN and self.motion else None

    def _passed(self, step: TreeStep, arguments: Mapping[str, Argument]) -> dict[str, Argument]:
        """The arguments that a step hands down, reviewed if it is a tree of its own."""
        passed = {
            parameter: word.removeprefix(FIXED) if word.startswith(FIXED) else arguments[word]
            for parameter, word in step.arguments.items()
        }
        if step.action in self.manager.actions.trees:
            inner = replace(self.request, arguments=passed)
            return _reviewed(self.manager.actions.trees[step.action], inner)
        return passed

    # --- Primitives ------------------------------------------------------------------------

    def _find(self, arguments: Mapping[str, Argument], inference: Inference) -> Answer | None:
        patient = self.request.arguments.get("patient")
        self.decision = Decision(
            inference,
            named_part=self.request.part,
            patient=patient.object if isinstance(patient, Target) else patient,
        )
        if inference.best:
            return None
        return answers.not_found(self._target(arguments), inference)

    def _grasp(self, arguments: Mapping[str, Argument], inference: Inference) -> Answer | None:
        percept, _ = self._found[self._target(arguments)]
        if self.decision:
            self.decision = replace(self.decision, part=inference)
        part = self._part(percept, inference)
        if part is None and any(each.verdict == "unsure" for each in inference.candidates):
            return answers.not_sure_how(self.request.action, percept.object)
        if self.motion is None:
            return None
        report = self.motion.grasp(percept, part)
        self.world = World(True, touched=tuple(report.touched), attempts=report.attempts)
        if report.ok:
            return None
        return answers.motion_failed(report.reason, percept.object, part)

    def _part(self, percept: Percept, inference: Inference) -> str | None:
        """The part to grasp by: named, concluded, the only one not forbidden, a tool's grip."""
        chosen = self.decision.chosen_part if self.decision else None
        forbidden = {c.argument.name for c in inference.denied if c.argument}
        allowed = [part for part in percept.parts if part not in forbidden]
        if chosen or (forbidden and allowed):
            return chosen or allowed[0]
        is_tool = "patient" in self.request.arguments
        return self.manager.grips.get(percept.object) if is_tool else None

    def _move_to(self, arguments: Mapping[str, Argument], inference: Inference) -> Answer | None:
        if self.motion is None:
            return None
        report = self.motion.lift()
        self.world = replace(
            self.world,
            touched=tuple(report.touched),
            lifted_m=report.lifted_m,
            held_s=report.held_s,
            attempts=report.attempts,
        )
        return None if report.ok else self._failed(report.reason, arguments)

    def _hand_over(self, arguments: Mapping[str, Argument], inference: Inference) -> Answer | None:
        if self.motion is None:
            return None
        report = self.motion.hand_over()
        self.world = replace(self.world, handed_over=report.ok)
        return None if report.ok else self._failed(report.reason, arguments)

    def _point_at(self, arguments: Mapping[str, Argument], inference: Inference) -> Answer | None:
        if self.motion is None:
            return None
        percept, _ = self._found[self._target(arguments)]
        report = self.motion.point_at(percept)
        self.world = replace(self.world, executed=True)
        return None if report.ok else self._failed(report.reason, arguments)

    def _move_above(self, arguments: Mapping[str, Argument], inference: Inference) -> Answer | None:
        if self.motion is None:
            return None
        wanted = arguments.get("patient")
        name = wanted.object if isinstance(wanted, Target) else wanted
        seen = self.manager.vision.search([f"object:{name}"])
        if not seen:
            return Answer("nothing_seen", {"object": name or "thing"}, "failed")
        report = self.motion.move_above(seen[0])
        self._depth_before_mm = report.depth_m * MM
        return self._struck(report)

    def _raise(self, arguments: Mapping[str, Argument], inference: Inference) -> Answer | None:
        return self._struck(self.motion.raise_()) if self.motion else None

    def _lower(self, arguments: Mapping[str, Argument], inference: Inference) -> Answer | None:
        return self._struck(self.motion.lower()) if self.motion else None

    def _struck(self, report: MotionReport) -> Answer | None:
        depth_mm = report.depth_m * MM
        self.world = replace(
            self.world, nail_depth_mm=depth_mm, driven_mm=depth_mm - self._depth_before_mm
        )
        if report.driven:
            self._sensed.add(DRIVEN)
            return None  # it is in: what else went wrong with the last blow does not matter
        if report.ok:
            return None
        return self._not_driven(report.reason)

    def _not_driven(self, reason: str = "not_driven") -> Answer:
        """The answer when what was to be driven in is not."""
        best = self.decision.object.best if self.decision else None
        tool = best.object if best else "thing"
        if reason in {"dropped", "nothing_held"}:
            return Answer("dropped", {"object": tool}, "failed")
        patient = (self.decision.patient if self.decision else None) or "thing"
        key = "not_driven" if reason == "not_driven" else "cannot_strike"
        return Answer(key, {"patient": patient, "tool": tool}, "failed")

    def _failed(self, reason: str, arguments: Mapping[str, Argument]) -> Answer:
        percept, _ = self._found[self._target(arguments)]
        part = self.decision.chosen_part if self.decision else None
        return answers.motion_failed(reason, percept.object, part)

    # --- What is recorded --------------------------------------------------------------------

    def _constraint(
        self, node: str, arguments: Mapping[str, Argument], inference: Inference
    ) -> Constraint | None:
        best = inference.best
        if best is None:
            return None
        part = best.argument.name if best.argument and best.argument.kind == "part" else None
        return Constraint(best.object, part, best.interval.lower, best.interval.upper)

    def _did(self, node: str) -> str:
        action = node.rsplit("/", 1)[-1]
        if action in self.manager.actions.trees:
            return "walked"
        return "executed" if action == FIND or self.motion is not None else "not executed"


def _step(
    node: str, features: Sequence[Atom], percepts: Sequence[Percept], inference: Inference
) -> Step:
    confidences = {percept.name: percept.confidence for percept in percepts}
    return Step(node, tuple(map(str, features)), confidences, inference, None, "")
