"""Clarification: what Hilt answers when an utterance has no single clear reading.

The answer names the reason (a word that is not known, the longest span understood, two different
meanings) or asks a question: whether a known word was meant that is one letter away from a new one.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain, pairwise

from ...ontology.errors import UnknownNameError
from ..generation.realizer import Realizer
from ..generation.templates import AnswerTemplates
from ..lexicon.misspelling import MIN_LETTERS, intended_word, slips
from ..lexicon.tokenizer import MAX_CHARACTERS, MAX_TOKENS, Token, Tokens
from ..lexicon.unknown_words import MAX_NEW_WORDS, KnownWords, is_word, new_recipients
from ..lexicon.vocabulary import NewWord
from ..semantics import meaning as meanings
from ..semantics.licence_table import ACCEPT
from ..semantics.meaning import AskBack, Misunderstanding
from ..semantics.predicates import UninterpretableError
from .chart import Chart, lexical_entries
from .parser import SentenceParser
from .understanding import Reading

MAX_CHOICES = 3  # of which one is asked for
MAX_NEAREST = 3


@dataclass(frozen=True, repr=False)
class Clarifier:
    """Makes the answers to what was not understood, with examples (each with its words)."""

    parser: SentenceParser
    known_words: KnownWords
    answers: AnswerTemplates
    realizer: Realizer
    examples: Mapping[str, frozenset[str]]

    def of_input(self, text: str, tokens: Tokens) -> Misunderstanding | None:
        """The reason not to parse a text at all, None when it can be parsed."""
        is_long = len(text) > MAX_CHARACTERS
        if is_long or len(tokens.items) > MAX_TOKENS:
            limit = f"{MAX_CHARACTERS} characters" if is_long else f"{MAX_TOKENS} words"
            return Misunderstanding(self.answers.say("too_long", limit=limit))
        if not tokens.items:
            return Misunderstanding(self.answers.say("empty"))
        no_words = [token for token in self.known_words.unknown(tokens) if not is_word(token.word)]
        return self.of_unknown_words(tokens, no_words) if no_words else None

    def of_new_words(
        self, readings: Iterable[Reading], tokens: Tokens, accepted: Collection[str]
    ) -> AskBack | None:
        """The question whether a new word is a misspelled name of its kind, None when none is.

        Words in `accepted` are new although they are close to known ones. It is also asked whether
        what the language has as a part, like "handle", is an object of its own. Instead of a
        person, who is named anywhere, any word may be meant: "pass plese the mug".
        """
        readings = tuple(readings)
        people = (lexical_entries(each.derivation) for each in readings)
        for word in chain.from_iterable(map(new_recipients, people)):
            is_of_grammar = self.known_words.builder.is_of_grammar
            near = slips(word.said) if len(word.said) > MIN_LETTERS else ()
            close = self._intended_any(word.said) or next(filter(is_of_grammar, near), None)
            if close and word.said not in accepted:
                return self._did_you_mean(word.said, close)
        for reading, word in ((each, word) for each in readings for word in each.new_words):
            if word.said not in accepted and self._may_be_part(word, reading, tokens):
                return AskBack(self.answers.say("also_an_object", word=word.word), (word.said,))
            for part in word.said.split(" "):
                if part in accepted or self.known_words.has(part):
                    continue
                role = word.role if part == word.said else None
                close = self._intended(part, partial(self.known_words.names, role=role))
                if close is not None:
                    return self._did_you_mean(part, close)
        return None

    def _may_be_part(self, word: NewWord, reading: Reading, tokens: Tokens) -> bool:
        is_definite = ("the", word.said) in pairwise(tokens.words)
        is_of_one = is_definite and isinstance(reading.meaning, meanings.Statement)
        is_part = is_of_one or self.parser.features.is_part(word.said, word.word)
        return is_part and self.known_words.is_only_part(word)

    def licensed(self, reading: Reading) -> meanings.Meaning:
        """The meaning of a reading, as sure as its features allow, or whether it is meant."""
        licence = self.parser.licence
        match reading.meaning:
            case AskBack(choices=(choice,)) if not isinstance(choice, str):
                return AskBack(self.answers.offer([self._choice(choice)]), (choice,))
            case _:
                answer = licence.outcome(reading.meaning, reading.features)
        if answer == ACCEPT:
            return licence.weakened(reading.meaning, reading.features)
        if not self.answers.slots(answer):  # no evidence that what it names is of its kind
            return AskBack(self.answers.say(answer))
        said = licence.weakened(reading.meaning, reading.features)
        own = meanings.with_rules(said, source=None)  # "do you say so, too?"
        return AskBack(self.answers.say(answer, meant=self._choice(own)), (own,))

    def of_misspelling(self, unknown: Iterable[Token], accepted: Collection[str]) -> AskBack | None:
        """The question whether an unknown word is a misspelled known one, None when none is."""
        for token in unknown:
            close = None if token.word in accepted else self._intended_any(token.word)
            if close is not None:
                return self._did_you_mean(token.word, close)
        return None

    def of_unknown_words(self, tokens: Tokens, unknown: Sequence[Token]) -> Misunderstanding:
        """The answer that some words are not known."""
        words = list(dict.fromkeys(token.word for token in unknown))
        several = self.answers.say("unknown_words", words=words[:MAX_NEW_WORDS])
        message = several if words[1:] else self.answers.say("unknown_word", word=words[0])
        return Misunderstanding(message, nearest=self._nearest_examples(tokens))

    def of_ambiguity(self, readings: Sequence[Reading]) -> AskBack:
        """The question which one of the cheapest readings was meant."""
        best = [each.meaning for each in readings if each.cost == readings[0].cost]
        offered = (each.choices if isinstance(each, AskBack) else (each,) for each in best)
        meant = (each for some in offered for each in some if not isinstance(each, str))
        choices = tuple(dict.fromkeys(meant))[:MAX_CHOICES]
        return AskBack(self.answers.offer([*map(self._choice, choices)]), choices)

    def of_failure(
        self, chart: Chart, tokens: Tokens, refusal: UninterpretableError | None
    ) -> Misunderstanding | AskBack:
        """The reason why a sentence of known words has no derivation, or that has no meaning."""
        if refusal is not None:
            said = self.answers.say(refusal.key, **refusal.slots)
            if refusal.asks:
                return AskBack(said)
            return Misunderstanding(said, nearest=self._nearest_examples(tokens))
        where, expected = self.parser.failure(chart, tokens)
        where = "" if where == tokens.text.strip() else where  # that is no place in it
        key = "not_answered" if tokens.asks else "not_understood"
        message = self.answers.say(key, text=tokens.text)
        return Misunderstanding(message, where, expected, self._nearest_examples(tokens))

    def _intended_any(self, word: str) -> str | None:
        known = self.known_words
        return self._intended(word, known.names) or self._intended(word, known.has)

    def _intended(self, word: str, is_known: Callable[[str], bool]) -> str | None:
        plural = self.known_words.builder.inflection.form(word, "plural")
        if is_known(plural):  # "knive" has the plural of "knife"
            singulars = self.known_words.origins(plural, "plural")
            return next((each for each in singulars if is_known(each)), None)
        return intended_word(word, is_known, self.known_words.lexicon.letter_clusters)

    def _did_you_mean(self, word: str, close: str) -> AskBack:
        return AskBack(self.answers.say("did_you_mean", word=word, suggestion=close), (close,))

    def _choice(self, meaning: meanings.Meaning) -> str:
        if isinstance(meaning, meanings.Statement):
            return self.answers.join([self.answers.rule_phrase(rule) for rule in meaning.rules])
        if isinstance(meaning, meanings.NormStatement):
            return self.answers.join([self.answers.norm_phrase(norm) for norm in meaning.norms])
        try:
            return f'"{self.realizer.realize(meaning).rstrip("?")}"'
        except UnknownNameError:
            return str(meaning.as_json())

    def _nearest_examples(self, tokens: Tokens) -> tuple[str, ...]:
        said = frozenset(tokens.words)

        def similarity(sentence: str) -> float:
            known = self.examples[sentence]
            return 2 * len(known & said) / (len(known) + len(said))

        alike = (each for each in self.examples if each.endswith("?") == tokens.asks)
        ranked = sorted(alike, key=similarity, reverse=True)
        return tuple(each for each in ranked[:MAX_NEAREST] if similarity(each) > 0)
