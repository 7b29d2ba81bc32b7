# SPDX-License-Identifier: Apache-2.0
"""What came of one utterance: every stage from the text to its meaning.

`text -> tokens -> chart -> predicate form -> speech act -> intention -> meaning`. An utterance that
is not understood is an `Understanding` too, whose meaning says how far it was understood.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ..lexicon.vocabulary import NewWord
from ..semantics.coreference import Discourse
from ..semantics.meaning import Confidence, Json, Meaning
from ..semantics.predicates import Form
from .chart import Derivation
from .derivation import DerivationStep, derivation_step


@dataclass(frozen=True)
class Reading:
    """One way to take an utterance.

    Attributes:
        act: the speech act, `STATEMENT(sam,self,...)`.
        intention: what the speaker wants, `wantBelieve(sam,self,...)`.
        sure: how sure the intention is, by the pragmatic rules and by how it was heard, as
            (lower, upper) in [0, 1].
        meaning: what it comes to.
        cost: how unlikely it is; the least is the best.
        derivation: how the chart found it.
        new_words: words it takes to be new.
    """

    act: Form
    intention: Form
    sure: Confidence
    meaning: Meaning
    cost: float
    derivation: Derivation
    new_words: tuple[NewWord, ...] = ()


@dataclass(frozen=True)
class Understanding:
    """An utterance and all that was understood of it.

    Attributes:
        text: what was said.
        speaker: who said it.
        addressee: who was spoken to.
        meaning: what it comes to; a `Misunderstanding` or `AskBack` when it is not clear.
        reading: the best way to take it, None when there is none.
        readings: how many different meanings it has.
        new_words: words that were not known, and what the sentence shows them to be.
        words: the tokens.
        discourse: what the conversation has spoken of after this utterance.
    """

    text: str
    speaker: str
    addressee: str
    meaning: Meaning
    reading: Reading | None = None
    readings: int = 0
    new_words: tuple[NewWord, ...] = ()
    words: tuple[str, ...] = ()
    discourse: Discourse = field(default_factory=Discourse)

    @property
    def kind(self) -> str:
        """`statement`, `command`, `question`, `correction`, `acknowledgement`, ..."""
        return self.meaning.kind

    @property
    def unknown(self) -> tuple[str, ...]:
        """What it names that nobody has taught, and it does not teach either."""
        named = self.reading.new_words if self.reading and not self.new_words else ()
        return tuple(word.said for word in named)

    @property
    def semantics(self) -> str:
        """The speech act as a predicate form; empty when there is none."""
        return str(self.reading.act) if self.reading else ""

    @property
    def pragmatics(self) -> str:
        """The speaker's intention as a predicate form; empty when there is none."""
        return str(self.reading.intention) if self.reading else ""

    @property
    def content(self) -> str:
        """What is to be believed, done or answered, as a predicate form: the goal of a command."""
        return str(self.reading.intention.arguments[-1]) if self.reading else ""

    @property
    def derivation(self) -> DerivationStep | None:
        """How the chart found the reading; prints as an indented text."""
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
