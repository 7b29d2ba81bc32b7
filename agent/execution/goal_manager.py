# SPDX-License-Identifier: Apache-2.0
"""The goal manager: a request becomes a walk of its action tree, and the walk an answer.

Arguments are reviewed before the walk (paper, section 4.2): what the command left unsaid is filled
in from the tree's defaults, so "pound the nail" looks for something used for pounding. The walk
itself is in `walk`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ...inference.affordance import FIND, Affordances
from ...inference.types import Conclusion, Target
from ...kb.interval import Interval
from ...kb.rule import Atom
from ...ontology.actions import Actions, Affords
from ..protocols import Motion, Vision
from . import answers
from .outcome import GoalResult, SpokenAnswer, WalkStep
from .tree_executor import Argument, Walk

TOOL, PATIENT = "tool", "patient"


@dataclass(frozen=True)
class Request:
    """A goal with what the speaker said about it.

    Attributes:
        action: the tree ("pass").
        arguments: parameter -> the thing meant, or a name.
        speaker: who asked.
        part: the part to act on, when the command itself names it.
        contexts: what else holds now, with how surely.
        assumed: the parameters that nobody spoke of; a default of the tree goes before them.
    """

    action: str
    arguments: Mapping[str, Argument]
    speaker: str
    part: str | None = None
    contexts: Mapping[Atom, Interval] = field(default_factory=dict[Atom, Interval])
    assumed: frozenset[str] = frozenset()

    def settled_on(self, came: GoalResult) -> Request | None:
        """This request about the likeliest thing or part, once its speaker has said yes to it."""
        decision = came.decision
        is_asked = came.answer.ending == "asked"
        if not is_asked or decision is None or not decision.object.candidates:
            return None
        if decision.object.best:
            return replace(self, part=str(came.answer.slots["part"]))
        likeliest = Target(object=decision.object.candidates[0].object, is_confirmed=True)
        parameter = TOOL if TOOL in self.arguments or PATIENT in self.arguments else "object"
        arguments = {**self.arguments, parameter: likeliest}
        return replace(self, arguments=arguments, assumed=self.assumed - {parameter})


class GoalManager:
    """Carries out goals by walking their action trees.

    Args:
        actions: the trees.
        affordances: inference over the rules.
        vision: the eyes.
        motion: the hands; None decides but does not move.
        grips: object -> the part that is made for holding it, by which a tool is taken when
            nobody has said by which.
        parts: object -> its parts, as far as they are known; the hands do not look for others.

    Attributes:
        watchers: called at every node of a walk before its action is done, when
            `WalkStep.action` is still empty, and again afterwards.
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
    ) -> None:
        self.grips = grips or {}
        self.parts = parts or {}
        self.actions = actions
        self.affordances = affordances
        self.vision = vision
        self.motion = motion
        self.watchers: list[Callable[[WalkStep], None]] = []

    def achieve(self, request: Request) -> GoalResult:
        """Walk the tree of a goal to its end, or to its first failure that no branch mends.

        Raises:
            UnknownNameError: there is no tree of that name.
        """
        tree = self.actions.tree(request.action)
        arguments = self.reviewed(tree.name, request)
        unable = self._unable(tree.name)
        walk = Walk(self, request, motion=None if unable else self.motion)
        failure = walk.visit(tree.name, arguments)
        answer = failure or self._answer(walk, request, str(arguments.get("recipient", "")), unable)
        steps, world = tuple(walk.steps), walk.world
        return GoalResult(answer, walk.decision, steps, world, tuple(walk.setbacks))

    def reviewed(self, tree: str, request: Request) -> dict[str, Argument]:
        """All arguments of a tree: those said, then the tree's defaults (argument review)."""
        arguments = dict(request.arguments)
        for parameter, default in self.actions.tree(tree).defaults.items():
            if parameter not in arguments or parameter in request.assumed:
                arguments[parameter] = _default(default, arguments, request.speaker)
        return arguments

    def _answer(
        self, walk: Walk, request: Request, recipient: str, unable: Sequence[str]
    ) -> SpokenAnswer:
        if walk.decision is None:  # a tree that looks for nothing
            return SpokenAnswer("okay")
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


def _default(default: str | Affords, arguments: Mapping[str, Argument], speaker: str) -> Argument:
    if not isinstance(default, Affords):
        return speaker
    argument = Atom.parse(default.argument) if default.argument else None
    if argument is not None and argument.kind == "affordance":
        return Target(used_for=argument.name)
    of = arguments.get(default.of) if default.of else None
    name = of.object if isinstance(of, Target) else of
    if name:
        argument = Atom("object", name)
    return Target(affords=Conclusion(default.functor, argument))
