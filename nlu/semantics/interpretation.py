# SPDX-License-Identifier: Apache-2.0
"""From a predicate form to its meaning: rules, commands, corrections and replies.

A form that does not say exactly one thing Hilt can mean is refused with a reason; nothing is left
out of a form to make it fit. Questions are in `questions`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ..lexicon.vocabulary import NewWord
from .coreference import SOMETHING, Discourse, RefusedError
from .meaning import (
    ANY_OBJECT,
    Acknowledgement,
    ActionRule,
    Command,
    Confidence,
    FunctionalRule,
    Meaning,
    ObjectReference,
    Retraction,
    Rule,
    Statement,
    ToolCommand,
)
from .predicates import Form

GOALS = ("pass", "pickUp", "pointTo", "grasp", "use")

_NAMELESS = frozenset({"self", "speaker", "someone", "it", "both", "butNot"})


@dataclass(frozen=True)
class Interpreter:
    """What the forms of a language may mean.

    Attributes:
        intervals: the interval of each degree of confidence.
        tool_acts: acts done with a tool, each with the affordance that the tool must have.
        acts: further acts on one object that were learned.
    """

    intervals: Mapping[str, Confidence]
    tool_acts: Mapping[str, str]
    acts: frozenset[str] = frozenset()

    def knowing(self, words: Sequence[NewWord]) -> Interpreter:
        """This interpreter with the acts that new words name."""
        acts = {word.word for word in words if word.role == "context"}
        return replace(self, acts=self.acts | acts) if acts else self

    def statement(self, form: Form) -> Statement:
        """The rules that a form states."""
        rules = tuple(dict.fromkeys(self.rules(form)))
        if len({replace(rule, confidence=(0, 1)) for rule in rules}) < len(rules):
            raise RefusedError("contradiction", asks=True)
        return Statement(rules)

    def rules(self, form: Form) -> Iterator[Rule]:
        """Each rule of a form, in the order they were said."""
        if form.name == "and":
            for part in form.arguments:
                yield from self.rules(part)
        elif form.name != "implies":
            raise RefusedError("not_a_rule")
        elif form.arguments[1].name == "graspObject":
            yield self._action_rule(form)
        else:
            yield self._functional_rule(form)

    def correction(self, form: Form, discourse: Discourse) -> Meaning:
        """What takes the place of a rule, or is taken back."""
        if form.name == "retract":
            if not form.arguments:
                return Retraction()
            return Retraction(self._one_rule(form.arguments[0]))
        if form.name == "correct" and form.arguments[0].name in {"implies", "and"}:
            rules = self.rules(form.arguments[0])
            return Statement(tuple(replace(rule, revises=True) for rule in rules))
        if form.name in {"correctDegree", "correctObject", "correctUse"}:
            return Statement((self._corrected(form, discourse),))
        return Statement((_other_part(form, discourse),))

    def likewise(self, form: Form, discourse: Discourse) -> Statement:
        """The last rule, of another object, use or part: "the same goes for spoons"."""
        rule = discourse.rule
        if rule is None:
            raise RefusedError("nothing_to_correct", asks=True)
        one, *degree = form.arguments
        if form.name == "alsoBy":
            rule = _other_part(Form("alsoBy", (one,)), discourse)
        elif form.name == "alsoFor":
            if not isinstance(rule, FunctionalRule):
                raise RefusedError("not_a_rule")
            rule = replace(rule, affordance=self.affordance(one))
        else:
            name, props = object_of(one)
            rule = replace(rule, object=name, props=props)
        sure = self.intervals[degree[0].name] if degree else rule.confidence
        return Statement((replace(rule, confidence=sure, revises=False),))

    def command(self, form: Form) -> Command | ToolCommand:
        """The act that a form asks for, or forbids."""
        if form.name == "not":
            return replace(self.command(form.arguments[0]), negated=True)
        if form.name == "holding":
            return self._held(form)
        if form.name == "graspObject":
            part, target = self._place(form.arguments[1])
            return Command("grasp", target, part=part)
        if form.name in self.tool_acts:
            return self._tool_command(form)
        if form.name not in GOALS and form.name not in self.acts:
            raise RefusedError("one_thing_at_a_time")
        if len(form.arguments) > (3 if form.name == "pass" else 2):
            raise RefusedError("one_thing_at_a_time")
        return Command(form.name, self.target(form.arguments[1]), recipient=_recipient(form))

    def target(self, form: Form) -> ObjectReference:
        """What an act is about."""
        props: set[str] = set()
        used_for: list[Form] = []
        while form.name in {"having", "usedFor", "notUsedFor"}:
            if form.name == "having":
                props.add(name_of(form.arguments[1]))
            else:
                used_for.append(form)
            form = form.arguments[0]
        return self._target(form, used_for, tuple(sorted(props)))

    def affordance(self, form: Form) -> str:
        """The use that a form names; what it is used on may be left unsaid."""
        if form.name == "of":
            form = form.arguments[0]
        if form.arguments:
            raise RefusedError("one_use_at_a_time")
        return name_of(form)

    def _target(self, noun: Form, used_for: list[Form], props: tuple[str, ...]) -> ObjectReference:
        if len(used_for) > 1 or (used_for and noun.name not in SOMETHING):
            raise RefusedError("object_or_use")
        if used_for:
            affordance = self.affordance(used_for[0].arguments[1])
            if used_for[0].name == "usedFor":
                return ObjectReference(used_for=affordance, props=props)
            return ObjectReference(not_used_for=affordance, props=props)
        if noun.name in SOMETHING and not props:
            raise RefusedError("which_thing", asks=True)
        return ObjectReference(object=object_of(noun)[0], props=props)

    def _held(self, form: Form) -> Command:
        command = self.command(form.arguments[0])
        place = form.arguments[1]
        if not isinstance(command, Command):
            raise RefusedError("one_thing_at_a_time")
        if place.name == "graspObject":
            place = place.arguments[1]
        if place.name != "partOf":
            return replace(command, part=name_of(place))
        part, target = self._place(place)
        if target != command.target:
            raise RefusedError("one_thing_at_a_time")
        return replace(command, part=part)

    def _place(self, form: Form) -> tuple[str, ObjectReference]:
        if form.name != "partOf":
            raise RefusedError("no_part_named")
        return name_of(form.arguments[0]), self.target(form.arguments[1])

    def _tool_command(self, form: Form) -> ToolCommand:
        patient, props = object_of(form.arguments[1])
        if patient == ANY_OBJECT or props:
            raise RefusedError("on_what", asks=True, goal=form.name)
        if len(form.arguments) < 3 or form.arguments[2].name in SOMETHING:
            return ToolCommand(
                form.name, patient, ObjectReference(used_for=self.tool_acts[form.name])
            )
        return ToolCommand(form.name, patient, self.target(form.arguments[2]))

    def _corrected(self, form: Form, discourse: Discourse) -> Rule:
        """The last rule with another confidence, object or use: "no, only sometimes"."""
        rule, said = discourse.rule, form.arguments[0]
        if rule is None:
            raise RefusedError("nothing_to_correct", asks=True)
        if form.name == "correctDegree":
            return replace(rule, confidence=self.intervals[said.name], revises=True)
        if form.name == "correctObject":
            name, props = object_of(said)
            return replace(rule, object=name, props=props, revises=True)
        if not isinstance(rule, FunctionalRule):
            raise RefusedError("nothing_to_correct", asks=True)
        return replace(rule, affordance=self.affordance(said), revises=True)

    def _one_rule(self, form: Form) -> Rule:
        rules = list(self.rules(form))
        if len(rules) != 1:
            raise RefusedError("one_rule_at_a_time")
        return rules[0]

    def _functional_rule(self, form: Form) -> FunctionalRule:
        noun, use, degree = form.arguments
        confidence = self.intervals[degree.name]
        if use.name in {"usedFor", "notUsedFor"}:
            if use.name == "notUsedFor" or use.arguments[0].name not in SOMETHING:
                raise RefusedError("say_the_use")
            use = use.arguments[1]
        patient = use.arguments[1].name if use.name == "of" else "something"
        if patient not in SOMETHING and confidence[0] < self.intervals["low"][0]:
            # Not used for cutting bread is less than not used for cutting.
            raise RefusedError("use_in_general", patient=shown(patient))
        name, props = object_of(noun)
        if name == ANY_OBJECT and not props:
            raise RefusedError("of_which_object", asks=True)
        return FunctionalRule(name, self.affordance(use), confidence, props)

    def _action_rule(self, form: Form) -> ActionRule:
        context, act, degree = form.arguments
        part, owner = act.arguments[1].arguments
        if context.name not in GOALS and context.name not in {*self.tool_acts, *self.acts}:
            raise RefusedError("no_act")
        name, props = object_of(owner)
        return ActionRule(name, context.name, name_of(part), self.intervals[degree.name], props)


def object_of(form: Form) -> tuple[str, tuple[str, ...]]:
    """The kind of object that a form names, `ANY_OBJECT` for "something", and its properties."""
    props: set[str] = set()
    while form.name == "having":
        props.add(name_of(form.arguments[1]))
        form = form.arguments[0]
    if form.name in SOMETHING:
        return ANY_OBJECT, tuple(sorted(props))
    return name_of(form), tuple(sorted(props))


def name_of(form: Form) -> str:
    """The name that a form without arguments stands for, spelled as people do."""
    if form.arguments or form.name in _NAMELESS or form.name in SOMETHING:
        raise RefusedError("one_thing_at_a_time")
    return shown(form.name)


def shown(name: str) -> str:
    """A name of a form as people spell it: "wine glass" for `wine_glass`."""
    return name.replace("_", " ")


def reply(form: Form) -> Acknowledgement:
    """The acknowledgement that a form is."""
    return Acknowledgement(form.name)


def _recipient(form: Form) -> str | None:
    if form.name != "pass" or len(form.arguments) < 3:
        return None
    return name_of(form.arguments[2])


def _other_part(form: Form, discourse: Discourse) -> Rule:
    """The last rule with another part: "no, by the handle"."""
    rule = discourse.rule
    if not isinstance(rule, ActionRule):
        raise RefusedError("nothing_to_correct", asks=True)
    place = form.arguments[0]
    if place.name == "graspObject":
        place = place.arguments[1]
    if place.name == "partOf":
        name, _ = object_of(place.arguments[1])
        if name != rule.object:
            raise RefusedError("two_objects", first=rule.object, second=name)
        place = place.arguments[0]
    return replace(rule, part=name_of(place), revises=True)
