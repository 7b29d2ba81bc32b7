# SPDX-License-Identifier: Apache-2.0
"""The meanings of utterances: rules, commands, questions, corrections, acknowledgements.

These frozen values are all that other packages get. Names are lower-case words in the singular,
with a space between several ("wine glass"); affordances are gerunds ("cutting"). A confidence is a
pair (lower, upper) in [0, 1]. `as_json` follows the meaning schema of `docs/language.md`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

Json = dict[str, object]
Confidence = tuple[float, float]

ANY_OBJECT = "*"


@dataclass(frozen=True)
class FunctionalRule:
    """An object is used for something: "a knife is often used for cutting".

    Attributes:
        object: the kind of object, or `ANY_OBJECT`.
        affordance: the gerund of what it is used for.
        confidence: (lower, upper) in [0, 1].
        props: further properties that the object must have, sorted.
        revises: whether it replaces what was taught before.
    """

    object: str
    affordance: str
    confidence: Confidence
    props: tuple[str, ...] = ()
    revises: bool = False

    def as_json(self) -> Json:
        """The rule as a JSON object."""
        result: Json = {
            "rule": "functional",
            "object": self.object,
            "affordance": self.affordance,
            "confidence": list(self.confidence),
        }
        return result | _rest(self.props, self.revises)


@dataclass(frozen=True)
class ActionRule:
    """In a context, an object is grasped by a part: "to pass a knife grab it by the blade".

    Attributes:
        object: the kind of object, or `ANY_OBJECT`.
        context: the action during which the rule holds ("pass", "pickUp", ...).
        part: the part to grasp.
        confidence: (lower, upper) in [0, 1].
        props: further properties that the object must have, sorted.
        revises: whether it replaces what was taught before.
    """

    object: str
    context: str
    part: str
    confidence: Confidence
    props: tuple[str, ...] = ()
    revises: bool = False

    def as_json(self) -> Json:
        """The rule as a JSON object."""
        result: Json = {
            "rule": "action",
            "object": self.object,
            "context": self.context,
            "part": self.part,
            "confidence": list(self.confidence),
        }
        return result | _rest(self.props, self.revises)


Rule = FunctionalRule | ActionRule


@dataclass(frozen=True)
class Statement:
    """One or more rules that the speaker wants believed.

    Attributes:
        rules: at least one, in the order they were said.
    """

    rules: tuple[Rule, ...]

    @property
    def kind(self) -> str:
        """`"correction"` when a rule revises an older one, else `"statement"`."""
        return "correction" if any(rule.revises for rule in self.rules) else "statement"

    def as_json(self) -> Json:
        """The one rule, or `{"all": [...]}`."""
        if len(self.rules) == 1:
            return self.rules[0].as_json()
        return {"all": [rule.as_json() for rule in self.rules]}


@dataclass(frozen=True)
class ObjectReference:
    """The object that a command refers to: exactly one of the first three attributes is set.

    Attributes:
        object: a kind of object, or `ANY_OBJECT` when only properties are asked for.
        used_for: an affordance it must have.
        not_used_for: an affordance it must not have.
        props: further properties that it must have, sorted.
    """

    object: str | None = None
    used_for: str | None = None
    not_used_for: str | None = None
    props: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if sum(value is not None for value in (self.object, self.used_for, self.not_used_for)) != 1:
            raise ValueError("A reference needs exactly one of object, used_for and not_used_for.")

    def as_json(self) -> Json:
        """The reference as a JSON object."""
        named = {
            "object": self.object,
            "usedFor": self.used_for,
            "notUsedFor": self.not_used_for,
        }
        return _present(named) | _rest(self.props)


@dataclass(frozen=True)
class Command:
    """An act on one object: "pass me the knife by the blade".

    Attributes:
        goal: `pass`, `pickUp`, `pointTo`, `grasp` or `use`.
        target: what to act on.
        part: the part to grasp, when the speaker names it.
        recipient: who gets it, when it is not the speaker.
        negated: whether the act is forbidden; then it must never be executed.
    """

    kind: ClassVar[str] = "command"
    goal: str
    target: ObjectReference
    part: str | None = None
    recipient: str | None = None
    negated: bool = False

    def as_json(self) -> Json:
        """The command as a JSON object."""
        result: Json = {"goal": self.goal, "target": self.target.as_json()}
        result |= _present({"part": self.part, "recipient": self.recipient})
        return result | ({"negated": True} if self.negated else {})


@dataclass(frozen=True)
class ToolCommand:
    """An act on something with a tool: "pound the nail [with the hammer]".

    Attributes:
        goal: `pound`, `cut`, `poke`, ...
        patient: what the tool is used on.
        tool: the tool named, or the affordance that the act needs.
        negated: whether the act is forbidden; then it must never be executed.
    """

    kind: ClassVar[str] = "command"
    goal: str
    patient: str
    tool: ObjectReference
    negated: bool = False

    def as_json(self) -> Json:
        """The command as a JSON object."""
        result: Json = {"goal": self.goal, "patient": self.patient, "tool": self.tool.as_json()}
        return result | ({"negated": True} if self.negated else {})


@dataclass(frozen=True)
class Question:
    """A question of the speaker.

    Attributes:
        ask: one of `QUESTIONS`.
        object, affordance, context, part, speaker: what the question names, else None.
    """

    kind: ClassVar[str] = "question"
    ask: str
    object: str | None = None
    affordance: str | None = None
    context: str | None = None
    part: str | None = None
    speaker: str | None = None

    def as_json(self) -> Json:
        """The question as a JSON object."""
        named = {
            "object": self.object,
            "affordance": self.affordance,
            "context": self.context,
            "part": self.part,
            "speaker": self.speaker,
        }
        return {"ask": self.ask} | _present(named)


QUESTIONS = (
    "about",
    "best_for",
    "capabilities",
    "confidence",
    "how",
    "is_used_for",
    "objects_for",
    "see",
    "source",
    "trust",
    "uses_of",
    "what_if",
    "which_context",
    "why",
    "why_not",
)


@dataclass(frozen=True)
class Retraction:
    """The speaker retracts a rule: "forget that".

    Attributes:
        rule: the rule; None for the one taught last.
    """

    kind: ClassVar[str] = "correction"
    rule: Rule | None = None

    def as_json(self) -> Json:
        """The retraction as a JSON object."""
        return {"retract": "last" if self.rule is None else self.rule.as_json()}


@dataclass(frozen=True)
class Acknowledgement:
    """An utterance that only keeps the conversation going.

    Attributes:
        ack: `okay`, `thanks`, `praise`, `yes`, `no` or `greeting`.
    """

    kind: ClassVar[str] = "acknowledgement"
    ack: str

    def as_json(self) -> Json:
        """The acknowledgement as a JSON object."""
        return {"ack": self.ack}


@dataclass(frozen=True)
class AskBack:
    """The utterance is ambiguous or close to a known one: Hilt must ask a clarification question.

    Attributes:
        question: the sentence to ask.
        choices: the words or sentences to choose from, best first.
    """

    kind: ClassVar[str] = "ask_back"
    question: str = ""
    choices: tuple[str, ...] = ()

    def as_json(self) -> Json:
        """The JSON object, which leaves the question out because it is spoken."""
        return {"ask_back": True}


@dataclass(frozen=True)
class Misunderstanding:
    """The utterance is not understood, with the reason.

    Attributes:
        message: one sentence for the speaker.
        where: the longest span that was understood; empty when nothing was.
        expected: what was expected after it.
        nearest: similar sentences that would be understood, best first.
    """

    kind: ClassVar[str] = "error"
    message: str
    where: str = ""
    expected: tuple[str, ...] = ()
    nearest: tuple[str, ...] = ()

    def as_json(self) -> Json:
        """The failure as a JSON object."""
        result: Json = {"error": True, "message": self.message, "where": self.where}
        result["expected"] = list(self.expected)
        result["nearest"] = list(self.nearest)
        return result


Meaning = (
    Statement
    | Command
    | ToolCommand
    | Question
    | Retraction
    | Acknowledgement
    | AskBack
    | Misunderstanding
)


def _present(named: dict[str, str | None]) -> Json:
    return {key: value for key, value in named.items() if value is not None}


def _rest(props: tuple[str, ...], revises: bool = False) -> Json:
    result: Json = {"props": list(props)} if props else {}
    if revises:
        result["revises"] = True
    return result
