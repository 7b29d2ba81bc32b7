"""A request for a goal, and the review of its arguments (paper, section 4.2)."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from ...inference.types import Conclusion, Target
from ...kb.interval import Interval
from ...kb.rule import Atom, Rule
from ...ontology.actions import Actions, ArgumentByAffordance
from .outcome import GoalResult

Argument = Target | str
Arguments = Mapping[str, Argument]  # by the name of the parameter
TOOL, PATIENT = "tool", "patient"


def named(argument: Argument | None) -> str | None:
    """Return the kind of object that an argument names, or the name that it is."""
    return argument.object if isinstance(argument, Target) else argument


@dataclass(frozen=True)
class Request:
    """A goal with what the speaker said about it."""

    action: str  #: the action tree ("pass")
    arguments: Arguments  #: parameter -> the object that is meant, or a name
    speaker: str
    part: str | None = None  #: the part to act on, when the command itself names it
    #: what else holds now, with the interval to which it holds
    contexts: Mapping[Atom, Interval] = field(default_factory=dict[Atom, Interval])
    #: the parameters that nobody mentioned; a default of the tree takes precedence
    assumed: frozenset[str] = frozenset()
    #: the names of the objects that were chosen before, when another one is wanted
    excluded: frozenset[str] = frozenset()
    #: kind of object -> the part that was agreed on, when Hilt asked
    agreed: Mapping[str, str] = field(default_factory=dict[str, str])
    momentary: tuple[Rule, ...] = ()  #: norms that hold for this conversation only
    #: the ids of norms that the speaker may lift, and has lifted for this request
    unheeded: frozenset[str] = frozenset()

    def confirmed(self, result: GoalResult) -> "Request | None":
        """Return this request for the object or part that Hilt asked about, after a "yes"."""
        if result.answer.ending != "asked":
            return None
        if norm := result.forbidding and result.forbidding.forbidding:
            return replace(self, unheeded=self.unheeded | {norm.id})
        candidates = result.decision.object.candidates if result.decision else ()
        if not candidates:
            return None
        if "part" in result.answer.slots:
            return replace(self, part=str(result.answer.slots["part"]))
        return self._about(Target(object=candidates[0].object, is_confirmed=True))

    def choosing(self, name: str | None, props: Iterable[str], result: GoalResult) -> "Request":
        """Return this request for what was named when Hilt asked about an object or a part.

        Without a name it is the object first meant, with these properties.
        """
        if name and result.decision and result.decision.part:
            return replace(self, part=name)
        if name:
            return self._about(Target(object=name, properties=frozenset(props)))
        meant = self.arguments.get(self._chosen)
        target = meant if isinstance(meant, Target) else Target()
        return self._about(replace(target, properties=target.properties | frozenset(props)))

    def name(self, parameter: str) -> str:
        """Return the kind of object that an argument names."""
        return named(self.arguments.get(parameter)) or "thing"

    def told(self, result: GoalResult, *, is_so: bool) -> "Request | None":
        """Return this request after Hilt asked whether an object has a property; None otherwise."""
        if result.answer.key != "is_it_so":
            return None
        atom = Atom("property", str(result.answer.slots["property"]))
        interval = Interval(1.0, 1.0) if is_so else Interval(0.0, 0.0)
        return replace(self, contexts={**self.contexts, atom: interval})

    @property
    def _chosen(self) -> str:
        return TOOL if TOOL in self.arguments or PATIENT in self.arguments else "object"

    def _about(self, target: Target) -> "Request":
        arguments = {**self.arguments, self._chosen: target}
        return replace(self, arguments=arguments, assumed=self.assumed - {self._chosen})


def review_arguments(actions: Actions, tree: str, request: Request) -> dict[str, Argument]:
    """Return all arguments of a tree: those of the request, then the defaults of the tree.

    What a command leaves unsaid is filled in here: "pound the nail" needs a tool for pounding.
    """
    arguments = dict(request.arguments)
    for parameter, default in actions.tree(tree).defaults.items():
        if parameter not in arguments or parameter in request.assumed:
            arguments[parameter] = _default(default, arguments, request.speaker)
    return arguments


def _default(default: str | ArgumentByAffordance, arguments: Arguments, speaker: str) -> Argument:
    if not isinstance(default, ArgumentByAffordance):
        return speaker
    argument = Atom.parse(default.argument) if default.argument else None
    if argument is not None and argument.kind == "affordance":
        return Target(used_for=argument.name, material=named(arguments.get(PATIENT)))
    if default.of and (name := named(arguments.get(default.of))):
        argument = Atom("object", name)
    return Target(affords=Conclusion(default.functor, argument))
