"""Translation of the definition of an action into an action tree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...nlu.semantics.meaning import (
    ANY_OBJECT,
    Act,
    ActionCommand,
    ActionCondition,
    ActionDefinition,
    FailureReaction,
    ObjectReference,
    ToolCommand,
)
from ...ontology.actions import (
    FIXED,
    ActionTree,
    DescribedObject,
    FailureBranch,
    Precondition,
    Step,
)

Names = Mapping[str, str]

PARAMETERS = ("object", "second", "third", "fourth")
"""The names of the parameters of taught actions, in order."""


def tree_from_definition(said: ActionDefinition, tool_acts: Names) -> ActionTree:
    """Return the action tree of a definition.

    `tool_acts` are the acts with a tool, each with the use that its tool must have.
    """
    kinds = dict(zip(said.parameters, PARAMETERS, strict=False))
    return ActionTree(
        said.action,
        tuple(kinds.values()),
        {},
        _steps(said.steps, kinds, tool_acts),
        tuple(_precondition(each, kinds) for each in said.only_if),
        tuple(_branch(each, kinds, tool_acts) for each in said.if_fails),
        objects={name: kind for kind, name in kinds.items()},
    )


def _steps(acts: Sequence[Act], kinds: Names, tool_acts: Names) -> tuple[Step, ...]:
    return tuple(_step(each, kinds, tool_acts) for each in acts)


def _step(act: Act, kinds: Names, tool_acts: Names) -> Step:
    """The step that a command is; a tool that nobody named is left to the tree of the act."""
    match act:
        case ToolCommand(goal, patient, tool):
            arguments = {"patient": _argument(ObjectReference(patient), kinds)}
            if tool != ObjectReference(used_for=tool_acts.get(goal, "")):
                arguments["tool"] = _argument(tool, kinds)
            return Step(goal, arguments)
        case ActionCommand(goal, objects):
            given = (_argument(each, kinds) for each in objects)
            return Step(goal, dict(zip(PARAMETERS, given, strict=False)))
        case _:
            arguments = {"object": _argument(act.target, kinds)}
            recipient = {"recipient": f"{FIXED}{act.recipient}"} if act.recipient else {}
            return Step(act.goal, arguments | recipient, act.part)


def _argument(said: ObjectReference, kinds: Names) -> str | DescribedObject:
    if said.object and said.object in kinds and not said.props:
        return kinds[said.object]
    name = None if said.object == ANY_OBJECT else said.object
    return DescribedObject(
        name, said.used_for, said.not_used_for, frozenset(said.props), said.material
    )


def _precondition(said: ActionCondition, kinds: Names) -> Precondition:
    parameter = kinds.get(said.object, f"{FIXED}{said.object}")
    return Precondition(said.state, parameter, said.property, said.negated)


def _branch(said: FailureReaction, kinds: Names, tool_acts: Names) -> FailureBranch:
    following = PARAMETERS[0] if said.other else None
    steps = _steps(said.steps, kinds, tool_acts)
    return FailureBranch(frozenset(said.after), following, said.again, steps)
