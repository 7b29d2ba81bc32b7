"""The norms on one command: each object, part and step is checked before it is acted on.

An object is checked against the norms on all that its tree is going to do with it, so that nothing
is begun that must not be ended; every node is checked again when it is reached.
"""

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


class NormGuard:
    """Checks what a command is going to do, after the acts so far (action, type of object)."""

    def __init__(
        self,
        checker: NormChecker,
        actions: Actions,
        request: Request,
        done: Sequence[tuple[str, str]],
        holding: Callable[[], str | None],
    ) -> None:
        self._checker = replace(checker, momentary=request.momentary, unheeded=request.unheeded)
        self._actions, self._request = actions, request
        self._done, self._holding = done, holding
        self._recipients: dict[str, str] = {}  # path of a node -> to whom something is given there
        self._arguments: Arguments = {}
        self.part = request.part  #: by what the object is held, or is going to be
        #: those that forbid something, or resolved a conflict
        self.verdicts: list[NormVerdict] = []

    def enter(self, node: str, arguments: Arguments) -> Failure:
        """Take note of the arguments of a node; return why the command must not be obeyed at all.

        That is told before anything is looked for, by what the command itself names.
        """
        if isinstance(recipient := arguments.get("recipient"), str):
            self._recipients[node] = recipient
        if "/" in node:
            return None
        self._arguments = arguments
        targets = {each for each in arguments.values() if isinstance(each, Target)}
        acts = (self._act(node, self._ahead(each), each) for each in targets)
        return next(filter(None, (self._refused(act, is_named=True) for act in acts)), None)

    def of_object(self, node: str, target: Target, percept: Percept) -> Failure:
        """Return why an object must not be taken for what the tree is going to do with it."""
        actions = (*self._ahead(target), *Actions.contexts(node))
        return self._refused(self._act(node, actions, target, percept))

    def of_step(
        self, node: str, target: Target, percept: Percept | None, part: str | None = None
    ) -> Failure:
        """Return why a step must not be done with the object that was found, by a part."""
        action = node.rsplit("/", 1)[-1]
        grasping = (GRASP,) if action == GRASP_OBJECT else ()
        actions = (action, *Actions.contexts(node), *grasping)
        return self._refused(self._act(node, actions, target, percept, part))

    def obliged_parts(self, node: str, target: Target, percept: Percept) -> list[str]:
        """Return the parts by one of which alone an object may be held."""
        actions = (GRASP_OBJECT, *Actions.contexts(node), GRASP)
        return self._checker.obliged_parts(self._act(node, actions, target, percept))

    def _act(
        self,
        node: str,
        actions: Sequence[str],
        target: Target,
        percept: Percept | None = None,
        part: str | None = None,
    ) -> Act:
        name = percept.object if percept else target.object
        seen = percept.properties if percept else frozenset[str]()
        people = self._recipients.items()
        roles = [name.lower() for path, name in people if f"{node}/".startswith(f"{path}/")]
        patient = named(self._arguments.get(PATIENT))
        materials = self._checker.affordances.taxonomy.names_above("object", patient)
        given = [*(Atom("role", each) for each in roles), *(Atom("material", m) for m in materials)]
        contexts = {**self._request.contexts, **dict.fromkeys(given, CERTAIN)}
        known = (name, seen | target.properties, part or self.part, contexts)
        return Act(actions, *known, tuple(self._done), self._holding())

    def _ahead(self, target: Target) -> tuple[str, ...]:
        found: list[str] = []
        for parameter, value in self._arguments.items():
            if value == target:
                found += self._done_with(self._request.action, parameter)
                found += [USE] if parameter == TOOL else []
        return tuple(dict.fromkeys([*found, *([GRASP] if GRASP_OBJECT in found else [])]))

    def _done_with(self, action: str, parameter: str) -> Iterator[str]:
        tree = self._actions.trees.get(action)
        for step in iterate_steps(tree.steps) if tree else ():
            for name, word in step.arguments.items():
                if word == parameter:
                    yield from self._done_with(step.action, name)
        yield action

    def _refused(self, act: Act, *, is_named: bool = False) -> Failure:
        if (verdict := self._checker.judge(act)) != ALLOWED and verdict not in self.verdicts:
            self.verdicts.append(verdict)
        if verdict.forbidding is None or (is_named and verdict.unseen):
            return None
        name = named(self._arguments.get(PATIENT)) or act.object or "thing"
        slots = {"goal": self._request.action, "object": name, "norm": verdict.forbidding.id}
        key, ending = ("norm_unseen", "asked") if verdict.unseen else ("forbidden", "refused")
        return AnswerContent(key, slots, ending, FORBIDDEN)
