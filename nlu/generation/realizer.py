"""Surface realisation: sentences for meanings, which give the same meaning when parsed.

The sentences are data (`sentences.yaml`), one for each shape of meaning: what is asked, and which
parts of it are filled. Articles, plurals and verbs come from the inflection and the lexicon.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from ...ontology.errors import UnknownNameError
from ...ontology.yaml_reader import read_yaml
from ..semantics import meaning
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

    def realize(self, said: meaning.Meaning) -> str:  # noqa: PLR0911 - a case per kind
        """Return a sentence without capital and full stop; `UnknownNameError` if there is none."""
        match said:
            case meaning.Statement(rules) | meaning.KindStatement(rules):
                text = self._say("rules", "several").join(map(self._rule, rules))
                revises = any(rule.revises for rule in rules)
                return self._say("rules", "revised", rule=text) if revises else text
            case meaning.Command() | meaning.ToolCommand():
                return self._command(said)
            case meaning.ActionCommand(goal, objects):
                things = self.answers.join([self._target(each) for each in objects])
                return f"{self.answers.act(goal)} {things}".rstrip()
            case meaning.Plan(steps):
                return f"{self._say('rules', 'then')} ".join(map(self.realize, steps))
            case meaning.ActionDefinition(only_if=(), if_fails=()):
                things = self.answers.act_on(said.action, *said.parameters, links=said.all_links)
                steps = self.realize(meaning.Plan(said.steps))
                return self._say("rules", "way", action=things, steps=steps)
            case meaning.NormStatement(norms):
                texts = (self.answers.norm_phrase(n, self._say("rules", "hearer")) for n in norms)
                return self._say("rules", "several").join(texts)
            case meaning.Question():
                return self._question(said)
            case meaning.Retraction():
                return self._retraction(said)
            case meaning.TopicStatement(name):
                return self._say("rules", "topic", object=name)
            case meaning.TrustStatement(people, distrusted):
                key = "distrusted" if distrusted else "trusted"
                return self._say("rules", key, speakers=people)
            case meaning.Acknowledgement(ack):
                return self._say("replies", ack)
            case _:
                raise UnknownNameError("sentence for", said.kind, SECTIONS)

    def _retraction(self, said: meaning.Retraction) -> str:
        if said.about == meaning.ANY_OBJECT:
            return self._say("rules", "all_taken_back")
        rule = self._rule(said.rule, reported=True) if said.rule else None
        slots = _given({"part": said.part, "rule": rule, "object": said.about})
        return self._say("rules", " ".join(["taken_back", *slots]), **slots)

    def _rule(self, rule: meaning.Rule | meaning.KindRelation, *, reported: bool = False) -> str:
        if rule.source:
            text = self._rule(replace(rule, source=None), reported=True)
            return self._say("rules", "told", source=rule.source, rule=text)
        if isinstance(rule, meaning.KindRelation):
            return self.answers.kind_phrase(rule)
        adverbs = self.answers.adverbs
        if rule.confidence not in adverbs:
            known = [f"[{lower:g}, {upper:g}]" for lower, upper in adverbs]
            raise UnknownNameError("word for the confidence", str(list(rule.confidence)), known)
        thing = self.answers.noun_phrase(rule.object, rule.props)
        slots = {"often": adverbs[rule.confidence], "thing": thing}
        if isinstance(rule, meaning.FunctionalRule):
            use = self.answers.use_phrase(rule.affordance, rule.material)
            return self._say("rules", "functional", affordance=use, **slots)
        slots |= {"part": rule.part, "act": self.answers.act_with(rule.context)}
        return self._say("rules", "reported" if reported else "action", **slots)

    def _command(self, command: meaning.SimpleCommand) -> str:
        slots = {"act": self.answers.act(command.goal)}
        if isinstance(command, meaning.ToolCommand):
            shape = ["patient"]
            slots["patient"] = command.patient
            needed = self.answers.words.tool_acts.get(command.goal, "")
            if command.tool != meaning.ObjectReference(used_for=needed):
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

    def _target(self, target: meaning.ObjectReference) -> str:
        names = ("object", "used_for", "not_used_for")
        slots = _given({name: getattr(target, name) for name in names})
        (shape,) = slots
        if target.object is None:
            slots[shape] = self.answers.use_phrase(slots[shape], target.material)
        if target.object == meaning.ANY_OBJECT:
            shape = "props"
        return self._say("targets", shape, props=" ".join(target.props), **slots)

    def _question(self, question: meaning.Question) -> str:
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
        name: {key: each.text() for key, each in field.entries().items()}
        for name, field in sections.items()
    }
    return Realizer(sentences, answers)


def _given(slots: Mapping[str, str | None]) -> dict[str, str]:
    return {name: value for name, value in slots.items() if value is not None}
