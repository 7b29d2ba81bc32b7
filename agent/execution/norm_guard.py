"""The norms on one command: each object, part and step is checked before it is acted on.

An object is checked against the norms on all that its tree is going to do with it, so that nothing
is begun that must not be ended; every node is checked again when it is reached.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from ...inference.node_rules import GRASP
from ...inference.norms import ALLOWED, Act, NormChecker, NormVerdict
from ...inference.types import Target
from ...kb.interval import CERTAIN
from ...kb.rule import GRASP_OBJECT, Atom
from ...ontology.actions import Actions, iterate_steps
from ...sim.vision.percept import Percept
from .outcome import AnswerContent, Failure
from .outcome_answer import FORBIDDEN
from .request import PATIENT, TOOL, Arguments, Request, named

USE = "use"  # what is done with a tool, whatever for
_RECIPIENT = "recipient"


class NormGuard:
    """Checks what a command is going to do.

    Args:
        checker: the norms.
        request: the command.
        done: the acts so far, in order: action and type of object; it grows.
        holding: returns the type of the object in the hand.

    Attributes:
        verdicts: those that forbid something, or resolved a conflict.
    """

    def __init__(
        self,
        checker: NormChecker,
        actions: Actions,
        request: Request,
        done: list[tuple[str, str]],
        holding: Callable[[], str | None],
    ) -> None:
        self._checker = replace(checker, momentary=request.momentary, unheeded=request.unheeded)
        self._actions, self._request = actions, request
        self._done, self._holding = done, holding
        self._recipients: dict[str, str] = {}  # path of a node -> to whom something is given there
        self._arguments: Arguments = {}
        self._part = request.part  # what the object is held by, or is to be
        self.verdicts: list[NormVerdict] = []

    def enter(self, node: str, arguments: Arguments) -> Failure:
        """Take note of the arguments of a node; return why the command must not be obeyed at all.

        That is told before anything is looked for, by what the command itself names.
        """
        recipient = arguments.get(_RECIPIENT)
        if isinstance(recipient, str):
            self._recipients[node] = recipient
        if "/" in node:
            return None
        self._arguments = arguments
        targets = {each for each in arguments.values() if isinstance(each, Target)}
        acts = (
            replace(self._seen(node, self._ahead(each), each, None), part=self._request.part)
            for each in targets
        )
        return next(filter(None, (self._refused(act, is_named=True) for act in acts)), None)

    def hold_by(self, part: str | None) -> None:
        """Take note of the part by which the object is going to be held."""
        self._part = part

    def note(self, action: str, name: str) -> None:
        """Take note that an action was done with an object of this type."""
        self._done.append((action, name))

    def of_object(self, node: str, target: Target, percept: Percept) -> Failure:
        """Return why an object must not be taken for what the tree is going to do with it."""
        actions = (*self._ahead(target), *Actions.contexts(node))
        act = self._seen(node, actions, target, percept)
        return self._refused(replace(act, part=self._part))

    def of_step(
        self, node: str, target: Target, percept: Percept | None, part: str | None = None
    ) -> Failure:
        """Return why a step must not be done with the object that was found, by a part."""
        action = node.rsplit("/", 1)[-1]
        grasping = (GRASP,) if action == GRASP_OBJECT else ()
        actions = (action, *Actions.contexts(node), *grasping)
        act = self._seen(node, actions, target, percept)
        return self._refused(replace(act, part=part or self._part))

    def obliged_parts(self, node: str, target: Target, percept: Percept) -> list[str]:
        """Return the parts by one of which alone an object may be held."""
        actions = (GRASP_OBJECT, *Actions.contexts(node), GRASP)
        return self._checker.obliged_parts(self._seen(node, actions, target, percept))

    def _seen(
        self, node: str, actions: Sequence[str], target: Target, percept: Percept | None
    ) -> Act:
        name = percept.object if percept else target.object
        seen = percept.properties if percept else frozenset[str]()
        contexts = {**self._request.contexts, **dict.fromkeys(self._given(node), CERTAIN)}
        done, known = tuple(self._done), seen | target.properties
        return Act(actions, name, known, contexts=contexts, done=done, holding=self._holding())

    def _given(self, node: str) -> Iterator[Atom]:
        for path, name in self._recipients.items():
            if node == path or node.startswith(f"{path}/"):
                yield Atom("role", name.lower())
        above = self._checker.affordances.taxonomy.above
        for kind, _ in above(Atom("object", self._patient)) if self._patient else ():
            yield Atom("material", kind.name)

    @property
    def _patient(self) -> str | None:
        return named(self._arguments.get(PATIENT))

    def _ahead(self, target: Target) -> tuple[str, ...]:
        """The actions that the tree of the command is going to do with what is meant."""
        found: list[str] = []
        for parameter, value in self._arguments.items():
            if value == target:
                found += self._done_with(self._request.action, parameter)
                found += [USE] if parameter == TOOL else []
        grasping = [GRASP] if GRASP_OBJECT in found else []
        return tuple(dict.fromkeys((*found, *grasping)))

    def _done_with(self, action: str, parameter: str) -> Iterator[str]:
        """The actions that are done with a parameter of an action, the innermost first."""
        tree = self._actions.trees.get(action)
        for step in iterate_steps(tree.steps) if tree else ():
            for name, word in step.arguments.items():
                if word == parameter:
                    yield from self._done_with(step.action, name)
        yield action

    def _refused(self, act: Act, *, is_named: bool = False) -> Failure:
        """Return why an act is forbidden, or asks what is not seen (not if it `is_named` only)."""
        verdict = self._checker.judge(act)
        if verdict != ALLOWED and verdict not in self.verdicts:
            self.verdicts.append(verdict)
        if verdict.forbidding is None or (is_named and verdict.unseen):
            return None
        name = self._patient or act.object or "thing"
        slots = {"goal": self._request.action, "object": name, "norm": verdict.forbidding.id}
        if verdict.unseen:
            return AnswerContent("norm_unseen", slots, "asked", FORBIDDEN)
        return AnswerContent("forbidden", slots, "refused", FORBIDDEN)
