"""Surface realisation: sentences for meanings, which give the same meaning when parsed.

The sentences are data (`sentences.yaml`), one for each shape of meaning: what is asked, and which
parts of it are filled. Articles, plurals and verbs come from the inflection and the lexicon.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from ...ontology.errors import UnknownNameError
from ...ontology.yaml_reader import read_yaml
from ..semantics.meaning import (
    ANY_OBJECT,
    Acknowledgement,
    ActionCommand,
    ActionDefinition,
    Command,
    Confidence,
    FunctionalRule,
    KindRelation,
    KindStatement,
    Meaning,
    ObjectReference,
    Plan,
    Question,
    Retraction,
    Rule,
    Statement,
    ToolCommand,
    TopicStatement,
    TrustStatement,
)
from .templates import AnswerTemplates, Slot

SECTIONS = ("rules", "targets", "commands", "questions", "replies")


@dataclass(frozen=True)
class Realizer:
    """The sentences of one language for meanings, by section and by the shape of the meaning.

    `answers` says how things and acts are called; `giving` is the act that has a recipient.
    """

    sentences: Mapping[str, Mapping[str, str]]
    answers: AnswerTemplates
    giving: str = "pass"

    def realize(self, meaning: Meaning) -> str:  # noqa: PLR0911 - a case per kind
        """Return a sentence without capital and full stop; `UnknownNameError` if there is none."""
        match meaning:
            case Statement(rules):
                text = self._say("rules", "several").join(map(self._rule, rules))
                revises = any(rule.revises for rule in rules)
                return self._say("rules", "revised", rule=text) if revises else text
            case Command() | ToolCommand():
                return self._command(meaning)
            case ActionCommand(goal, objects):
                things = self.answers.join([self._target(each) for each in objects])
                return f"{self.answers.act(goal)} {things}".rstrip()
            case Plan(steps):
                return f"{self._say('rules', 'then')} ".join(map(self.realize, steps))
            case ActionDefinition(only_if=(), if_fails=()):
                action, kinds, links = meaning.action, meaning.parameters, meaning.all_links
                things = self.answers.act_on(action, *kinds, links=links)
                steps = self.realize(Plan(meaning.steps))
                return self._say("rules", "way", action=things, steps=steps)
            case Question():
                return self._question(meaning)
            case KindStatement(rules):
                return self._say("rules", "several").join(map(self._rule, rules))
            case Retraction() | TopicStatement():
                return self._turn(meaning)
            case TrustStatement(people, distrusted):
                key = "distrusted" if distrusted else "trusted"
                return self._say("rules", key, speakers=people)
            case Acknowledgement(ack):
                return self._say("replies", ack)
            case _:
                raise UnknownNameError("sentence for", meaning.kind, SECTIONS)

    def _turn(self, meaning: Retraction | TopicStatement) -> str:
        match meaning:
            case TopicStatement(name):
                return self._say("rules", "topic", object=name)
            case Retraction(part=str(part)):
                return self._say("rules", "taken_back_part", part=part)
            case Retraction(about=None, rule=None):
                return self._say("rules", "last_taken_back")
            case Retraction(rule) if rule is not None:
                return self._say("rules", "taken_back", rule=self._rule(rule, reported=True))
            case Retraction(about=name) if name and name != ANY_OBJECT:
                return self._say("rules", "taken_back_about", object=name)
            case _:
                return self._say("rules", "all_taken_back")

    def _rule(self, rule: Rule | KindRelation, *, reported: bool = False) -> str:
        if rule.source:
            text = self._rule(replace(rule, source=None), reported=True)
            return self._say("rules", "told", source=rule.source, rule=text)
        if isinstance(rule, KindRelation):
            return self.answers.kind_phrase(rule)
        thing = self.answers.noun_phrase(rule.object, rule.props)
        slots = {"often": self._often(rule.confidence), "thing": thing}
        if isinstance(rule, FunctionalRule):
            use = self.answers.use_phrase(rule.affordance, rule.material)
            return self._say("rules", "functional", affordance=use, **slots)
        slots |= {"part": rule.part, "act": self.answers.act_with(rule.context)}
        return self._say("rules", "reported" if reported else "action", **slots)

    def _often(self, confidence: Confidence) -> str:
        adverbs = self.answers.adverbs
        if confidence not in adverbs:
            known = [f"[{lower:g}, {upper:g}]" for lower, upper in adverbs]
            raise UnknownNameError("word for the confidence", str(list(confidence)), known)
        return adverbs[confidence]

    def _command(self, command: Command | ToolCommand) -> str:
        slots = {"act": self.answers.act(command.goal)}
        if isinstance(command, ToolCommand):
            shape = ["patient"]
            slots["patient"] = command.patient
            needed = self.answers.words.tool_acts.get(command.goal, "")
            if command.tool != ObjectReference(used_for=needed):
                shape.append("tool")
                slots["target"] = self._target(command.tool)
        else:
            slots |= _given({"part": command.part, "recipient": command.recipient})
            shape = ["give" if command.goal == self.giving else "act", *sorted(slots)[1:]]
            slots["target"] = self._target(command.target)
        text = self._say("commands", " ".join(shape), **slots)
        if not command.negated:
            return text
        return self._say("commands", "negated part" if "part" in slots else "negated", command=text)

    def _target(self, target: ObjectReference) -> str:
        names = ("object", "used_for", "not_used_for")
        slots = _given({name: getattr(target, name) for name in names})
        (shape,) = slots
        if target.object is None:
            slots[shape] = self.answers.use_phrase(slots[shape], target.material)
        if target.object == ANY_OBJECT:
            shape = "props"
        return self._say("targets", shape, props=" ".join(target.props), **slots)

    def _question(self, question: Question) -> str:
        filled = vars(question)
        slots = _given({name: filled[name] for name in filled.keys() - {"ask", "material"}})
        if question.affordance:
            slots["affordance"] = self.answers.use_phrase(question.affordance, question.material)
        return self._say("questions", " ".join([question.ask, *sorted(slots)]), **slots)

    def _say(self, section: str, shape: str, **slots: Slot) -> str:
        templates = self.sentences[section]
        if shape not in templates:
            raise UnknownNameError(f"sentence among the {section}", shape, templates)
        text = self.answers.fill(templates[shape], slots)
        return " ".join(text.split()).replace(" ,", ",") if text.strip(" .") else text


def load_realizer(path: Path, answers: AnswerTemplates) -> Realizer:
    """Load the sentences of a language; `DataError` says where the file is not as expected."""
    sections = read_yaml(path).entries(required=SECTIONS, optional=())
    sentences = {
        name: MappingProxyType({key: each.text() for key, each in field.entries().items()})
        for name, field in sections.items()
    }
    return Realizer(MappingProxyType(sentences), answers)


def _given(slots: Mapping[str, str | None]) -> dict[str, str]:
    return {name: value for name, value in slots.items() if value is not None}
