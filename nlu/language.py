# SPDX-License-Identifier: Apache-2.0
"""A language as Hilt speaks it: loaded from data, it understands texts and says answers.

    >>> language = Language.load()
    >>> language.understand("To pass a knife grab it by the blade").semantics
    'STATEMENT(sam,self,implies(pass(self,knife),graspObject(self,partOf(blade,knife)),high))'

A second language is a second folder beside `ontology/english`, with the same nine files.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path

from ..ontology.errors import UnknownNameError
from ..ontology.qualifiers import Degrees, load_degrees
from ..ontology.source import read_yaml
from .asides import fronted
from .building import building, without_collecting
from .chart import Chart
from .combinators import Combinator
from .expression import Expression, load_expression
from .framing import load_frames
from .generation import Slot, Speech, load_speech
from .grammar import load_grammar
from .inflection import Inflection, load_inflection
from .interpretation import Interpreter
from .lexicon import Entry, Lexicon
from .listening import Listener, Situation, after, decide
from .meaning import (
    AskBack,
    Command,
    Meaning,
    Misunderstanding,
    NewWord,
    Question,
    Rule,
    Statement,
)
from .moves import Moves
from .pragmatics import load_pragmatics
from .predicates import Form
from .reference import Discourse, RefusedError
from .tokens import BREAK, MAX_CHARACTERS, MAX_TOKENS, Token, Tokens, tokenize
from .understanding import Reading, Understanding
from .unknown import (
    MAX_NEW_WORDS,
    NOUNS,
    compounds,
    guesses,
    is_word,
    misspelt,
    names_like,
    nearest,
)
from .vocabulary import Vocabulary, household_vocabulary
from .words import WordBook

LANGUAGES_FOLDER = Path(__file__).parents[1] / "ontology"

_KNOWN_COST = 1.0  # a word of a turn of phrase hardly ever names something, too
_WORD_FILES = ("lexicon.yaml", "constructions.yaml", "requests.yaml")


@dataclass(frozen=True, repr=False)
class Language:
    """One language with one vocabulary; never changes.

    Attributes:
        name: its folder.
        listener: what understands.
        speech: what speaks.
        expression: what puts meanings into sentences.
        book: how entries are made for new words.
        inflection: forms of words.
        degrees: the degrees of confidence.
        learned: words that were added to the vocabulary by `with_words`.
    """

    name: str
    listener: Listener
    speech: Speech
    expression: Expression
    book: WordBook
    inflection: Inflection
    degrees: Degrees
    learned: tuple[NewWord, ...] = ()

    @classmethod
    @building
    def load(
        cls,
        language: str = "english",
        *,
        vocabulary: Vocabulary | None = None,
        extra_lexicon: Path | None = None,
    ) -> Language:
        """Read a language.

        Args:
            language: the name of its folder beside `english`.
            vocabulary: the names of the domain; None takes those of the household objects.
            extra_lexicon: a further lexicon file, in the format of `lexicon.yaml`.

        Raises:
            DataError: a file is not as expected; says where.
            UnknownNameError: there is no such language.
        """
        folder = _folder(language)
        degrees = load_degrees()
        grammar = load_grammar(folder / "grammar.yaml", degrees=degrees.intervals)
        inflection = load_inflection(folder / "inflection.yaml")
        combinator = Combinator(grammar.unary)
        book = WordBook(grammar, inflection, combinator)
        for name in _WORD_FILES:
            book.read(folder / name)
        if extra_lexicon is not None:
            book.read(extra_lexicon)
        names = vocabulary if vocabulary is not None else household_vocabulary()
        lexicon = Lexicon(book.vocabulary(names), book.lexicon)
        interpreter = Interpreter(degrees.intervals, book.tool_acts(), frozenset(names.contexts))
        listener = Listener(
            grammar,
            lexicon,
            combinator,
            interpreter,
            load_pragmatics(),
            _examples(folder / "examples.yaml", book.contractions),
            load_frames(folder / "frames.yaml", grammar),
        )
        speech = load_speech(
            folder / "answers.yaml", inflection, book.act_names(), book.tool_phrases()
        )
        words = {degrees.intervals[name]: each[0] for name, each in book.qualifiers.items()}
        expression = load_expression(
            folder / "sentences.yaml",
            speech,
            {**words, degrees.intervals[degrees.default]: ""},
            book.tool_acts(),
        )
        return cls(language, listener, speech, expression, book, inflection, degrees)

    def __repr__(self) -> str:
        return f"<Language {self.name}, {len(self.learned)} words learned>"

    def with_words(self, words: Iterable[NewWord]) -> Language:
        """This language with learned words, known from now on in all their forms."""
        added = tuple(word for word in dict.fromkeys(words) if word not in self.learned)
        if not added:
            return self
        senses = [sense for word in added for sense in self.book.named(word.role, word.word)]
        uses = {self.book.bare(word.word): word.word for word in added if word.role == "affordance"}
        interpreter = self.listener.interpreter.knowing(added)
        listener = replace(
            self.listener,
            lexicon=Lexicon(senses, self.listener.lexicon),
            interpreter=replace(interpreter, tool_acts={**uses, **interpreter.tool_acts}),
        )
        return replace(self, listener=listener, learned=(*self.learned, *added))

    @without_collecting
    def understand(
        self,
        text: str,
        *,
        speaker: str = "sam",
        addressee: str = "self",
        discourse: Discourse | None = None,
        insist: Collection[str] = (),
        heard: float = 1.0,
    ) -> Understanding:
        """What a text means; never raises for any text.

        Args:
            text: one utterance.
            speaker: who says it.
            addressee: who is spoken to, `self` for Hilt.
            discourse: what the conversation has spoken of; None at its beginning.
            insist: words that are new although they are close to known ones.
            heard: how surely a recogniser heard it, in [0, 1]; what was not heard well enough to
                be sure what is wanted is asked about.
        """
        situation = Situation(speaker, addressee, discourse or Discourse(), (heard, 1.0))
        tokens = tokenize(text, self.book.contractions)
        untagged = self.book.asides.untagged(tokens)
        tokens = tokens if untagged.asks else untagged
        problem = self._problem(text, tokens)
        if problem is not None:
            return _without_reading(tokens, situation, problem)
        found = self._understood(tokens, situation, insist)
        if found.reading is None or self.listener.pragmatics.is_enough(found.reading.sure):
            return found
        question = AskBack(self.say("heard_badly", text=found.text), (found.text,))
        return _without_reading(tokens, situation, question)

    def _understood(
        self, tokens: Tokens, situation: Situation, insist: Collection[str]
    ) -> Understanding:
        found = self._taken(tokens, situation, insist)
        if found.reading is None and BREAK in tokens.words:
            again = self._taken(tokens.without_breaks(), situation, insist)
            found = again if again.reading is not None else found
        if _is_open(found.meaning):
            again = self._in_turn(tokens, situation, insist)
            again = again or self._without_asides(tokens, situation, insist)
            if not again and not (found.readings and _is_slip(found.meaning)):
                again = self._in_frames(tokens, situation, insist)
                if (
                    again
                    and again.reading is None
                    and not isinstance(found.meaning, Misunderstanding)
                ):
                    again = None
            return replace(again, text=tokens.text) if again else found
        return found

    def say(self, key: str, **slots: Slot) -> str:
        """An answer of `answers.yaml`, with its slots filled."""
        return self.speech.say(key, **slots)

    def generate(self, meaning: Meaning) -> str:
        """A sentence that means it: understood again, it gives the same meaning.

        Raises:
            UnknownNameError: the language has no sentence for a meaning of this shape.
        """
        return self.expression.sentence(meaning)

    def phrase(self, rule: Rule) -> str:
        """A rule in words: "to pass a knife, grab it by the blade"."""
        return self.speech.rule(rule)

    @cached_property
    def known_words(self) -> frozenset[str]:
        """Every single word that the lexicon has."""
        return frozenset(self.listener.lexicon.words())

    @cached_property
    def named_words(self) -> frozenset[str]:
        """Every single word that is part of a name: of an object, a use, a property, ..."""
        names = self.listener.lexicon.names
        return frozenset(
            word for kind in NOUNS for name in names.get(kind, ()) for word in name.split(" ")
        )

    @cached_property
    def _unnamed_words(self) -> frozenset[str]:
        """Words of turns of phrase that name nothing yet, and may be taught as names."""
        return self.book.names_too - self.named_words

    def _problem(self, text: str, tokens: Tokens) -> Meaning | None:
        """Why a text is not even tried, None when it is."""
        if len(text) > MAX_CHARACTERS:
            return Misunderstanding(self.say("too_long", limit=f"{MAX_CHARACTERS} characters"))
        if len(tokens.items) > MAX_TOKENS:
            return Misunderstanding(self.say("too_long", limit=f"{MAX_TOKENS} words"))
        if not tokens.items:
            return Misunderstanding(self.say("empty"), nearest=())
        unknown = self._unknown(tokens)
        strange = [token for token in unknown if not is_word(token)]
        if strange or len({token.word for token in unknown}) > MAX_NEW_WORDS:
            return self._not_known(tokens, strange or unknown)
        return None

    def _without_asides(
        self, tokens: Tokens, situation: Situation, insist: Collection[str]
    ) -> Understanding | None:
        """An utterance without what is said by the way; None when that is none either."""
        tried = {tokens.words}
        for each in self._versions(tokens):
            if each.words in tried or not each.items:
                continue
            tried.add(each.words)
            for whole in filter(_says_something, (each, each.without_breaks())):
                found = self._taken(whole, situation, insist)
                if found.reading is not None:
                    return found
            again = self._in_turn(each, situation, insist)
            if again is not None:
                return again
        return None

    def _in_frames(
        self, tokens: Tokens, situation: Situation, insist: Collection[str]
    ) -> Understanding | None:
        """An utterance by the things that it names; None when that is nothing either."""
        asks: Understanding | None = None
        for each in filter(_says_something, dict.fromkeys(self._versions(tokens))):
            found = self._taken(each, situation, insist, in_frames=True)
            again = found
            if found.reading is None:
                again = self._in_turn(each, situation, insist, in_frames=True) or found
            if again.reading is not None:
                return again
            if asks is None and isinstance(found.meaning, AskBack):
                asks = found
        return asks

    def _versions(self, tokens: Tokens) -> Iterator[Tokens]:
        """The utterance in other words that mean the same, those closest to it first."""
        asides, degrees = self.book.asides, self.book.degree_phrases
        untagged = asides.untagged(tokens)
        for each in (untagged, self.book.lengthened(untagged)):
            yield each
            bare = asides.removed(each, degrees)
            yield bare
            yield fronted(bare, degrees) or bare

    def _in_turn(
        self,
        tokens: Tokens,
        situation: Situation,
        insist: Collection[str],
        *,
        in_frames: bool = False,
    ) -> Understanding | None:
        """An utterance as several moves that come to one meaning; None when they do not."""

        def take(move: Tokens, situation: Situation) -> Understanding:
            found = self._taken(move, situation, insist)
            if in_frames and found.reading is None:
                return self._taken(move, situation, insist, in_frames=True)
            return found

        def topic(move: Tokens, situation: Situation) -> Form | None:
            return self.listener.topic(self.listener.chart(move, {}), situation)

        def is_general(move: Tokens) -> bool:
            return self.listener.is_general(self.listener.chart(move, {}))

        return Moves(take, topic, is_general).in_turn(tokens, situation)

    def _slip(self, words: Iterable[NewWord], insist: Collection[str]) -> AskBack | None:
        """The question back when a new word is close to a known one of its kind."""
        lexicon = self.listener.lexicon
        framed = self.listener.frames.words
        for word in words:
            if word.said in insist or word.said in framed:
                continue
            close = nearest(word.said, names_like(word.role, lexicon))
            if close is not None:
                return self._did_you_mean(word.said, close)
            for part in word.said.split(" ") if " " in word.said else ():
                close = None if part in self.known_words else nearest(part, self.named_words)
                if close is not None:
                    return self._did_you_mean(part, close)
        return None

    def _slip_anywhere(self, unknown: list[Token], insist: Collection[str]) -> AskBack | None:
        """The question back when an unknown word of an unknown kind is close to a known one."""
        for token in unknown:
            if token.word in insist:
                continue
            close = nearest(token.word, self.named_words) or misspelt(token.word, self.known_words)
            if close is not None:
                return self._did_you_mean(token.word, close)
        return None

    def _did_you_mean(self, word: str, close: str) -> AskBack:
        return AskBack(self.say("did_you_mean", word=word, suggestion=close), (close,))

    def _unknown(self, tokens: Tokens) -> list[Token]:
        lexicon, closed = self.listener.lexicon, self.book.closed | self.listener.frames.words
        return [
            token
            for token in tokens.items
            if token.word not in lexicon and token.word not in closed
        ]

    def _taken(
        self,
        tokens: Tokens,
        situation: Situation,
        insist: Collection[str],
        *,
        in_frames: bool = False,
    ) -> Understanding:
        unknown = self._unknown(tokens)
        chart = self.listener.chart(tokens, self._guesses(tokens, unknown))
        readings, refusal = self.listener.readings(chart, tokens, situation, in_frames=in_frames)
        clear = [reading for reading in readings if _may_teach(reading)]
        chosen = decide(clear)
        if chosen is not None:
            slip = self._slip(chosen.new_words, insist)
            if slip is None:
                return _with_reading(tokens, situation, chosen, len(clear))
            return replace(_without_reading(tokens, situation, slip), readings=len(clear))
        meaning: Meaning
        if clear:
            words = (word for reading in clear for word in reading.new_words)
            meaning = self._slip(words, insist) or self._several(clear)
        elif readings:
            slip = self._slip(readings[0].new_words, insist)
            meaning = slip or self._which_thing(readings[0]) or self._not_known(tokens, unknown)
        elif unknown:
            meaning = self._slip_anywhere(unknown, insist) or self._not_known(tokens, unknown)
        else:
            meaning = self._unclear(chart, tokens, refusal)
        return replace(_without_reading(tokens, situation, meaning), readings=len(clear))

    def _which_thing(self, reading: Reading) -> AskBack | None:
        """The question back when an act is asked for on things of an unknown name."""
        if not isinstance(reading.meaning, Command) or not all(map(_is_name, reading.new_words)):
            return None
        return AskBack(self.say("unknown_thing", words=[each.said for each in reading.new_words]))

    def _guesses(self, tokens: Tokens, unknown: list[Token]) -> Mapping[int, Sequence[Entry]]:
        found = {
            place: guesses(
                token, self.book, self.inflection, cost=0.0 if token in unknown else _KNOWN_COST
            )
            for place, token in enumerate(tokens.items)
            if token in unknown or token.word in self._unnamed_words
        }
        for place, pair in enumerate(pairwise(tokens.items)):
            is_cut = place + 1 in tokens.pauses
            if not is_cut and all(token.word not in self.book.closed for token in pair):
                first, second = (token.word for token in pair)
                names = compounds(first, second, self.book, self.inflection, self.listener.lexicon)
                if names:
                    found[place] = [*found.get(place, ()), *names]
        return found

    def _several(self, readings: Sequence[Reading]) -> AskBack:
        choices = tuple(self._choice(reading.meaning) for reading in readings)
        return AskBack(self.say("which_meaning", choices=choices), choices)

    def _unclear(self, chart: Chart, tokens: Tokens, refusal: RefusedError | None) -> Meaning:
        """What to answer when all words are known, but the whole has no meaning."""
        if refusal is not None:
            said = self.say(refusal.key, **refusal.slots)
            if refusal.asks:
                return AskBack(said)
            return Misunderstanding(said, nearest=self.listener.nearest(tokens.words))
        where, expected = self.listener.failure(chart, tokens)
        if expected:
            message = self.say("not_understood_after", where=where, expected=" or ".join(expected))
        else:
            message = self.say("not_understood", text=tokens.text)
        return Misunderstanding(message, where, expected, self.listener.nearest(tokens.words))

    def _choice(self, meaning: Meaning) -> str:
        if isinstance(meaning, Statement):
            return self.speech.listed([self.phrase(rule) for rule in meaning.rules])
        try:
            return f'"{self.generate(meaning)}"'
        except UnknownNameError:
            return str(meaning.as_json())

    def _not_known(self, tokens: Tokens, unknown: Sequence[Token]) -> Misunderstanding:
        words = list(dict.fromkeys(token.word for token in unknown))
        if len(words) == 1:
            message = self.say("unknown_word", word=words[0])
        else:
            message = self.say("unknown_words", words=words[:MAX_NEW_WORDS])
        known = [token.word for token in tokens.items if token not in unknown]
        return Misunderstanding(message, nearest=self.listener.nearest(known))


def _says_something(tokens: Tokens) -> bool:
    return any(token.word != BREAK for token in tokens.items)


def _is_open(meaning: Meaning) -> bool:
    """Whether an utterance may still be understood in another way: it has not several meanings."""
    return isinstance(meaning, Misunderstanding) or (
        isinstance(meaning, AskBack) and len(meaning.choices) <= 1
    )


def _is_slip(meaning: Meaning) -> bool:
    """Whether the question back is if another word was meant."""
    return isinstance(meaning, AskBack) and bool(meaning.choices)


def _may_teach(reading: Reading) -> bool:
    """New words come in with what is taught; a question may ask about unknown things and uses."""
    if not reading.new_words or isinstance(reading.meaning, Statement):
        return True
    asks = isinstance(reading.meaning, Question) and len(reading.new_words) <= 2
    return asks and all(map(_is_name, reading.new_words))


def _is_name(word: NewWord) -> bool:
    """Whether a word names a thing or a use, alone."""
    return word.role in {"object", "affordance"} and " " not in word.said


def _with_reading(
    tokens: Tokens, situation: Situation, reading: Reading, readings: int
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


def _without_reading(tokens: Tokens, situation: Situation, meaning: Meaning) -> Understanding:
    return Understanding(
        tokens.text,
        situation.speaker,
        situation.addressee,
        meaning,
        words=tokens.words,
        discourse=situation.discourse,
    )


def _folder(language: str) -> Path:
    known = [path.parent.name for path in LANGUAGES_FOLDER.glob("*/lexicon.yaml")]
    if language not in known:
        raise UnknownNameError("language", language, known)
    return LANGUAGES_FOLDER / language


def _examples(
    path: Path, contractions: Mapping[str, tuple[str, ...]]
) -> Mapping[str, frozenset[str]]:
    items = read_yaml(path).entries(required=("examples",), optional=())["examples"].texts()
    return {text: frozenset(tokenize(text, contractions).words) for text in items}
