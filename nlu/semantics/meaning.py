"""The meanings of utterances: rules, commands, questions, corrections, replies, controls.

These frozen values are all that other packages get. Names are lower-case words in the singular,
with a space between several ("wine glass"); affordances are gerunds ("cutting"). A confidence is a
pair (lower, upper) in [0, 1]. `as_json` follows the meaning schema of `docs/language.md`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Generic, TypeVar

Json = dict[str, object]
Confidence = tuple[float, float]

ANY_OBJECT = "*"

LIKELY = 0.5  # a rule whose upper bound is below states that something is not so


class _Record:
    """A value whose JSON object holds those of its attributes that are not None, False or empty."""

    keys: ClassVar[Mapping[str, str]] = {}  # what attributes are called there, where otherwise

    def as_json(self) -> Json:
        values = ((name, value) for name, value in vars(self).items() if value)
        return {self.keys.get(name, name): _plain(value) for name, value in values}


def _plain(value: object) -> object:
    match value:
        case tuple():
            return [_plain(each) for each in list[object](value)]
        case _Record():
            return value.as_json()
        case _:
            return value


class _Rule(_Record):
    """A rule with its degree of confidence."""

    rule: ClassVar[str]
    confidence: Confidence
    revises: bool = False
    source: str | None = None

    @property
    def denies(self) -> bool:
        """Whether it states that something is not so."""
        return self.confidence[1] < LIKELY

    def as_json(self) -> Json:
        return {"rule": self.rule} | super().as_json()


def _one_or_all(records: Sequence[_Record]) -> Json:
    return {"all": list(map(_plain, records))} if records[1:] else records[0].as_json()


@dataclass(frozen=True)
class FunctionalRule(_Rule):
    """An object is used for something: "a knife is often used for cutting"."""

    rule: ClassVar[str] = "functional"
    object: str  # the kind of object, or `ANY_OBJECT`
    affordance: str  # the gerund of what it is used for
    confidence: Confidence  # (lower, upper) in [0, 1]
    props: tuple[str, ...] = ()  # further properties that the object must have, sorted
    revises: bool = False  # whether it replaces what was taught before
    material: str | None = None  # what it is used on ("bread", for cutting), or None for anything
    source: str | None = None  # whose words are reported ("anna"), None for the speaker


@dataclass(frozen=True)
class ActionRule(_Rule):
    """In a context, an object is grasped by a part: "to pass a knife grab it by the blade"."""

    rule: ClassVar[str] = "action"
    object: str
    context: str  # the action during which the rule holds ("pass", "pickUp", ...)
    part: str
    confidence: Confidence
    props: tuple[str, ...] = ()
    revises: bool = False
    source: str | None = None


Rule = FunctionalRule | ActionRule


def is_contradictory(rules: "Sequence[Rule | KindRelation]") -> bool:
    """Return whether of some rules, in the order they were said, one contradicts another.

    A rule on grasping after one on an action with the same grip is about that action, too.
    """
    said: dict[Rule | KindRelation, Confidence] = {}
    for rule in rules:
        bare = replace(rule, confidence=(0.0, 1.0))
        acts = (each for each in said if isinstance(each, ActionRule))
        about = [bare, *(each for each in acts if replace(each, context="grasp") == bare)]
        if any(said.get(each, rule.confidence) != rule.confidence for each in about):
            return True
        said[bare] = rule.confidence
    return False


Told = TypeVar("Told", bound=_Rule)


@dataclass(frozen=True)
class _Statement(Generic[Told]):
    """What the speaker wants believed, of one source, in the order it was said."""

    rules: tuple[Told, ...]

    @property
    def source(self) -> str | None:
        """The person whose words the speaker reports, None for the speaker."""
        return next((rule.source for rule in self.rules), None)

    @property
    def kind(self) -> str:
        """`"correction"` when a rule revises an older one, else `"statement"`."""
        return "correction" if any(rule.revises for rule in self.rules) else "statement"

    def as_json(self) -> Json:
        """Return the one rule, or `{"all": [...]}`."""
        return _one_or_all(self.rules)


class Statement(_Statement[Rule]):
    """Rules on uses and on holding."""


@dataclass(frozen=True)
class ObjectReference(_Record):
    """The object that a command refers to: exactly one of the first three attributes is set."""

    keys: ClassVar[Mapping[str, str]] = {"used_for": "usedFor", "not_used_for": "notUsedFor"}
    object: str | None = None  # a kind, or `ANY_OBJECT` where only properties are asked for
    used_for: str | None = None  # an affordance it must have
    not_used_for: str | None = None  # an affordance it must not have
    props: tuple[str, ...] = ()  # further properties that it must have, sorted
    material: str | None = None  # what the use is for ("bread", for cutting), or None
    other: bool = False  # whether it is none of those that were chosen before: "the other one"

    def __post_init__(self) -> None:
        if sum(value is not None for value in (self.object, self.used_for, self.not_used_for)) != 1:
            raise ValueError("A reference needs exactly one of object, used_for and not_used_for.")


@dataclass(frozen=True)
class Command(_Record):
    """An act on one object: "pass me the knife by the blade"."""

    kind: ClassVar[str] = "command"
    goal: str  # `pass`, `pickUp`, `pointTo`, `grasp` or `use`
    target: ObjectReference
    part: str | None = None  # the part to grasp, when the speaker names it
    recipient: str | None = None  # who gets it, when it is not the speaker
    negated: bool = False  # whether the act is forbidden; then it must never be executed


@dataclass(frozen=True)
class ToolCommand(_Record):
    """An act on something with a tool: "pound the nail [with the hammer]"."""

    kind: ClassVar[str] = "command"
    goal: str  # `pound`, `cut`, `poke`, ...
    patient: str  # what the tool is used on
    tool: ObjectReference  # the tool named, or the affordance that the act needs
    negated: bool = False  # whether the act is forbidden; then it must never be executed


SimpleCommand = Command | ToolCommand


@dataclass(frozen=True)
class Norm(_Record):
    """What must or must not be done from now on, or may be: "never hand knives to children".

    In its act any object or tool is `ANY_OBJECT`. An obligation with a part allows no other one.
    """

    norm: str  # `forbidden`, `obliged` or `permitted`
    act: SimpleCommand
    confidence: Confidence  # (lower, upper) in [0, 1]
    place: str | None = None  # where it holds; None for anywhere
    before: Command | None = None  # what must be done before the act

    def as_json(self) -> Json:
        """Return the norm as a JSON object, in which the act stands as a command does."""
        others = {key: value for key, value in super().as_json().items() if key != "act"}
        return {"norm": others.pop("norm")} | self.act.as_json() | others


@dataclass(frozen=True)
class NormStatement:
    """One or more norms that the speaker lays down, in the order they were said."""

    kind: ClassVar[str] = "statement"
    norms: tuple[Norm, ...]

    def as_json(self) -> Json:
        """Return the one norm, or `{"all": [...]}`."""
        return _one_or_all(self.norms)


@dataclass(frozen=True)
class KindRelation(_Rule):
    """An object is of a more general kind: "a bread knife is a kind of knife"."""

    props: ClassVar[tuple[str, ...]] = ()  # it holds of a kind as a whole
    kind_of: str  # the more general kind
    object: str
    confidence: Confidence
    revises: bool = False
    source: str | None = None

    def as_json(self) -> Json:
        """Return the relation as a JSON object, which says only whether it is denied."""
        given = {key: value for key, value in _Record.as_json(self).items() if key != "confidence"}
        return given | ({"negated": True} if self.denies else {})


class KindStatement(_Statement[KindRelation]):
    """Of which kinds some objects are."""


@dataclass(frozen=True)
class ActionCommand(_Record):
    """A taught action on several objects, or on none: "swap the knife and the spoon", "tidy up"."""

    kind: ClassVar[str] = "command"
    goal: str
    objects: tuple[ObjectReference, ...] = ()  # what to act on, in the order of its parameters


Act = SimpleCommand | ActionCommand


@dataclass(frozen=True)
class Plan(_Record):
    """Several commands to be carried out in order: "pick up the mug and then point to it"."""

    kind: ClassVar[str] = "command"
    keys: ClassVar[Mapping[str, str]] = {"steps": "plan"}
    steps: tuple[Act, ...]


@dataclass(frozen=True)
class ActionCondition(_Record):
    """What must be so before an action: "only if it is empty", "unless you hold a knife"."""

    state: str  # `is`, `sees` or `holds`
    object: str  # the kind of object that it is about
    property: str | None = None  # the property that it must have, for `is`
    negated: bool = False  # whether it must not be so


@dataclass(frozen=True)
class FailureReaction(_Record):
    """What to do when a step of an action fails: exactly one of the last four is set."""

    after: tuple[str, ...]  # the failures, of those that branches of action trees handle, or `any`
    again: int = 0  # how often to try again
    other: bool = False  # whether to take another object
    steps: tuple[Act, ...] = ()  # what to do instead
    stop: bool = False  # whether the action ends there, as failed


@dataclass(frozen=True)
class ActionDefinition(_Record):
    """An action that is taught: "to serve a mug, first pick it up, then put it down"."""

    kind: ClassVar[str] = "statement"
    action: str  # its verb, with its particle
    parameters: tuple[str, ...]  # the kinds of its objects in order; `ANY_OBJECT` for any
    steps: tuple[Act, ...]  # the commands that it consists of, in order
    only_if: tuple[ActionCondition, ...] = ()  # what must be so before the first of them
    if_fails: tuple[FailureReaction, ...] = ()  # what to do when one of them fails
    links: tuple[str, ...] = ()  # the words between its objects, if not all "and"

    @property
    def all_links(self) -> tuple[str, ...]:
        """The words between its objects: "and" in "swap a knife and a spoon"."""
        return self.links or ("and",) * (len(self.parameters) - 1)

    def as_json(self) -> Json:
        """Return the action as a JSON object, which names its parameters also if it has none."""
        return {"action": self.action, "parameters": list(self.parameters)} | super().as_json()


@dataclass(frozen=True)
class Question(_Record):
    """A question of the speaker."""

    kind: ClassVar[str] = "question"
    ask: str  #: what is asked: one of the names that `docs/language.md` lists
    #: object, affordance, context, part, speaker: what the question names, else None
    object: str | None = None
    affordance: str | None = None
    context: str | None = None
    part: str | None = None
    speaker: str | None = None
    material: str | None = None  #: what the affordance is asked for: "bread", for cutting
    norm: Norm | None = None  #: the permission that it asks for: "may you pick up the mug?"
    kind_of: str | None = None  #: the more general kind that it asks about: "is a spoon a tool?"
    property: str | None = None  #: what it asks about a thing at hand: "is the mug hot?"
    among: tuple[str, ...] | None = None  #: the things that are compared, if not all


@dataclass(frozen=True)
class Retraction:
    """The speaker retracts a rule: "forget that"; or all that they said about an object."""

    kind: ClassVar[str] = "correction"
    rule: Rule | KindRelation | None = None  # None stands for the rule taught last
    about: str | None = None  # the object all of whose rules are retracted instead, or `ANY_OBJECT`
    part: str | None = None  # or the last rule to hold something by this part
    is_of_told: bool = False  # whether it names what the speaker told: "forget what I said"
    action: str | None = None  # the taught action that is retracted instead: "forget how to serve"

    def as_json(self) -> Json:
        """Return the retraction as a JSON object."""
        for name in ("action", "about", "part"):
            if getattr(self, name):
                return {"retract": {name: getattr(self, name)}}
        return {"retract": "last" if self.rule is None else self.rule.as_json()}


@dataclass(frozen=True)
class TopicStatement(_Record):
    """What is spoken of: "I'm going to teach you about a soldering iron", "the mug is hot"."""

    topic: str  # a kind of object
    props: tuple[str, ...] = ()  # the properties that the one at hand is said to have, sorted
    denied: bool = False  # whether it is said not to have them
    shown: bool = False  # whether it is said to be at hand: "this is a mallet"

    @property
    def kind(self) -> str:
        """`"ask_back"` for what one thing is like: no rule, so Hilt asks what follows from it."""
        return "ask_back" if self.props else "topic"

    def as_json(self) -> Json:
        """Return the topic as a JSON object, which says whether Hilt asks back."""
        return ({"ask_back": True} if self.props else {}) | super().as_json()


@dataclass(frozen=True)
class PartNaming(_Record):
    """What a part of a thing is called: "the long part is the handle", "this is its handle"."""

    kind: ClassVar[str] = "topic"
    part: str
    props: tuple[str, ...] = ()  # what the part is like, sorted
    other: bool = False  # whether it is the other one of two
    object: str | None = None  # the kind of thing, where it is named


@dataclass(frozen=True)
class TrustStatement(_Record):
    """Whom to trust, or not to: "you can trust Anna and Ben"; the names are as they are written."""

    kind: ClassVar[str] = "statement"
    people: tuple[str, ...]
    distrusted: bool = False


@dataclass(frozen=True)
class Acknowledgement(_Record):
    """An utterance that only keeps the conversation going."""

    kind: ClassVar[str] = "acknowledgement"
    ack: str  # `okay`, `thanks`, `praise`, `yes`, `no`, `greeting`, `farewell`, `apology`, `blame`
    name: str | None = None  # how the speaker of a greeting is introduced, None when not


@dataclass(frozen=True)
class Control(_Record):
    """A control word, obeyed at any time: "stop", "wait", "put it down"."""

    kind: ClassVar[str] = "control"
    control: str  # `stop`, `wait`, `release`, `putDown`, `putBack` or `continue`
    object: str | None = None  # the object to let go of or to put down, when it is named

    @property
    def is_halt(self) -> bool:
        """Whether it only ends or pauses what is being done, which anybody may ask for."""
        return self.control in {"stop", "wait"}


@dataclass(frozen=True)
class Answer(_Record):
    """A short answer to a question of Hilt: "the red one", "the second", "neither".

    It names an object, a part or a use; `ANY_OBJECT` when it names properties only.
    """

    name: str | None = None
    props: tuple[str, ...] = ()  # the properties that it names, sorted
    is_use: bool = False  # whether the name is that of a use
    number: int | None = None  # which of the choices that were offered, from 1
    material: str | None = None  # what the use that it names is for ("paper", for cutting)
    choice: str | None = None  # `none`, `any` or `unknown` ("I don't know")

    @property
    def is_dismissal(self) -> bool:
        """Whether it says that the question need not be answered."""
        return self.choice in {"none", "unknown"}


@dataclass(frozen=True)
class AskBack:
    """The utterance is ambiguous or close to a known one: Hilt must ask a clarification question.

    The `choices` are meanings, words or sentences to choose from, best first.
    """

    kind: ClassVar[str] = "ask_back"
    question: str = ""
    choices: "tuple[Meaning | str, ...]" = ()

    def as_json(self) -> Json:
        """Return the JSON object, which leaves the question out because it is spoken."""
        choices = [each.as_json() for each in self.choices if not isinstance(each, str)]
        return {"ask_back": True, "choices": choices} if choices else {"ask_back": True}


@dataclass(frozen=True)
class Misunderstanding:
    """The utterance is not understood, with the reason."""

    kind: ClassVar[str] = "error"
    message: str  # one sentence for the speaker
    where: str = ""  # the longest span that was understood; empty when nothing was
    expected: tuple[str, ...] = ()  # what was expected after it
    nearest: tuple[str, ...] = ()  # similar sentences that would be understood, best first

    def as_json(self) -> Json:
        """Return the failure as a JSON object."""
        return {"error": True} | {key: _plain(value) for key, value in vars(self).items()}


def with_rules(meaning: "Meaning", **changes: object) -> "Meaning":
    """Return a meaning with these attributes of its rules changed, if it has any."""
    if not isinstance(meaning, (Statement, KindStatement)):
        return meaning
    rules = tuple(replace(rule, **changes) for rule in meaning.rules)  # pyright: ignore
    return replace(meaning, rules=rules)  # pyright: ignore


def is_used_on_itself(meaning: "Meaning") -> bool:
    """Return whether a thing is its own material: "tea is for drinking tea"."""
    rules = meaning.rules if isinstance(meaning, Statement) else ()
    uses = (rule for rule in rules if isinstance(rule, FunctionalRule))
    return any(rule.material in {rule.object, rule.object.split()[-1]} for rule in uses)


def only_revises(meaning: "Meaning") -> bool:
    """Return whether a meaning only changes what was taught: "make it rarely, would you?"."""
    return isinstance(meaning, Statement) and all(rule.revises for rule in meaning.rules)


Meaning = (
    Statement
    | NormStatement
    | KindStatement
    | Act
    | Plan
    | ActionDefinition
    | Question
    | Retraction
    | TopicStatement
    | PartNaming
    | TrustStatement
    | Acknowledgement
    | Control
    | AskBack
    | Misunderstanding
)

TEACHING = (Statement, KindStatement, NormStatement, TopicStatement, PartNaming)
"""The meanings whose new words are learned."""
