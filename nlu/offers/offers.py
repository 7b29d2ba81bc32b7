# SPDX-License-Identifier: Apache-2.0
"""Offers for an utterance that is not understood, as a question with at most three choices.

Candidates are built from the names in the utterance, ranked, and checked; the sentence that the
language generates for an offer must be understood as just this meaning. An offer is never believed
or acted on before its speaker has chosen it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice
from pathlib import Path

from ...ontology.errors import UnknownNameError
from ..generation.templates import AnswerTemplates
from ..lexicon.tokenizer import BREAK, MAX_TOKENS, Tokens
from ..lexicon.unknown_words import MAX_NEW_WORDS, KnownWords
from ..parsing.parser import UtteranceContext
from ..semantics.coreference import Discourse
from ..semantics.meaning import AskBack, Command, Confidence, Meaning, Statement, ToolCommand
from .candidates import CandidateMeaning, candidates
from .checks import OfferChecks
from .meaning_shapes import MeaningShape, meaning_from_json, shape_from
from .mentions import Mentions, find_mentions
from .ranker import Ranker, left_over
from .typing_slips import corrected_texts
from .utterance_segments import segments

MAX_OFFERS = 3

LEAST_FIRST: Mapping[type, float] = {Command: 0.5, ToolCommand: 0.5}
"""The least probability of the first offer of a kind; `LEAST` for all others."""

LEAST = 0.4
LEAST_OTHER = 0.06
"""The least probability of a further offer."""

MAX_TRIED = 6
"""How many of the likeliest candidates are checked."""

MAX_SEGMENTS = 30
"""How many segments are parsed."""


@dataclass(frozen=True)
class OfferModel:
    """What was learned from utterances: the shapes of their meanings, and the weights."""

    shapes: tuple[MeaningShape, ...]
    ranker: Ranker


@dataclass(frozen=True, repr=False)
class Offers:
    """Finds meanings to offer.

    Attributes:
        degrees: the words for degrees of confidence, with their intervals.
        tool_acts: the acts done with a tool, each with the affordance that the tool must have.
        answers: the words of the question.
        realize: returns the sentence for a meaning.
        meaning_of: returns the meaning of a text that somebody says at some point.
        set_off: returns the places behind a strong pause, and whether what precedes only tells
            what follows.
    """

    model: OfferModel
    checks: OfferChecks
    known: KnownWords
    degrees: Mapping[tuple[str, ...], Confidence]
    tool_acts: Mapping[str, str]
    answers: AnswerTemplates
    realize: Callable[[Meaning], str]
    meaning_of: Callable[[str, UtteranceContext], Meaning]
    set_off: Callable[[Tokens], Mapping[int, bool]]

    def question(self, tokens: Tokens, context: UtteranceContext) -> AskBack | None:
        """Return the question which of some meanings was meant, None when none is to be offered."""
        choices = self.meanings(tokens, context)
        if not choices:
            return None
        said = [self._aloud(meaning) for meaning in choices]
        if len(said) == 1:
            return AskBack(self.answers.say("offer", choice=said[0]), choices)
        numbered = " ".join(f"{number}. {each}." for number, each in enumerate(said, start=1))
        return AskBack(self.answers.say("offers", choices=numbered), choices)

    def meanings(self, tokens: Tokens, context: UtteranceContext) -> tuple[Meaning, ...]:
        """Return at most `MAX_OFFERS` meanings that an utterance may have, the likeliest first."""
        mentions = self.mentions(tokens, context.discourse)
        said = self.of_segments(mentions, context)
        if said or not self._is_text(tokens):
            return said
        corrected = self.of_corrected(tokens, context)
        if corrected:
            return corrected
        return self.of_mentions(mentions, context)

    def mentions(self, tokens: Tokens, discourse: Discourse) -> Mentions:
        """Return what an utterance names, with its features."""
        found = find_mentions(tokens, self.known, self.degrees, discourse)
        return replace(found, features=self.checks.signs(found))

    def of_corrected(self, tokens: Tokens, context: UtteranceContext) -> tuple[Meaning, ...]:
        """Return the meanings that an utterance has with its misspelled words corrected."""
        texts = corrected_texts(tokens, self.known)
        meanings = dict.fromkeys(self.meaning_of(text, context) for text in texts)
        found = (each for each in meanings if self._is_understood(each, context))
        return tuple(islice(found, MAX_OFFERS))

    def of_segments(self, mentions: Mentions, context: UtteranceContext) -> tuple[Meaning, ...]:
        """Return the meaning of the first segment beside which nothing else is meant."""
        tokens = mentions.tokens
        if len(tokens.items) > MAX_TOKENS:
            return ()
        told = self.set_off(tokens)
        spans = segments(tokens, told)
        harmless = (each for each in spans if self.checks.adds_nothing(each, mentions, told))
        for span in islice(harmless, MAX_SEGMENTS):
            meaning = self.meaning_of(tokens.span(*span), context)
            around = self.checks.around(span, mentions, told)
            if self.checks.is_licensed_beside(meaning, around) and self._is_understood(
                meaning, context
            ):
                return (meaning,)
        return ()

    def of_mentions(self, mentions: Mentions, context: UtteranceContext) -> tuple[Meaning, ...]:
        """Return the meanings to offer for an utterance that names this."""
        found: list[Meaning] = []
        for probability, candidate in self.ranked(mentions):
            meaning = meaning_from_json(candidate.meaning)
            least = LEAST_OTHER if found else LEAST_FIRST.get(type(meaning), LEAST)
            if probability < least:
                break
            if not candidate.used or left_over(candidate, mentions).get("new"):
                continue
            checked = self.checks.checked(meaning, mentions)
            is_new = checked and _content(checked) not in map(_content, found)
            if checked and is_new and self._is_understood(checked, context):
                found.append(checked)
        return tuple(found[:MAX_OFFERS])

    def ranked(self, mentions: Mentions) -> Sequence[tuple[float, CandidateMeaning]]:
        """Return the likeliest candidates with their probabilities, the likeliest first."""
        some = tuple(candidates(mentions, self.model.shapes, self.tool_acts))
        chances = self.model.ranker.probabilities(mentions, some)
        ranked = sorted(zip(chances, some, strict=True), key=lambda each: -each[0])
        return ranked[:MAX_TRIED]

    def _aloud(self, meaning: Meaning) -> str:
        """The sentence for a meaning, with what denies in capitals."""
        first, *rest = self.realize(meaning).rstrip("?").split(" ")
        denying = self.checks.phrases["negative"]
        return " ".join([first, *(w.upper() if (w,) in denying else w for w in rest)])

    def _is_text(self, tokens: Tokens) -> bool:
        """Whether an utterance consists of words, not of too many, and most of them known."""
        words = tokens.words
        if len(words) > MAX_TOKENS or not all(word.isalpha() or word == BREAK for word in words):
            return False
        return len({token.word for token in self.known.unknown(tokens)}) <= MAX_NEW_WORDS

    def _is_understood(self, meaning: Meaning, context: UtteranceContext) -> bool:
        """Whether the sentence for a meaning is understood as it, said out of the blue."""
        alone = replace(context, discourse=Discourse())
        try:
            return self.meaning_of(self.realize(meaning), alone) == meaning
        except UnknownNameError:
            return False


def _content(meaning: Meaning) -> Meaning:
    """A meaning, whether it corrects something or not."""
    if not isinstance(meaning, Statement):
        return meaning
    return Statement(tuple(replace(rule, revises=False) for rule in meaning.rules))


@lru_cache(maxsize=4)
def load_model(path: Path) -> OfferModel:
    """Return the model in a file, which `benchmarks/train_offers.py` writes."""
    data = json.loads(path.read_text(encoding="utf-8"))
    shapes = tuple(map(shape_from, data["shapes"]))
    traits = [each if isinstance(each, str) else shapes[each].text for each in data["traits"]]
    weights = {
        feature: {
            traits[int(n)]: int(w) / 10 for n, w in (each.split(":") for each in said.split())
        }
        for feature, said in data["weights"].items()
    }
    return OfferModel(shapes, Ranker(weights))
