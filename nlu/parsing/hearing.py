# SPDX-License-Identifier: Apache-2.0
"""Taking in one whole: an utterance, or one move of it, with its new words or the question back.

A word that the lexicon does not have is given all that it may be. What is taught may bring new
words; a question may be about them, and an act may be asked for on what they name. Of a word one
slip away from a known one Hilt asks whether that was meant.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ...ontology.errors import UnknownNameError
from ..generation.realizer import Realizer
from ..generation.templates import AnswerTemplates
from ..lexicon.inflection import Inflection
from ..lexicon.loader import LexiconBuilder
from ..lexicon.tokenizer import MAX_CHARACTERS, MAX_TOKENS, Token, Tokens
from ..lexicon.unknown_words import (
    MAX_NEW_WORDS,
    KnownWords,
    closest_word,
    is_one_slip,
    is_word,
    misspelled_word,
    names_for_role,
)
from ..lexicon.vocabulary import NewWord
from ..semantics.coreference import RefusedError
from ..semantics.meaning import (
    AskBack,
    Command,
    Meaning,
    Misunderstanding,
    Question,
    Statement,
    ToolCommand,
)
from ..semantics.negation import denies_a_thing, is_denial
from ..semantics.predicates import Form
from .chart import Chart
from .parser import Listener, UtteranceContext, after, decide
from .understanding import Reading, Understanding


@dataclass(frozen=True, repr=False)
class Hearing:
    """What takes one whole in.

    Attributes:
        listener: what reads it.
        book: how entries are made for new words.
        inflection: forms of words.
        answers: the sentences that Hilt says.
        realizer: what puts meanings into sentences.
    """

    listener: Listener
    builder: LexiconBuilder
    inflection: Inflection
    answers: AnswerTemplates
    realizer: Realizer

    def problem(self, text: str, tokens: Tokens) -> Meaning | None:
        """Why a text is not even tried, None when it is."""
        if len(text) > MAX_CHARACTERS:
            return Misunderstanding(
                self.answers.say("too_long", limit=f"{MAX_CHARACTERS} characters")
            )
        if len(tokens.items) > MAX_TOKENS:
            return Misunderstanding(self.answers.say("too_long", limit=f"{MAX_TOKENS} words"))
        if not tokens.items:
            return Misunderstanding(self.answers.say("empty"), nearest=())
        unknown = self.known_words.unknown(tokens)
        strange = [token for token in unknown if not is_word(token)]
        if strange or len({token.word for token in unknown}) > MAX_NEW_WORDS:
            return self._not_known(tokens, strange or unknown)
        return None

    def taken(
        self,
        tokens: Tokens,
        situation: UtteranceContext,
        insist: Collection[str],
        *,
        in_frames: bool = False,
    ) -> Understanding:
        """What tokens mean as one whole.

        Args:
            tokens: an utterance, or one move of it.
            situation: who speaks to whom, and after what.
            insist: words that are new although they are close to known ones.
            in_frames: whether to go by the things named, in any order, and not by the grammar.
        """
        unknown = self.known_words.unknown(tokens)
        chart = self._chart(tokens, unknown, situation)
        readings, refusal = self.listener.readings(chart, tokens, situation, in_frames=in_frames)
        if denies_a_thing(tokens, self.builder.denying, self.known_words.may_be_a_thing):
            readings = [each for each in readings if is_denial(each.meaning)]
        clear = [each for each in readings if self._may_bring(each, tokens, in_frames=in_frames)]
        chosen = decide(clear)
        if chosen is not None:
            slip = self._slip(chosen.new_words, insist)
            if slip is None:
                return _with_reading(tokens, situation, chosen, len(clear))
            return replace(without_reading(tokens, situation, slip), readings=len(clear))
        meaning: Meaning
        if clear:
            words = (word for reading in clear for word in reading.new_words)
            meaning = self._slip(words, insist) or self._several(clear)
        elif readings:
            slip = self._slip(readings[0].new_words, insist)
            meaning = slip or self._in_the_way(chart, tokens, unknown, refusal)
        elif unknown:
            meaning = self._slip_anywhere(unknown, insist) or self._not_known(tokens, unknown)
        else:
            meaning = self._unclear(chart, tokens, refusal)
        return replace(without_reading(tokens, situation, meaning), readings=len(clear))

    def _may_bring(self, reading: Reading, tokens: Tokens, *, in_frames: bool) -> bool:
        """Whether new words may come with it: with a lesson all, else only names of things."""
        meaning, words = reading.meaning, reading.new_words
        if not words:
            return True
        if isinstance(meaning, Statement):
            return not self._is_of_doers(words)
        if len(words) > 2 or not all(map(_is_name, words)):
            return False
        if isinstance(meaning, (Command, ToolCommand)):
            # Nothing is done to people, and the order of words must show that a use is one.
            is_of_things = not tokens.proper.intersection(word.said for word in words)
            return is_of_things and not (in_frames and any(word.role != "object" for word in words))
        return isinstance(meaning, Question)

    def _is_of_doers(self, words: Iterable[NewWord]) -> bool:
        """Whether a new part may as well be who does it: "a cake is baked by the baker"."""
        said = {word.role: word.said for word in words}
        done = self.inflection.origins(said.get("context", ""), "participle")
        return "part" in said and bool(done)

    def _chart(self, tokens: Tokens, unknown: list[Token], situation: UtteranceContext) -> Chart:
        """All that the tokens can be, with guesses for new words."""
        # Two words with a pause between them are no name, so pauses matter, too.
        key = (tuple((token.word, token.capital) for token in tokens.items), tokens.pauses)
        found = situation.charts.get(key)
        if found is None:
            found = self.listener.chart(tokens, self.known_words.guesses(tokens, unknown))
            situation.charts[key] = found
        return found

    @cached_property
    def known_words(self) -> KnownWords:
        """The words that are known."""
        listener = self.listener
        return KnownWords(listener.lexicon, listener.frames.words, self.builder, self.inflection)

    def topic(self, tokens: Tokens, situation: UtteranceContext) -> Form | None:
        """The thing that tokens only name, None when they do not."""
        return self.listener.topic(self.listener.chart(tokens, {}), situation)

    def is_general(self, tokens: Tokens) -> bool:
        """Whether what tokens name is any object of a kind."""
        return self.listener.is_general(self.listener.chart(tokens, {}))

    def _slip(self, words: Iterable[NewWord], insist: Collection[str]) -> AskBack | None:
        """The question back when a new word is close to a known one of its kind."""
        lexicon = self.listener.lexicon
        framed = self.listener.frames.words
        for word in words:
            if word.said in insist or word.said in framed:
                continue
            close = closest_word(word.said, names_for_role(word.role, lexicon))
            if close is not None:
                return self._did_you_mean(word.said, close)
            for part in word.said.split(" ") if " " in word.said else ():
                close = (
                    None
                    if part in self.known_words.words
                    else closest_word(part, self.known_words.named)
                )
                if close is not None:
                    return self._did_you_mean(part, close)
        return None

    def _slip_anywhere(self, unknown: list[Token], insist: Collection[str]) -> AskBack | None:
        """The question back when an unknown word of an unknown kind is close to a known one."""
        for token in unknown:
            if token.word in insist:
                continue
            close = closest_word(token.word, self.known_words.named) or misspelled_word(
                token.word, self.known_words.words
            )
            if close is not None:
                return self._did_you_mean(token.word, close)
        return None

    def _did_you_mean(self, word: str, close: str) -> AskBack:
        for singular in self.inflection.origins(close, "plural"):
            if singular in self.known_words.named and is_one_slip(word, singular):
                close = singular
        return AskBack(self.answers.say("did_you_mean", word=word, suggestion=close), (close,))

    def _several(self, readings: Sequence[Reading]) -> AskBack:
        choices = tuple(self._choice(reading.meaning) for reading in readings)
        return AskBack(self.answers.say("which_meaning", choices=choices), choices)

    def _unclear(
        self, chart: Chart, tokens: Tokens, refusal: RefusedError | None
    ) -> Misunderstanding | AskBack:
        """What to answer when all words are known, but the whole has no meaning."""
        if refusal is not None:
            said = self.answers.say(refusal.key, **refusal.slots)
            if refusal.asks:
                return AskBack(said)
            return Misunderstanding(said, nearest=self.listener.nearest(tokens.words))
        where, expected = self.listener.failure(chart, tokens)
        if expected:
            message = self.answers.say(
                "not_understood_after", where=where, expected=" or ".join(expected)
            )
        else:
            message = self.answers.say("not_understood", text=tokens.text)
        return Misunderstanding(message, where, expected, self.listener.nearest(tokens.words))

    def _in_the_way(
        self, chart: Chart, tokens: Tokens, unknown: list[Token], refusal: RefusedError | None
    ) -> Misunderstanding | AskBack:
        """What to answer when a word would have to be a new name, and may not be."""
        if unknown:
            return self._not_known(tokens, unknown)
        return self._unclear(chart, tokens, refusal)

    def _choice(self, meaning: Meaning) -> str:
        if isinstance(meaning, Statement):
            return self.answers.join([self.answers.rule_phrase(rule) for rule in meaning.rules])
        try:
            return f'"{self.realizer.realize(meaning)}"'
        except UnknownNameError:
            return str(meaning.as_json())

    def _not_known(self, tokens: Tokens, unknown: Sequence[Token]) -> Misunderstanding:
        words = list(dict.fromkeys(token.word for token in unknown))
        if len(words) == 1:
            message = self.answers.say("unknown_word", word=words[0])
        else:
            message = self.answers.say("unknown_words", words=words[:MAX_NEW_WORDS])
        known = [token.word for token in tokens.items if token not in unknown]
        return Misunderstanding(message, nearest=self.listener.nearest(known))


def _is_name(word: NewWord) -> bool:
    """Whether a word names a thing or a use, alone."""
    return word.role in {"object", "affordance"} and " " not in word.said


def _with_reading(
    tokens: Tokens, situation: UtteranceContext, reading: Reading, readings: int
) -> Understanding:
    return Understanding(
        tokens.text,
        situation.speaker,
        situation.addressee,
        reading.meaning,
        reading,
        readings,
        reading.new_words if isinstance(reading.meaning, Statement) else (),
        tokens.words,
        after(reading.meaning, reading.act.arguments[-1], situation.discourse),
    )


def without_reading(tokens: Tokens, situation: UtteranceContext, meaning: Meaning) -> Understanding:
    """What came of an utterance that has no reading: an answer that says why."""
    return Understanding(
        tokens.text,
        situation.speaker,
        situation.addressee,
        meaning,
        words=tokens.words,
        discourse=situation.discourse,
    )
