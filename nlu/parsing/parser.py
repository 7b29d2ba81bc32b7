# SPDX-License-Identifier: Apache-2.0
"""From tokens to the readings of an utterance, and to the reasons when there is none.

All words are used or the utterance is refused: only derivations of the whole are looked at. Of
several meanings the cheapest is taken; when two different ones are equally likely, Hilt asks.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ..grammar.categories import Category, Functor
from ..grammar.combinators import Combinator
from ..grammar.grammar import Grammar
from ..lexicon.lexicon import Entry, Lexicon
from ..lexicon.tokenizer import Tokens
from ..lexicon.unknown_words import new_words
from ..semantics.coreference import IT, SOMETHING, Discourse, RefusedError, resolved
from ..semantics.interpretation import Interpreter, reply
from ..semantics.meaning import AskBack, Confidence, Meaning, Misunderstanding, Statement
from ..semantics.pragmatics import CERTAIN, Intention, Pragmatics
from ..semantics.predicates import Form, form_of
from ..semantics.questions import question
from .chart import Chart, Derivation
from .derivation import categories_of, lexical_entries
from .frame_parser import wholes
from .frames import Frames
from .understanding import Reading

MAX_EXPECTED = 5
_WORD_COST = 1e-3  # of two readings alike that with longer turns of phrase is likelier
MAX_NEAREST = 3


@dataclass(frozen=True)
class UtteranceContext:
    """Who speaks to whom, and after what.

    Attributes:
        speaker: who speaks, as a name of a form.
        addressee: who is spoken to.
        discourse: what was spoken of before.
        heard: how sure it is that this was said, (lower, upper) in [0, 1].
        charts: what the tokens of this utterance can be, by words, capitals and pauses; for what is
            tried in several ways.
    """

    speaker: str
    addressee: str
    discourse: Discourse
    heard: Confidence = CERTAIN
    charts: dict[object, Chart] = field(default_factory=dict[object, Chart], compare=False)


@dataclass(frozen=True)
class Listener:
    """What is needed to take an utterance in.

    Attributes:
        grammar: categories, and which of them are utterances.
        lexicon: the words.
        combinator: what combines.
        interpreter: what forms mean.
        pragmatics: what speech acts are meant for.
        examples: sentences that are understood, with their words.
        frames: what is meant by the things named, in any order.
    """

    grammar: Grammar
    lexicon: Lexicon
    combinator: Combinator
    interpreter: Interpreter
    pragmatics: Pragmatics
    examples: Mapping[str, frozenset[str]]
    frames: Frames

    def chart(self, tokens: Tokens, guesses: Mapping[int, Sequence[Entry]]) -> Chart:
        """All that the tokens can be."""
        return Chart(tokens.words, self.lexicon, self.combinator, guesses)

    def readings(
        self, chart: Chart, tokens: Tokens, situation: UtteranceContext, *, in_frames: bool = False
    ) -> tuple[list[Reading], RefusedError | None]:
        """Every different meaning of the whole utterance, the likeliest first.

        Args:
            chart: all that the tokens can be.
            tokens: the utterance.
            situation: who speaks to whom, and after what.
            in_frames: whether to go by the things it names, in any order, and not by the grammar.

        Returns:
            The readings, and why the likeliest of the others has no meaning.
        """
        best: dict[Meaning, Reading] = {}
        refusal: RefusedError | None = None
        found = self._in_frames(chart, tokens) if in_frames else self._derivations(chart)
        for act, derivation in found:
            form = form_of(derivation.value)
            try:
                reading = self._reading(act, form, derivation, tokens, situation)
            except RefusedError as error:
                refusal = refusal or error
                continue
            known = best.get(reading.meaning)
            if known is None or reading.cost < known.cost:
                best[reading.meaning] = reading
        return sorted(best.values(), key=lambda reading: reading.cost), refusal

    def topic(self, chart: Chart, situation: UtteranceContext) -> Form | None:
        """The thing that an utterance only names, None when it does not."""
        for derivation in chart.derivations(self.grammar.topic):
            form = _named(form_of(derivation.value), situation)
            if IT not in form and not new_words(lexical_entries(derivation)):
                return form
        return None

    def is_general(self, chart: Chart) -> bool:
        """Whether what an utterance names is any object of a kind: "knives", "a knife"."""
        return any(
            self.grammar.general in categories_of(derivation)
            for derivation in chart.derivations(self.grammar.topic)
        )

    def failure(self, chart: Chart, tokens: Tokens) -> tuple[str, tuple[str, ...]]:
        """The longest span that was understood, and what was expected after it."""
        start, end = chart.longest_span()
        categories = sorted(chart.categories(start, end), key=_simplest_first)
        expected = (
            self.grammar.described(category.argument)
            for category in categories
            if isinstance(category, Functor) and category.forward
        )
        return tokens.span(start, end), _each_once(filter(None, expected))[:MAX_EXPECTED]

    def nearest(self, words: Iterable[str]) -> tuple[str, ...]:
        """The example sentences that share most words with an utterance."""
        said = frozenset(words)
        if not said:
            return ()

        def likeness(sentence: str) -> float:
            known = self.examples[sentence]
            return 2 * len(known & said) / (len(known) + len(said))

        ranked = sorted(self.examples, key=likeness, reverse=True)
        return tuple(each for each in ranked[:MAX_NEAREST] if likeness(each) > 0)

    def _intention(self, said: Form, heard: Confidence) -> Intention:
        """The one thing that is meant by a speech act, as sure as the act was heard."""
        meant = self.pragmatics.meant(said)
        if len(meant) != 1:
            raise RefusedError("which_intention", asks=True)
        if heard == CERTAIN:
            return meant[0]
        weighed = self.pragmatics.intentions(said, heard)
        return next(each for each in weighed if each.form == meant[0].form)

    def _derivations(self, chart: Chart) -> list[tuple[str, Derivation]]:
        found = [
            (act, derivation)
            for category, act in self.grammar.roots.items()
            for derivation in chart.derivations(category)
        ]
        return sorted(found, key=lambda each: each[1].cost)

    def _in_frames(self, chart: Chart, tokens: Tokens) -> list[tuple[str, Derivation]]:
        found = sorted(wholes(self.frames, tokens, chart), key=lambda each: each.cost)
        named = (whole for whole in found if not _on_anything(form_of(whole.value)))
        return [(self.grammar.roots[whole.category], whole) for whole in named]

    def _reading(
        self,
        act: str,
        form: Form,
        derivation: Derivation,
        tokens: Tokens,
        situation: UtteranceContext,
    ) -> Reading:
        form = resolved(_named(form, situation), situation.discourse)
        words = new_words(lexical_entries(derivation))
        interpreter = self.interpreter.knowing(words)
        act = _asked(act, form, tokens)
        if act == "QUESTION" and form.name in {"implies", "and"}:
            form = Form("isTrue", (form,))
        said = Form(act, (Form(situation.speaker), Form(situation.addressee), form))
        intention = self._intention(said, situation.heard)
        return Reading(
            said,
            intention.form,
            intention.interval,
            _meaning(intention.form, interpreter, situation.discourse),
            derivation.cost + _WORD_COST * sum(1 for _ in lexical_entries(derivation)),
            derivation,
            words,
        )


def _each_once(descriptions: Iterable[str]) -> tuple[str, ...]:
    """Descriptions without those that another one begins with: "is", beside "is" or "are"."""
    found = tuple(dict.fromkeys(descriptions))
    return tuple(
        one for one in found if not any(o != one and o.startswith(f"{one} or ") for o in found)
    )


def _simplest_first(category: Category) -> tuple[int, int, str]:
    shown = str(category)
    return shown.count("/") + shown.count("\\"), len(shown), shown


def decide(readings: Sequence[Reading]) -> Reading | None:
    """The reading to go by: the cheapest, None when several are."""
    if not readings:
        return None
    best = [reading for reading in readings if reading.cost == readings[0].cost]
    return best[0] if len(best) == 1 else None


def after(meaning: Meaning, act: Form, before: Discourse) -> Discourse:
    """What the conversation has spoken of once an utterance was taken in."""
    if isinstance(meaning, (AskBack, Misunderstanding)):
        return before
    held = _spoken_of(act)
    known = replace(before, object=held) if held is not None else before
    return replace(known, rule=meaning.rules[-1]) if isinstance(meaning, Statement) else known


def _meaning(intention: Form, interpreter: Interpreter, discourse: Discourse) -> Meaning:
    content = intention.arguments[-1]
    match intention.name:
        case "wantBelieve" if content.name in {"alsoOf", "alsoFor", "alsoBy"}:
            return interpreter.likewise(content, discourse)
        case "wantBelieve":
            return interpreter.statement(content)
        case "want":
            return interpreter.command(content)
        case "wantKnow":
            return question(content, interpreter)
        case "wantRevise":
            return interpreter.correction(content, discourse)
        case _:
            return reply(content)


def _spoken_of(form: Form) -> Form | None:
    """The object that a form is about: the last one named in it."""
    if form.name == "partOf":
        return form.arguments[1]
    if form.name == "and":
        return _spoken_of(form.arguments[-1])
    if form.name == "implies" and form.arguments[1].name != "graspObject":
        return form.arguments[0]
    if form.name in _OBJECT_FIRST and form.arguments and not _spoken_in(form):
        return form.arguments[0]
    is_act = form.name in _OBJECT_SECOND or form.arguments[:1] == (_HILT,)
    if is_act and len(form.arguments) > 1:
        # Of an act with a tool it is what it is done to, if that was named.
        return next((each for each in form.arguments[1:] if each.name not in SOMETHING), None)
    return _spoken_in(form)


_HILT = Form("self")
_OBJECT_FIRST = frozenset({"usesOf", "about", "see", "source", "why", "whyNot"})
_OBJECT_SECOND = frozenset({"pass", "pickUp", "pointTo", "grasp", "use", "need", "have"})


def _spoken_in(form: Form) -> Form | None:
    for part in form.arguments:
        found = _spoken_of(part)
        if found is not None:
            return found
    return None


def _on_anything(form: Form) -> bool:
    """Whether it is a rule for an act on a thing without a name, which a frame may only guess."""
    if form.name == "and":
        return any(map(_on_anything, form.arguments))
    is_action = form.name == "implies" and form.arguments[1].name == "graspObject"
    return is_action and any(part.name in SOMETHING for part in form.arguments[0])


def _named(form: Form, situation: UtteranceContext) -> Form:
    names = {"speaker": Form(situation.speaker), "self": Form(situation.addressee)}
    return form.mapped(lambda part: names.get(part.name) if not part.arguments else None)


def _asked(act: str, form: Form, tokens: Tokens) -> str:
    """The speech act, where a question mark makes another one of it."""
    if not tokens.asks:
        return act
    if act == "INSTRUCT":
        raise RefusedError("as_question", asks=True)
    return "QUESTION" if act == "STATEMENT" and form.name in {"implies", "and"} else act
