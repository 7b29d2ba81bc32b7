"""Translation of the definition of an action into an action tree."""

from collections.abc import Mapping

from ...nlu.semantics import meaning
from ...ontology import actions

Names = Mapping[str, str]

PARAMETERS = ("object", "second", "third", "fourth")
"""The names of the parameters of taught actions, in order."""


def tree_from_definition(said: meaning.ActionDefinition, tool_acts: Names) -> actions.ActionTree:
    """Return the action tree of a definition.

    `tool_acts` are the acts with a tool, each with the use that its tool must have.
    """
    kinds = dict(zip(said.parameters, PARAMETERS, strict=False))
    return actions.ActionTree(
        said.action,
        tuple(kinds.values()),
        {},
        tuple(_step(each, kinds, tool_acts) for each in said.steps),
        tuple(_precondition(each, kinds) for each in said.only_if),
        tuple(_branch(each, kinds, tool_acts) for each in said.if_fails),
        objects={name: kind for kind, name in kinds.items()},
    )


def _step(act: meaning.Act, kinds: Names, tool_acts: Names) -> actions.Step:
    match act:
        case meaning.ToolCommand(goal, patient, tool):
            arguments = {"patient": _argument(meaning.ObjectReference(patient), kinds)}
            if tool != meaning.ObjectReference(used_for=tool_acts.get(goal, "")):
                arguments["tool"] = _argument(tool, kinds)
            return actions.Step(goal, arguments)
        case meaning.ActionCommand(goal, objects):
            given = (_argument(each, kinds) for each in objects)
            return actions.Step(goal, dict(zip(PARAMETERS, given, strict=False)))
        case _:
            arguments = {"object": _argument(act.target, kinds)}
            recipient = {"recipient": f"{actions.FIXED}{act.recipient}"} if act.recipient else {}
            return actions.Step(act.goal, arguments | recipient, act.part)


def _argument(said: meaning.ObjectReference, kinds: Names) -> str | actions.DescribedObject:
    if said.object and said.object in kinds and not said.props:
        return kinds[said.object]
    name = None if said.object == meaning.ANY_OBJECT else said.object
    return actions.DescribedObject(
        name, said.used_for, said.not_used_for, frozenset(said.props), said.material
    )


def _precondition(said: meaning.ActionCondition, kinds: Names) -> actions.Precondition:
    parameter = kinds.get(said.object, f"{actions.FIXED}{said.object}")
    return actions.Precondition(said.state, parameter, said.property, said.negated)


def _branch(said: meaning.FailureReaction, kinds: Names, tool_acts: Names) -> actions.FailureBranch:
    following = PARAMETERS[0] if said.other else None
    steps = tuple(_step(each, kinds, tool_acts) for each in said.steps)
    return actions.FailureBranch(frozenset(said.after), following, said.again, steps)
