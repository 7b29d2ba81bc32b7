"""Interpretation of predicate forms as norms: what is forbidden, obliged or permitted.

    forbidden(pass(self,knife,child))
    atPlace(obliged(pass(self,knife),handle),kitchen)
    obliged(pass(self,knife),pointTo(self,knife))

A form about several objects, or a prohibition with an exception, lays down several norms.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

from . import meaning as meanings
from .discourse import Discourse
from .interpretation import Interpreter, kind_and_properties, name_of
from .meaning import ANY_OBJECT, ActionRule, Command, Meaning, Norm, Question
from .predicates import PredicateForm, UninterpretableError

_NORMS = frozenset({"forbidden", "obliged", "permitted", "beforehand", "without"})
_ANYBODY = frozenset(map(PredicateForm, ("speaker", "someone", "him", "her", "them")))


def meaning_of(intention: PredicateForm, interpreter: Interpreter, discourse: Discourse) -> Meaning:
    """Return norms, a question about them, or any other meaning; else `UninterpretableError`."""
    content = intention.arguments[-1]
    if intention.name == "wantRevise" and content.name == "correct":
        content = content.arguments[0]
    content = content.mapped(lambda part: _given_to(part, intention.arguments[0]))
    reader = _NormReader(replace(interpreter, is_general=True), discourse)
    if _is_norm(content):
        return meanings.NormStatement(tuple(dict.fromkeys(reader.norms(content))))
    if content.name == "whatForbidden":
        return Question("forbidden")
    if content.name != "isAllowed":
        return interpreter.meaning(intention, discourse)
    norm, *others = reader.norms(content.arguments[0])
    if others:
        raise UninterpretableError("one_thing_at_a_time")
    return Question("may", norm=norm)


def _is_norm(form: PredicateForm) -> bool:
    if form.name == "and":
        return all(map(_is_norm, form.arguments))
    return form.name in _NORMS or form.name in _ADDITIONS


def _given_to(form: PredicateForm, speaker: PredicateForm) -> PredicateForm | None:
    if form.name != "implies" or form.arguments[0].name != "pass":
        return None
    act, *others = form.arguments
    if len(act.arguments) < 3 or act.arguments[2] in {speaker, *_ANYBODY}:
        return None
    rule = PredicateForm("implies", (PredicateForm("pass", act.arguments[:2]), *others))
    return PredicateForm("givenTo", (rule, act.arguments[2]))


def _when_it_is(norm: Norm, thing: PredicateForm) -> Norm:
    act, (kind, props) = _command(norm.act), kind_and_properties(thing)
    if kind != act.target.object:
        raise UninterpretableError("two_objects", first=str(act.target.object), second=kind)
    props = tuple(sorted({*act.target.props, *props}))
    return replace(norm, act=replace(act, target=replace(act.target, props=props)))


def _given_to_person(norm: Norm, person: PredicateForm) -> Norm:
    act = _command(norm.act)
    if act.goal != "pass" or act.recipient:  # not "give the pedal wrench to customers"
        raise UninterpretableError("one_thing_at_a_time")
    return replace(norm, act=replace(act, recipient=name_of(person)))


_ADDITIONS: Mapping[str, Callable[[Norm, PredicateForm], Norm]] = {
    "atPlace": lambda norm, place: replace(norm, place=name_of(place)),
    "givenTo": _given_to_person,
    "whenIs": _when_it_is,
}
"""What is said of a norm besides its act."""


@dataclass(frozen=True)
class _NormReader:
    interpreter: Interpreter
    discourse: Discourse

    def norms(self, form: PredicateForm) -> Iterator[Norm]:
        """Yield the norms that a form lays down, those of several objects one after the other."""
        several = next((part for part in form if part.name == "both"), None)
        if several is not None:
            for one in several.arguments:
                yield from self.norms(form.replacing(several, one))
        elif form.name == "and":
            for each in form.arguments:
                yield from self.norms(each)
        elif form.name in _ADDITIONS:
            inner, added = form.arguments
            yield from (_ADDITIONS[form.name](norm, added) for norm in self._within(inner))
        elif len(form.arguments) == 1:
            yield self._norm(form.name, form.arguments[0])
        elif not form.arguments[1].arguments:
            yield self._norm("obliged", PredicateForm("holding", form.arguments))
        else:
            norm, other = (self._norm("obliged", each) for each in form.arguments)
            first = _command(other.act)
            if form.name == "beforehand" and first.target != _command(norm.act).target:
                raise UninterpretableError("one_thing_at_a_time")  # that is a plan for now
            name = "permitted" if form.name == "without" else "obliged"
            yield replace(norm, norm=name, before=first)

    def _within(self, form: PredicateForm) -> Iterator[Norm]:
        if form.name == "not":
            form = PredicateForm("forbidden", (form,))
        if _is_norm(form):
            yield from self.norms(form)
            return
        said = self.interpreter.meaning(PredicateForm("wantBelieve", (form,)), self.discourse)
        for rule in said.rules if isinstance(said, meanings.Statement) else ():
            usual = self.interpreter.intervals["high"]
            if not isinstance(rule, ActionRule) or not (rule.denies or rule.confidence == usual):
                raise UninterpretableError("not_a_rule")
            target = meanings.ObjectReference(rule.object, props=rule.props)
            act = Command(rule.context, target, part=rule.part)
            yield Norm("forbidden" if rule.denies else "obliged", act, usual)

    def _norm(self, name: str, form: PredicateForm) -> Norm:
        act = self.interpreter.command(form.arguments[0] if form.name == "not" else form)
        if any(part.name in {"usedFor", "notUsedFor", "other"} for part in form):
            raise UninterpretableError("norm_on_use", asks=True)
        told = act if isinstance(act, meanings.ToolCommand) and act.tool.object else None
        if told and (name == "permitted" or told.patient == ANY_OBJECT):
            raise UninterpretableError("say_the_use")
        return Norm(name, act, self.interpreter.intervals["high"])


def _command(act: meanings.SimpleCommand) -> Command:
    if not isinstance(act, Command):
        raise UninterpretableError("one_thing_at_a_time")
    return act
