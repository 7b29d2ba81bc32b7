"""The discourse state: what a conversation mentioned so far, and can refer to."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from . import meaning as meanings
from .meaning import ANY_OBJECT, Command, Meaning, ObjectReference, Question, Retraction, Statement
from .predicates import PredicateForm

THIRD_PERSON = frozenset({"it", "its", "them", "they", "their"})
SOMETHING = frozenset({"something", "anything"})


@dataclass(frozen=True)
class Discourse:
    """The discourse state; fragments complete `last`."""

    object: PredicateForm | None = None  # the object mentioned last
    rule: meanings.Rule | None = None  # the rule taught, corrected or applied last
    last: meanings.Rule | Question | meanings.SimpleCommand | meanings.Norm | None = None
    command: meanings.SimpleCommand | None = None  # the last command, which "do it again" repeats
    named: tuple[PredicateForm, ...] = ()  # all objects that the last turn with any named, in order
    pair: tuple[PredicateForm, ...] = ()  # the last turn's objects, or two in a row
    person: PredicateForm | None = None  # the person named last, except the speaker
    spoken: tuple[tuple[str, str], ...] = ()  # roles and names of acts and uses in a failed turn
    asks_why: bool = False  # whether the last turn asked why a thing was held so, or just why
    is_offered: bool = False  # whether `rule` was only offered as what may have been meant
    has_failed: bool = False  # whether the last turn was not understood: nothing is referred to
    has_unknown: bool = False  # whether such a turn has unknown words, which may name something

    def about(self, name: str) -> "Discourse":
        """Return this state after an object of this name was mentioned."""
        return self.naming(PredicateForm.named(name))

    def with_person(self, name: str) -> "Discourse":
        """Return this state after a person of this name was mentioned."""
        return replace(self, person=PredicateForm.named(name), has_failed=False)

    def naming(self, *named: PredicateForm, last: PredicateForm | None = None) -> "Discourse":
        """Return this state after a turn that named these objects; `last` is that of "it"."""
        pair = self.pair
        if len(named) > 1:
            pair = named
        elif self.object is not None and not set(named) <= set(pair):
            pair = (self.object, *named)
        return replace(self, object=last or tuple(named)[-1], named=named, pair=pair)

    @property
    def accessible(self) -> "Discourse":
        """This state without what only offers refer to: an empty one after a turn that failed."""
        return Discourse() if self.has_failed else replace(self, spoken=())


def update_discourse(meaning: Meaning, content: PredicateForm, discourse: Discourse) -> Discourse:
    """Return the discourse state after an utterance with a meaning and a predicate form."""
    person, asks_why = discourse.person, False
    match meaning:
        case meanings.Acknowledgement() | meanings.AskBack() | meanings.Misunderstanding():
            return discourse
        case Command(recipient=str(name)) | Statement(source=str(name)):
            person = PredicateForm.named(name)
        case Question(ask="why", part=part, object=thing):
            asks_why = part is not None or thing is None
        case _:
            pass
    discourse = replace(discourse.accessible, person=person, asks_why=asks_why, is_offered=False)
    named = list(_named_objects(meaning))
    if isinstance(meaning, Question) and meaning.ask != "state":
        # It names a kind, but "it" is "the red mug".
        described = [part for part in content if part.name == "having"]
        named = [next((part for part in described if each in part), each) for each in named]
    if named:
        discourse = discourse.naming(*dict.fromkeys(named), last=named[-1])
    match meaning:
        case Statement(rules=rules):
            last = replace(rules[-1], source=None)  # what completes it are the speaker's own words
            return replace(discourse, rule=last, last=last)
        case Question() if meaning.object or meaning.affordance:
            return replace(discourse, last=meaning)
        case meanings.NormStatement(norms=(norm,)):
            name = getattr(norm.act, "recipient", None)
            return replace(discourse.with_person(name) if name else discourse, last=norm)
        case Command() | meanings.ToolCommand():
            return replace(discourse, last=meaning, command=meaning)
        case _:  # also a question about Hilt or about what was just said
            return discourse


def after_offer(choices: Sequence[Meaning | str], discourse: Discourse) -> Discourse:
    """Return the discourse state after an offer: "it" is what all choices with a name have.

    As long as it is open which of several choices was meant, no fragment completes any of them.
    """
    offered = [tuple(_named_objects(choice)) for choice in choices if not isinstance(choice, str)]
    named = next(filter(None, offered), ())
    if not named or any(each not in {named, ()} for each in offered):
        return discourse
    discourse = discourse.accessible.naming(*dict.fromkeys(named))
    match choices:
        case (_, _, *_):
            return replace(discourse, rule=None, last=None)
        case (Statement(rules=(rule,)),):  # "no, by the handle" may correct it
            return replace(discourse, rule=rule, last=rule, is_offered=True)
        case (Question() as asked,):  # "and when you pass it?"
            return replace(discourse, last=asked, is_offered=True)
        case _:
            return discourse


def _named_objects(meaning: Meaning) -> Iterator[PredicateForm]:
    for named in _references(meaning):
        form = PredicateForm.named((named.object or ANY_OBJECT).replace(ANY_OBJECT, "something"))
        if named.used_for:
            form = PredicateForm("usedFor", (form, use_form(named.used_for, named.material)))
        for prop in named.props:
            form = PredicateForm("having", (form, PredicateForm.named(prop)))
        if form.name not in SOMETHING:
            yield form


def _references(meaning: Meaning) -> Iterator[ObjectReference]:
    match meaning:
        case Statement(rules=rules) | meanings.KindStatement(rules=rules):
            yield from (ObjectReference(rule.object, props=rule.props) for rule in rules)
        case Retraction(rule=rule) if rule:
            yield ObjectReference(rule.object, props=rule.props)
        case meanings.NormStatement(norms=norms):
            for norm in norms:
                yield from _references(norm.act)
        case Question(among=tuple(names)):
            yield from map(ObjectReference, names)
        case Question(norm=meanings.Norm(act=act)):
            yield from _references(act)
        case Question(ask="how" | "see", affordance=str(use), material=material):
            yield ObjectReference(used_for=use, material=material)
        case (
            Question(object=str(name)) | meanings.TopicStatement(name) | Retraction(about=str(name))
        ):
            yield ObjectReference(name)
        case Command(target=thing) if not thing.not_used_for:
            yield thing
        case meanings.ToolCommand(patient=name):
            yield ObjectReference(name)
        case _:
            pass


def use_form(use: str, material: str | None) -> PredicateForm:
    """Return the form of a use, on a material where there is one."""
    act = PredicateForm.named(use)
    return act if not material else PredicateForm("of", (act, PredicateForm.named(material)))
