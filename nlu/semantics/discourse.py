"""The discourse state: what a conversation mentioned so far, and can refer to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from .meaning import (
    ANY_OBJECT,
    Acknowledgement,
    AskBack,
    Command,
    Meaning,
    Misunderstanding,
    ObjectReference,
    Question,
    Rule,
    Statement,
    ToolCommand,
)
from .predicates import PredicateForm

SOMETHING = frozenset({"something", "anything"})

_HILT = PredicateForm("self")
_OBJECT_FIRST = frozenset(
    {"usesOf", "about", "see", "source", "why", "whyNot", "topic", "exceptions", "inHand"}
)
_OBJECT_SECOND = frozenset({"pass", "pickUp", "pointTo", "grasp", "use", "need", "have"})


@dataclass(frozen=True)
class Discourse:
    """The discourse state.

    Attributes:
        object: the object mentioned last.
        rule: the rule taught, corrected or applied last.
        last: the last rule, question or command, which a fragment completes.
        command: the last command, which "do it again" repeats.
        named: all objects that the last turn with any named, in order.
        pair: "the former", ..., "the latter": the last turn's objects, or two mentioned in a row.
        person: the person named last, except the speaker.
        asks_why: whether the last turn asked why a thing was held as it was, or just why.
        has_failed: whether the last turn was not understood, so that nothing can be referred to.
    """

    object: PredicateForm | None = None
    rule: Rule | None = None
    last: Rule | Question | Command | ToolCommand | None = None
    command: Command | ToolCommand | None = None
    named: tuple[PredicateForm, ...] = ()
    pair: tuple[PredicateForm, ...] = ()
    person: PredicateForm | None = None
    asks_why: bool = False
    has_failed: bool = False

    def about(self, name: str) -> Discourse:
        """Return this state after an object of this name was mentioned."""
        return self.naming(PredicateForm.named(name))

    def with_person(self, name: str) -> Discourse:
        """Return this state after a person of this name was mentioned."""
        return replace(self, person=PredicateForm.named(name), has_failed=False)

    def naming(self, *named: PredicateForm, last: PredicateForm | None = None) -> Discourse:
        """Return this state after a turn that named these objects; `last` is that of "it"."""
        pair = self.pair
        if len(named) > 1:
            pair = named
        elif self.object is not None and not set(named) <= set(pair):
            pair = (self.object, *named)
        return replace(self, object=last or tuple(named)[-1], named=named, pair=pair)

    @property
    def accessible(self) -> Discourse:
        """This state, or an empty one after a turn that failed."""
        return Discourse() if self.has_failed else self


def update_discourse(meaning: Meaning, content: PredicateForm, discourse: Discourse) -> Discourse:
    """Return the discourse state after an utterance with a meaning and a predicate form."""
    person, asks_why = discourse.person, False
    match meaning:
        case Acknowledgement() | AskBack() | Misunderstanding():
            return discourse
        case Command(recipient=str(name)) | Statement(source=str(name)):
            person = PredicateForm.named(name)
        case Question(ask="why", part=part, object=thing):
            asks_why = part is not None or thing is None
        case _:
            pass
    discourse = replace(discourse.accessible, person=person, asks_why=asks_why)
    mentioned = None if isinstance(meaning, Command) else _mentioned_object(content)
    named = tuple(dict.fromkeys(_named_objects(meaning)))
    if mentioned is not None:
        named = named if len(named) > 1 else (mentioned,)
    if named:
        discourse = discourse.naming(*named, last=mentioned)
    match meaning:
        case Statement(rules=rules):
            last = replace(rules[-1], source=None)  # what completes it are the speaker's own words
            return replace(discourse, rule=last, last=last)
        case Question(object=None, affordance=None):
            return discourse  # about Hilt or about what was just said
        case Question():
            return replace(discourse, last=meaning)
        case Command() | ToolCommand():
            return replace(discourse, last=meaning, command=meaning)
        case _:
            return discourse


def after_offer(choices: Sequence[Meaning | str], discourse: Discourse) -> Discourse:
    """Return the discourse state after meanings were offered: "it" is what they all name."""
    offered = [tuple(_named_objects(choice)) for choice in choices if not isinstance(choice, str)]
    named = offered[0] if offered else ()
    if not named or any(each != named for each in offered):
        return discourse
    discourse = discourse.accessible.naming(*dict.fromkeys(named))
    match choices:
        case (Statement(rules=(rule,)),):  # "no, by the handle" may correct it
            return replace(discourse, rule=rule, last=rule)
        case _:
            return discourse


def _named_objects(meaning: Meaning) -> Iterator[PredicateForm]:
    named: Sequence[tuple[str | None, tuple[str, ...]]] = ()
    match meaning:
        case Statement(rules=rules):
            named = [(rule.object, rule.props) for rule in rules]
        case Command(target=ObjectReference(used_for=str(use)) as target):
            uses = (PredicateForm("something"), use_form(use, target.material))
            yield _with_props(PredicateForm("usedFor", uses), target.props)
        case Command(target=ObjectReference(object=name, props=props)):
            named = [(name, props)]
        case ToolCommand(patient=name) | Question(object=name):
            named = [(name, ())]
        case _:
            pass
    for name, props in named:
        if name and name != ANY_OBJECT:
            yield _with_props(PredicateForm.named(name), props)


def _with_props(form: PredicateForm, props: tuple[str, ...]) -> PredicateForm:
    for prop in props:
        form = PredicateForm("having", (form, PredicateForm.named(prop)))
    return form


def _mentioned_object(form: PredicateForm) -> PredicateForm | None:
    if form.name == "partOf":
        return form.arguments[1]
    if form.name == "and":
        return _mentioned_object(form.arguments[-1])
    if form.name == "implies" and form.arguments[1].name != "graspObject":
        return form.arguments[0]
    within = next(filter(None, map(_mentioned_object, form.arguments)), None)
    if form.name in _OBJECT_FIRST and form.arguments and not within:
        return form.arguments[0]
    is_act = form.name in _OBJECT_SECOND or form.arguments[:1] == (_HILT,)
    if is_act and len(form.arguments) > 1:
        # Of an act with a tool it is what it is done to, if that was named.
        return next((each for each in form.arguments[1:] if each.name not in SOMETHING), None)
    return within


def use_form(use: str, material: str | None) -> PredicateForm:
    """Return the form of a use, on a material where there is one."""
    act = PredicateForm.named(use)
    if not material:
        return act
    return PredicateForm("of", (act, PredicateForm.named(material)))
