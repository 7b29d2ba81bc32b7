"""The parser: from the tokens of one sentence to its readings, the likeliest first.

Only derivations of the whole token sequence count, so that no word is ever dropped. A derivation
comes from the CCG chart; its predicate form is resolved, becomes a speech act, then a meaning.
"""

import contextlib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from ..grammar.categories import Functor
from ..grammar.combinators import CombinationTable
from ..grammar.grammar import Grammar
from ..lexicon.learned_lexicon import LearnedLexicon
from ..lexicon.lexicon import Entry
from ..lexicon.tokenizer import Tokens
from ..lexicon.unknown_words import new_words
from ..lexicon.vocabulary import NewWord
from ..semantics import predicates
from ..semantics.clause_features import FeatureReader
from ..semantics.coreference import PRONOUNS, resolve
from ..semantics.discourse import SOMETHING, Discourse
from ..semantics.interpretation import KIND_FORMS, Interpreter, short_answer
from ..semantics.licence_table import LicenceTable
from ..semantics.meaning import Answer, AskBack, Confidence, Meaning, NormStatement, Question
from ..semantics.norm_interpretation import meaning_of
from ..semantics.predicates import CERTAIN, Intention, PredicateForm, UninterpretableError, form_of
from .chart import Chart, Derivation, lexical_entries, subderivations
from .understanding import Reading, UtteranceContext

MAX_EXPECTED = 5
Topic = tuple[PredicateForm, tuple[NewWord, ...]]  # an object, and the new words that name it

_WORD_COST = 1e-3  # of two readings alike that with longer turns of phrase is likelier

_STATED = frozenset({"implies", "and", "says", "stateOf", *KIND_FORMS})
"""The forms of statements, which a question mark makes questions."""


@dataclass(frozen=True)
class SentenceParser:
    """Finds the readings of one sentence."""

    grammar: Grammar
    lexicon: LearnedLexicon
    combinator: CombinationTable
    interpreter: Interpreter
    pragmatics: predicates.Pragmatics
    features: FeatureReader
    licence: LicenceTable

    def chart(self, tokens: Tokens, guesses: Mapping[int, Sequence[Entry]]) -> Chart:
        """Return the filled chart of a token sequence, with guesses for the words at positions."""
        return Chart(tokens.words, self.lexicon, self.combinator, guesses)

    def readings(
        self, chart: Chart, tokens: Tokens, context: UtteranceContext
    ) -> tuple[list[Reading], UninterpretableError | None]:
        """Return the readings, one a meaning, likeliest first, and why the best other has none."""
        best: dict[Meaning, Reading] = {}
        refusal: UninterpretableError | None = None
        found = [
            (act, derivation)
            for category, act in self.grammar.roots.items()
            for derivation in chart.derivations(category)
        ]
        for act, derivation in sorted(found, key=lambda each: each[1].cost):
            try:
                reading = self._reading(act, derivation, tokens, context)
            except UninterpretableError as error:
                refusal = refusal or error
                continue
            known = best.get(reading.meaning)
            if known is None or reading.cost < known.cost:
                best[reading.meaning] = reading
        return sorted(best.values(), key=lambda reading: reading.cost), refusal

    def topic(self, chart: Chart, context: UtteranceContext) -> Topic | None:
        """Return the object that an utterance consists of, None when it is more than a name."""
        for derivation in chart.derivations(self.grammar.topic):
            form = _fill_persons(form_of(derivation.value), context)
            words = new_words(lexical_entries(derivation))
            if PRONOUNS.isdisjoint(form) and all(word.role == "object" for word in words):
                return form, words
        return None

    def named_object(self, tokens: Tokens) -> str | None:
        """Return the kind of object that tokens name, with or without properties; else None."""
        for derivation in self.chart(tokens, {}).derivations(self.grammar.topic):
            form = form_of(derivation.value)
            while form.name == "having":
                form = form.arguments[0]
            if not form.arguments and form not in PRONOUNS and form.name not in SOMETHING:
                return form.said
        return None

    def answers(self, chart: Chart, discourse: Discourse) -> list[Answer]:
        """Return the short answers that an utterance may be, the likeliest first."""
        found: list[Answer] = []
        for derivation in sorted(chart.derivations(self.grammar.answer), key=lambda d: d.cost):
            with contextlib.suppress(UninterpretableError):
                found.append(short_answer(resolve(form_of(derivation.value), discourse)))
        return found

    def is_generic(self, chart: Chart) -> bool:
        """Whether an utterance only names any object of a kind: "knives", "a knife"."""
        return any(
            part.category == self.grammar.general
            for derivation in chart.derivations(self.grammar.topic)
            for part in subderivations(derivation)
        )

    def failure(self, chart: Chart, tokens: Tokens) -> tuple[str, tuple[str, ...]]:
        """Return the text of the longest span with a category, and what was expected after it."""
        start, end = chart.longest_span()
        named = {str(category): category for category in chart.categories(start, end)}
        simplest = sorted(named, key=lambda name: (sum(map(name.count, "/\\")), len(name), name))
        categories = (named[name] for name in simplest)
        forward = (each for each in categories if isinstance(each, Functor) and each.forward)
        expected = (self.grammar.described(each.argument) for each in forward)
        found = tuple(dict.fromkeys(filter(None, expected)))
        # Nothing is lost without "is" beside "is or are".
        kept = (one for one in found if not any(o.startswith(f"{one} or ") for o in found))
        return tokens.span(start, end), tuple(kept)[:MAX_EXPECTED]

    def _reading(
        self, act: str, derivation: Derivation, tokens: Tokens, context: UtteranceContext
    ) -> Reading:
        form = _fill_persons(form_of(derivation.value), context)
        parts = {part.category for part in subderivations(derivation)}
        general, speaker = self.grammar.general, self.grammar.speaker
        is_for_now = general not in parts and not parts.isdisjoint(speaker)
        discourse = replace(context.discourse, rule=None) if is_for_now else context.discourse
        form = resolve(form, discourse)
        entries = lexical_entries(derivation)
        words, fragments = new_words(entries), predicates.load_predicates().fragments
        begins = tokens.words[:2]  # "and what about a spoon" asks without a question mark, too
        is_asked = not self.features.words["interrogative"].isdisjoint(begins)
        is_asked = tokens.asks or (is_asked and act == "FRAGMENT")
        if is_asked and (act == "FRAGMENT" or form.name in fragments):
            act, form = "FRAGMENT", PredicateForm("asked", (form,))
        act = "CORRECT" if form.name == "correctPart" else act
        is_denied_wish = form.name == "want" and form.arguments[-1].name == "not"
        if tokens.asks and (act == "INSTRUCT" or (act == "STATEMENT" and is_denied_wish)):
            raise UninterpretableError("as_question", asks=True)
        if tokens.asks and form.name == "okay":  # "got it?"
            act, form = "QUESTION", PredicateForm("repeated")
        if (act == "QUESTION" or (tokens.asks and act == "STATEMENT")) and form.name in _STATED:
            act, form = "QUESTION", PredicateForm("isTrue", (form,))
        people = PredicateForm(context.speaker), PredicateForm(context.addressee)
        speech_act = PredicateForm(act, (*people, form))
        meant = self._intention(speech_act, context.recognition)
        meaning = meaning_of(meant.form, self.interpreter.with_words(words), context.discourse)
        if isinstance(meaning, NormStatement) and tokens.asks:
            meaning = Question("may", norm=replace(meaning.norms[0], norm="permitted"))
        elif isinstance(meaning, NormStatement) and is_for_now:
            meaning = _norm_with_speaker(meaning, self.features.of_words(tokens.words))
        cost = derivation.cost + _WORD_COST * len(entries)
        return Reading(speech_act, meant.form, meant.interval, meaning, cost, derivation, words)

    def _intention(self, speech_act: PredicateForm, recognition: Confidence) -> Intention:
        meant = self.pragmatics.meant(speech_act)
        if len(meant) != 1:
            raise UninterpretableError("which_intention", asks=True)
        if recognition == CERTAIN:
            return meant[0]
        weighed = self.pragmatics.intentions(speech_act, recognition)
        return next(each for each in weighed if each.form == meant[0].form)


def decide(readings: Sequence[Reading]) -> Reading | None:
    """Return the cheapest of sorted readings, None when there is none or several cost the same."""
    best = [reading for reading in readings if reading.cost == readings[0].cost]
    return best[0] if len(best) == 1 else None


def _norm_with_speaker(said: NormStatement, features: Collection[str]) -> Meaning:
    norm, *others = said.norms
    if norm.norm == "obliged" or others:
        raise UninterpretableError("not_a_rule")
    if norm.norm == "permitted":
        return AskBack(choices=(norm.act,))  # "you may pass me the knife"
    return said if "standing" in features else replace(norm.act, negated=True)


def _fill_persons(form: PredicateForm, context: UtteranceContext) -> PredicateForm:
    names = {"speaker": PredicateForm(context.speaker), "self": PredicateForm(context.addressee)}
    return form.mapped(lambda part: names.get(part.name) if not part.arguments else None)
