"""The result of understanding one utterance, with every stage from the text to its meaning.

`text -> tokens -> chart -> predicate form -> speech act -> intention -> meaning`. An utterance that
is not understood has an `Understanding` too, whose meaning says how far it was understood.
"""

from dataclasses import dataclass, field, replace

from ..lexicon.tokenizer import Tokens
from ..lexicon.vocabulary import NewWord
from ..semantics.clause_features import UtteranceFeatures
from ..semantics.discourse import Discourse, update_discourse
from ..semantics.meaning import TEACHING, Confidence, Json, Meaning
from ..semantics.predicates import CERTAIN, PredicateForm
from .chart import Derivation, DerivationStep, derivation_step


@dataclass(frozen=True)
class UtteranceContext:
    """Who speaks to whom after what, and how surely it was heard, (lower, upper) in [0, 1]."""

    speaker: str
    addressee: str
    discourse: Discourse
    recognition: Confidence = CERTAIN

    def with_object(self, thing: PredicateForm | None) -> "UtteranceContext":
        """Return this context after a thing was named, or where none can be referred to."""
        named, failed = (thing,) if thing else (), self.discourse.has_failed and thing is None
        discourse = replace(self.discourse, object=thing, named=named, has_failed=failed)
        return replace(self, discourse=discourse)


@dataclass(frozen=True)
class Reading:
    """One reading of an utterance.

    The interval, (lower, upper) in [0, 1], says how sure the intention and its recognition are.
    """

    speech_act: PredicateForm  # `STATEMENT(sam,self,...)`
    intention: PredicateForm  # what the speaker wants, `wantBelieve(sam,self,...)`
    interval: Confidence
    meaning: Meaning
    cost: float  # how unlikely the reading is; the lowest cost is the best
    derivation: Derivation
    new_words: tuple[NewWord, ...] = ()
    features: UtteranceFeatures = field(default_factory=UtteranceFeatures)


@dataclass(frozen=True)
class Understanding:
    """An utterance, who said it to whom, its meaning, and the discourse state after it."""

    text: str
    speaker: str
    addressee: str
    meaning: Meaning  # a `Misunderstanding` or `AskBack` when it is not clear
    reading: Reading | None = None  # the best reading, None when there is none
    readings: int = 0  # the number of different meanings
    new_words: tuple[NewWord, ...] = ()  # those that a statement teaches, with their roles in it
    words: tuple[str, ...] = ()
    discourse: Discourse = field(default_factory=Discourse)

    @classmethod
    def of(
        cls,
        tokens: Tokens,
        context: UtteranceContext,
        meaning: Meaning,
        reading: Reading | None = None,
        readings: int = 0,
    ) -> "Understanding":
        """Return what some tokens mean in a context, by a reading if they have one."""
        people, found = (context.speaker, context.addressee), (meaning, reading, readings)
        whole = cls(tokens.text, *people, *found, (), tokens.words, context.discourse)
        return whole.chosen(meaning)

    def chosen(self, meaning: Meaning) -> "Understanding":
        """Return this understanding with a meaning, such as one that its speaker has chosen."""
        if self.reading is None:
            return replace(self, meaning=meaning)
        words = self.reading.new_words if isinstance(meaning, TEACHING) else ()
        discourse = update_discourse(meaning, self.reading.speech_act.arguments[-1], self.discourse)
        return replace(self, meaning=meaning, new_words=words, discourse=discourse)

    @property
    def kind(self) -> str:
        """`statement`, `command`, `question`, `correction`, `acknowledgement`, ..."""
        return self.meaning.kind

    @property
    def unknown(self) -> tuple[str, ...]:
        """The words that it uses as names although nobody has taught them, itself included."""
        named = self.reading.new_words if self.reading and not self.new_words else ()
        return tuple(word.said for word in named)

    @property
    def semantics(self) -> str:
        """The speech act as a predicate form; empty when there is none."""
        return str(self.reading.speech_act) if self.reading else ""

    @property
    def pragmatics(self) -> str:
        """The speaker's intention as a predicate form; empty when there is none."""
        return str(self.reading.intention) if self.reading else ""

    @property
    def content(self) -> str:
        """What to believe, do or answer as a predicate form, such as the goal of a command."""
        return str(self.reading.intention.arguments[-1]) if self.reading else ""

    @property
    def derivation(self) -> DerivationStep | None:
        """The derivation of the reading; prints as an indented tree."""
        return derivation_step(self.reading.derivation, self.words) if self.reading else None

    def as_json(self) -> Json:
        """The object that `hilt parse --json` prints."""
        return {
            "text": self.text,
            "speaker": self.speaker,
            "addressee": self.addressee,
            "semantics": self.semantics,
            "pragmatics": self.pragmatics,
            "kind": self.kind,
            "meaning": self.meaning.as_json(),
            "new_words": [word.as_json() for word in self.new_words],
            "readings": self.readings,
        }
