"""Execution of an action tree: a preorder walk with four operations at each node.

Paper, section 3.3 and Figure 3. At each node: getFeatures (which features are relevant), visual
search for exactly those, getAffordance (the constraints that the rules conclude), and the action
itself under these constraints. The action of a tree is its steps. A failure is an ordinary outcome
with an answer; the branches of a tree say what to try before it is final.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from ...inference.affordance import Affordances
from ...inference.node_rules import FIND, acting_for
from ...inference.norms import NormChecker
from ...inference.types import Candidate, Goal, Inference, Observation, Target
from ...kb.rule import Atom
from ...ontology.actions import FIXED, Actions, ActionTree, DescribedObject, Loop, Precondition
from ...ontology.actions import Step as TreeStep
from ...ontology.errors import ConflictError, MotionInterruptedError
from ...ontology.logs import timed
from ...sim.robot.interruption import Interruption
from ...sim.vision.percept import Percept
from ..protocols import ClearingMotion, Motion, ReleasingMotion, Vision
from . import outcome_answer
from .doubt import Doubt, find_doubt
from .norm_guard import NormGuard
from .outcome import AnswerContent, Decision, Failure, GoalResult, WalkStep, WorldOutcome
from .perception import percept_as_observation
from .primitives import EMPTYING, PrimitiveExecutor, PrimitiveTask, empty_hand
from .request import PATIENT, Argument, Arguments, Request, named, review_arguments

Steps = Sequence[TreeStep | Loop]
Watcher = Callable[[WalkStep], None]
_EMPTYING = {"release": "letGo", "putDown": "placeObject", "putBack": "returnObject"}
"""The primitive of each control that empties the hand."""

GRASP, PICK_UP = "graspObject", "pickUp"
WORTH_TRYING = ("accepted", "unsure")  # verdicts of candidates that may be tried instead


@dataclass
class GoalManager:
    """Carries out goals by walking their action trees."""

    actions: Actions
    affordances: Affordances
    vision: Vision
    motion: Motion | None  #: the motion of the robot; None decides but does not act
    norms: NormChecker  #: what is forbidden, and what must come first
    #: object -> the part made for holding it; a tool is grasped by it if no rule says otherwise
    grips: Mapping[str, str] = field(default_factory=dict[str, str])
    #: object -> its known parts; the robot does not look for others
    parts: Mapping[str, Collection[str]] = field(default_factory=dict[str, Collection[str]])
    interruption: Interruption = field(default_factory=Interruption)
    #: the acts so far, in order: action and type of object; it grows
    done: list[tuple[str, str]] = field(default_factory=list[tuple[str, str]])
    #: called at every node before its action is done, when `WalkStep.action` is still empty, and
    #: again afterwards
    watchers: list[Watcher] = field(default_factory=list[Watcher])

    def search(self, features: Sequence[str]) -> Sequence[Percept]:
        """Return what the vision finds; the features, what was found, and the time are logged."""
        found: list[Percept] = []
        with timed(__name__, "look for %s: %s", ", ".join(features), found):
            found += self.vision.search(features)
        return found

    @property
    def holding(self) -> str | None:
        """The type of the object in the hand, None when it is empty or there is no hand."""
        held = self.motion.held if isinstance(self.motion, ReleasingMotion) else None
        return held.object if held else None

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

    def empty_hand(self, control: str, kind: str | None = None) -> AnswerContent:
        """Release, put down or put back what the hand holds; `kind` is what it should be."""
        return empty_hand(self.motion, _EMPTYING[control], kind)

    def _answer(
        self, request: Request, decision: Decision | None, recipient: str, unable: Sequence[str]
    ) -> AnswerContent:
        if request.action in _EMPTYING and self.motion and not unable:
            return outcome_answer.hand_emptied(_EMPTYING[request.action], request.name("object"))
        if decision is None or decision.object.best is None:  # nothing was looked for or needed
            return AnswerContent("okay")
        if unable:
            return outcome_answer.unable(request.action, unable[0], decision)
        answer = outcome_answer.done if self.motion else outcome_answer.decided
        return answer(request.action, decision, request.speaker, recipient)

    def _missing_abilities(self, tree: str) -> list[str]:
        if self.motion is None:
            return []
        below = (node for node in self.actions.nodes if node.startswith(f"{tree}/"))
        needed = {_action(node) for node in below} & self.actions.primitives.keys()
        own = EMPTYING.keys() if isinstance(self.motion, ReleasingMotion) else set[str]()
        return sorted(needed - self.motion.abilities - own - {FIND})


@dataclass(frozen=True)
class FoundObject:
    """What was found for a target, and the inference that chose it."""

    percept: Percept
    candidate: Candidate
    inference: Inference


class TreeExecutor:
    """One execution of one action tree; `decision` is the object and part, once they are chosen.

    Without `is_able` the robot lacks something that the tree needs, and it is only decided.
    """

    def __init__(self, context: GoalManager, request: Request, *, is_able: bool) -> None:
        self._context, self._request = context, request
        self._affordances = context.affordances
        self._norms = NormGuard(
            context.norms, context.actions, request, context.done, lambda: context.holding
        )
        motion = context.motion if is_able else None
        self._primitives = PrimitiveExecutor(motion, context, request.action) if motion else None
        if isinstance(motion, ClearingMotion):
            motion.movable = self._parts_to_move
        self.decision: Decision | None = None
        self._steps: list[WalkStep] = []
        self._setbacks: list[AnswerContent] = []
        self._found: dict[Argument | None, FoundObject] = {}
        self._rejected: dict[str, Candidate] = {}
        # What the command or the step names: the part, and what a tool is used on.
        self._part, self._patient = request.part, request.arguments.get(PATIENT)
        self._doubt: Doubt | None = None

    def result(self, answer: AnswerContent) -> GoalResult:
        """Return the result of the execution so far, with this answer."""
        world = self._primitives.world if self._primitives else WorldOutcome()
        trials = self._primitives.grasps.trials if self._primitives else ()
        if world.moved:
            self._report_setback(AnswerContent("moved_aside", {"objects": world.moved}))
        done = (tuple(self._steps), world, tuple(self._setbacks), trials, self._doubt)
        return GoalResult(answer, self.decision, *done, tuple(self._norms.verdicts))

    def name(self, argument: Argument | None) -> str:
        """Return the kind of the object that was found for an argument, or that it names."""
        found = self._found.get(argument)
        return found.percept.object if found else named(argument) or "thing"

    # --- The four operations ---------------------------------------------------------------

    def visit(self, node: str, arguments: Arguments) -> Failure:
        """Perform the four operations at a node, then its steps; return the failure, if any."""
        try:
            self._context.interruption.wait()
        except MotionInterruptedError:
            return outcome_answer.stopped(None)
        if refusal := self._norms.enter(node, arguments):
            return refusal
        action, target, affordances = _action(node), self._target(arguments), self._affordances
        if target in self._found:
            target = Target(object=self.name(target), material=target.material)
        goal = Goal(self._request.action, target, self._request.contexts)
        features = affordances.features(node, goal)
        percepts = self._search(node, features, arguments)
        observations = [self._observed(percept, features) for percept in percepts]
        try:
            inference = affordances.infer(node, goal, observations)
        except ConflictError as error:
            return AnswerContent("contradicted", {"reason": str(error)}, "failed", "conflict")
        index = len(self._steps)
        confidences = {percept.name: percept.confidence for percept in percepts}
        step = WalkStep(node, tuple(map(str, features)), confidences, inference)
        self._steps.append(step)
        self._notify(step)
        failure = self._act(arguments, percepts, inference)
        did = "executed" if action == FIND or self._primitives else "not executed"
        did = "walked" if action in self._context.actions.trees else did
        self._steps[index] = replace(step, action=failure.key if failure else did)
        self._notify(self._steps[index])
        if failure is None and action != FIND:
            self._context.done.append((action, self.name(self._target(arguments))))
        return failure

    def _observed(self, percept: Percept, features: Sequence[Atom]) -> Observation:
        is_point = self._affordances.settings.detection == "point"
        seen = percept_as_observation(percept, features, point=is_point)
        told = self._request.contexts if percept.object == self._request.name("object") else {}
        return replace(seen, atoms={each: told.get(each, seen.atoms[each]) for each in seen.atoms})

    def _notify(self, step: WalkStep) -> None:
        for watcher in self._context.watchers:
            watcher(step)

    def _target(self, arguments: Arguments) -> Target:
        known = (*self._found, *arguments.values())
        return next((each for each in reversed(known) if isinstance(each, Target)), Target())

    def _search(self, node: str, wanted: Sequence[Atom], arguments: Arguments) -> Sequence[Percept]:
        if not wanted:
            return ()
        percepts = self._context.search([str(feature) for feature in wanted])
        found = self._found.get(self._target(arguments))
        is_new = found is None or all(each.name != found.percept.name for each in percepts)
        if _action(node) == FIND and is_new:
            tried = {*self._rejected, *self._excluded(arguments)}
            return [each for each in percepts if each.name not in tried]
        return [each for each in percepts if found is None or each.name == found.percept.name]

    def _excluded(self, arguments: Arguments) -> Collection[str]:
        return () if self._target(arguments) == self._patient else self._request.excluded

    def _act(self, arguments: Arguments, seen: Sequence[Percept], inference: Inference) -> Failure:
        node, target = inference.node, self._target(arguments)
        if (action := _action(node)) == FIND:
            return self._find(arguments, seen, inference)
        found = self._found.get(target)
        percept, part = found and found.percept, None
        if action == GRASP and percept:
            part, failure = self._part_to_hold(target, percept, inference)
            self._norms.part = part
        else:
            failure = self._norms.of_step(node, target, percept)
        if failure:
            return failure
        if action in self._context.actions.trees:
            return self._walk_tree(node, self._context.actions.trees[action], arguments)
        if self._primitives is None:
            return None
        known = ((parameter, self._found.get(value)) for parameter, value in arguments.items())
        things = {parameter: each.percept for parameter, each in known if each}
        bound, goal = self._steps[-1].constraint, acting_for(node)
        task = PrimitiveTask(action, arguments, percept, part, bound, things, goal)
        return self._primitives.perform(task)

    # --- Trees: steps, loops, conditions and branches ----------------------------------------

    def _walk_tree(self, node: str, tree: ActionTree, arguments: Arguments) -> Failure:
        unmet = (self._unmet_condition(each, arguments) for each in tree.requires)
        failure = next(filter(None, unmet), None) or self._walk_steps(node, tree.steps, arguments)
        tries = [branch.again for branch in tree.otherwise]
        while failure:
            if (index := self._branch(tree, failure, arguments, tries)) is None:
                return failure
            branch = tree.otherwise[index]
            if branch.steps:
                return self._do_instead(node, branch.steps, arguments, failure)
            self._report_setback(failure)
            tries[index] -= 1
            found = self._found.pop(arguments[branch.next], None) if branch.next else None
            if found:
                why = f"it was tried first, but: {failure.cause.replace('_', ' ')}"
                self._rejected[found.percept.name] = replace(found.candidate, reason=why)
            failure = self._walk_steps(node, tree.steps, arguments)
        return None

    def _do_instead(
        self, node: str, steps: Steps, arguments: Arguments, failure: AnswerContent
    ) -> Failure:
        if self._primitives is None or self._walk_steps(node, steps, arguments):
            return failure
        self._report_setback(failure)
        return None if "/" in node else AnswerContent("did_instead", {}, "failed", failure.cause)

    def _report_setback(self, failure: AnswerContent) -> None:
        if failure not in self._setbacks:
            self._setbacks.append(failure)

    def _branch(
        self, tree: ActionTree, failure: AnswerContent, arguments: Arguments, tries: Sequence[int]
    ) -> int | None:
        if failure.cause in {outcome_answer.INTERRUPTED, outcome_answer.FORBIDDEN}:
            return None
        for index, branch in enumerate(tree.otherwise):
            is_possible = branch.is_end or bool(branch.steps) or tries[index] > 0
            if branch.next:
                found = self._found.get(arguments[branch.next])
                others = found.inference.candidates if found else ()
                worth = {each.name for each in others if each.verdict in WORTH_TRYING}
                is_possible = bool(worth - self._rejected.keys() - {found and found.percept.name})
            if is_possible and branch.handles(failure.cause):
                return None if branch.is_end else index
        return None

    def _unmet_condition(self, condition: Precondition, arguments: Arguments) -> Failure:
        argument = _value(condition.parameter, arguments)
        name, prop = named(argument) or "thing", condition.property
        if prop:
            told = self._request.contexts.get(Atom("property", prop))
            seen = self._context.search([f"property:{prop}"]) if told is None else ()
            if told is None and all(each.object != name for each in seen):
                slots = {"object": name, "property": prop}
                return AnswerContent("is_it_so", slots, "asked", "required")
            is_so = told is None or told.lower > 0
        elif self._primitives is None:  # nothing is going to be done
            return None
        elif condition.kind == "sees":
            is_so = bool(self._context.search([f"object:{named(argument)}"]))
        else:
            found = self._found.get(argument)
            is_so = found is not None and self._primitives.holding == found.percept.name
        return outcome_answer.required(condition, name) if is_so is condition.negated else None

    def _walk_steps(self, node: str, steps: Steps, arguments: Arguments) -> Failure:
        for step in steps:
            if isinstance(step, Loop):
                failure = self._repeat(node, step, arguments)
            else:
                failure = self._visit_step(node, step, arguments)
            if failure:
                return failure
        return None

    def _visit_step(self, node: str, step: TreeStep, arguments: Arguments) -> Failure:
        passed = {name: _value(each, arguments) for name, each in step.arguments.items()}
        if step.action in self._context.actions.trees:
            request = replace(self._request, arguments=passed)
            passed = review_arguments(self._context.actions, step.action, request)
        before = (self._part, self._patient)
        self._part = step.part or self._part
        self._patient = passed.get(PATIENT, self._patient)
        failure = self.visit(f"{node}/{step.action}", passed)
        self._part, self._patient = before
        return failure

    def _repeat(self, node: str, loop: Loop, arguments: Arguments) -> Failure:
        # Without a robot nothing can be sensed: one pass shows what would be done.
        for _ in range(loop.times if self._primitives else 1):
            if failure := self._walk_steps(node, loop.steps, arguments):
                return failure
            if self._primitives and loop.until in self._primitives.sensed:
                return None
        return self._primitives.not_sensed(loop.until) if self._primitives and loop.until else None

    # --- Choosing ----------------------------------------------------------------------------

    def _find(self, arguments: Arguments, seen: Sequence[Percept], inference: Inference) -> Failure:
        target = self._target(arguments)
        inference, refusal = self._without_forbidden(target, seen, inference)
        patient, best = self._patient, inference.best
        part = self._part or (self._request.agreed.get(best.object) if best else None)
        if target != patient or self.decision is None:
            # The patient of a tool may be looked for too; the decision is about the tool.
            rejected = tuple(self._rejected.values())
            self.decision = Decision(inference, None, part, named(patient), rejected)
        if refusal:
            return refusal
        if best is None and self._excluded(arguments):
            return AnswerContent("nothing_other", {}, "failed", "not_found")
        if best is None:
            return outcome_answer.not_found(target, inference)
        if outcome_answer.is_guess(best):
            return outcome_answer.guessed(target, best)
        percept = next(each for each in seen if each.name == best.name)
        self._found[target] = FoundObject(percept, best, inference)
        if self._primitives and target != patient:
            self._primitives.tool, self._primitives.patient = best.object, named(patient)
        return None

    def _without_forbidden(
        self, target: Target, percepts: Sequence[Percept], inference: Inference
    ) -> tuple[Inference, Failure]:
        seen = {each.name: each for each in percepts}
        first: Failure = None
        for index, candidate in enumerate(inference.candidates):
            if not candidate.accepted:
                break
            refusal = self._norms.of_object(inference.node, target, seen[candidate.name])
            if refusal is None:
                return replace(inference, candidates=inference.candidates[index:]), None
            first = first or refusal
        return inference, first

    def _part_to_hold(
        self, target: Target, percept: Percept, inference: Inference
    ) -> tuple[str | None, Failure]:
        wanted = self._norms.obliged_parts(inference.node, target, percept)
        part = next((self._own_part(name, percept) for name in wanted), None)
        if part and self.decision and not self._part and not self._lacks(percept, part):
            self.decision = replace(self.decision, part=inference, allowed_part=part)
        else:
            part, failure = self._choose_part(percept, inference)
            if failure:
                return part, failure
        refusal_of = partial(self._norms.of_step, inference.node, target, percept)
        known = self._allowed_parts(percept, inference)
        refusal = refusal_of(part)
        if part is None:
            refusal = refusal or next(filter(None, map(refusal_of, known)), None)
        if refusal is None or self._part:
            return part, refusal
        allowed = next((each for each in known if refusal_of(each) is None), None)
        if allowed and self.decision:
            self.decision = replace(self.decision, allowed_part=allowed)
        return allowed, None if allowed else refusal

    def _choose_part(self, percept: Percept, inference: Inference) -> tuple[str | None, Failure]:
        self.decision = decision = replace(self.decision, part=inference) if self.decision else None
        chosen = decision.chosen_part if decision else None
        if objection := self._objection(percept, inference, chosen):
            return None, objection
        if chosen:
            part = self._own_part(chosen, percept)
            if self._primitives and self._lacks(percept, part):
                return None, self._no_part("no_part", percept, part=part)
            return part, None
        if decision and inference.denied:
            allowed = next(iter(self._allowed_parts(percept, inference)), None)
            self.decision = replace(decision, allowed_part=allowed)
            return allowed, None if allowed else self._no_part("no_part_allowed", percept)
        if unsure := [each for each in inference.candidates if each.verdict == "unsure"]:
            goal = self._request.action
            return None, outcome_answer.not_sure_how(goal, percept.object, unsure[0])
        return self._context.grips.get(percept.object) if self._patient is not None else None, None

    def _objection(self, percept: Percept, inference: Inference, chosen: str | None) -> Failure:
        best, context, kind = inference.best, self._context, percept.object
        if best and outcome_answer.is_guess(best) and not self._part:
            return outcome_answer.not_sure_how(self._request.action, kind, best)
        denied = [each.argument.name for each in inference.denied if each.argument]
        if chosen in denied and not self._request.part:
            return self._no_part("forbidden_part", percept, part=chosen)
        if self.decision and self.decision.named_part:
            return None
        parts = [*filter(None, [context.grips.get(kind)]), *sorted(context.parts.get(kind, ()))]
        self._doubt = find_doubt(inference, self._affordances, kind, parts)
        if self._doubt is None:
            return None
        self._report_setback(outcome_answer.doubted(self._doubt, self._request.speaker))
        return outcome_answer.ask_about(self._doubt)

    def _no_part(self, key: str, percept: Percept, **slots: str) -> AnswerContent:
        return AnswerContent(key, {"object": percept.object, **slots}, "failed", "no_part")

    def _parts_to_move(self, other: Percept) -> tuple[str | None, ...]:
        """Return the part, None for any, by which Hilt would pick up what is in the way, if any."""
        asked, alike = self._request, self._context.vision.search([f"object:{other.object}"])
        others = frozenset(each.name for each in alike if each.name != other.name)
        target = {"object": Target(object=other.object, is_confirmed=True)}
        request = Request(PICK_UP, target, asked.speaker, None, asked.contexts, excluded=others)
        request = replace(request, momentary=asked.momentary)
        context = replace(self._context, motion=None, done=[*self._context.done], watchers=[])
        walk = TreeExecutor(context, request, is_able=False)
        failure = walk.visit(PICK_UP, request.arguments)
        part = walk.decision.chosen_part if walk.decision else None
        return (part,) if not failure and part in {None, *other.parts} else ()

    def _allowed_parts(self, percept: Percept, inference: Inference) -> list[str]:
        forbidden = {each.argument.name for each in inference.denied if each.argument}
        kinds = self._affordances.taxonomy.names_above
        known = dict.fromkeys((*percept.parts, *self._context.parts.get(percept.object, ())))
        allowed = [part for part in known if forbidden.isdisjoint(kinds("part", part))]
        grip = self._context.grips.get(percept.object)
        return sorted(allowed, key=lambda part: part != grip)

    def _lacks(self, percept: Percept, part: str) -> bool:
        known = self._context.parts.get(percept.object)
        return known is not None and part not in known and part not in percept.parts

    def _own_part(self, name: str, percept: Percept) -> str:
        kinds = self._affordances.taxonomy.names_above
        fitting = [part for part in percept.parts if name in kinds("part", part)]
        return name if name in fitting else next(iter(fitting), name)


def _value(given: str | DescribedObject, arguments: Arguments) -> Argument:
    if isinstance(given, DescribedObject):
        return Target(**vars(given))
    return given.removeprefix(FIXED) if given.startswith(FIXED) else arguments[given]


def _action(node: str) -> str:
    return node.rsplit("/", 1)[-1]
