"""A language, loaded from data files: understands texts, and says answers and meanings.

>>> language = Language.load()
>>> language.understand("To pass a knife grab it by the blade").semantics
'STATEMENT(sam,self,implies(pass(self,knife),graspObject(self,partOf(blade,knife)),high))'

A second language is a second folder beside `ontology/english`, with the same files. A `Session`
understands the utterances of a conversation one by one, without believing or doing anything.
"""

import gc
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial
from pathlib import Path
from typing import NamedTuple

from ..ontology.confidence import Degrees, load_degrees
from ..ontology.disk_cache import kept
from ..ontology.errors import UnknownNameError
from ..ontology.garbage_collection import paused_garbage_collection
from ..ontology.yaml_reader import read_yaml
from .generation.realizer import Realizer, load_realizer
from .generation.templates import AnswerTemplates, Slot, load_answers
from .grammar.combinators import CombinationTable
from .grammar.grammar import Grammar, load_grammar
from .grammar.word_patterns import load_word_lists
from .lexicon.discourse_markers import ControlPhrases
from .lexicon.inflection import Inflection, load_inflection
from .lexicon.learned_lexicon import LearnedLexicon
from .lexicon.lexicon import Lexicon
from .lexicon.loader import LexiconBuilder
from .lexicon.tokenizer import Tokens, tokenize
from .lexicon.unknown_words import KnownWords
from .lexicon.vocabulary import NewWord, Vocabulary, household_vocabulary
from .offers.checks import OPERATORS, OfferChecks
from .offers.courtesies import Courtesy, CourtesyPhrases, answer_to
from .offers.meaning_shapes import meaning_from_json
from .offers.offers import OfferFinder, choice_of, is_misspelled, load_model
from .offers.phrase_memory import Key, PhrasePattern, meaning_by_phrase, phrase_from
from .parsing.clarification import Clarifier
from .parsing.parser import SentenceParser
from .parsing.periphery import PeripheryReader, PieceReader, load_table
from .parsing.procedures import ProcedureReader
from .parsing.readings import ReadingFilter
from .parsing.strategies import UtteranceParser
from .parsing.understanding import Understanding, UtteranceContext
from .semantics import meaning as meanings
from .semantics.clause_features import FeatureReader, load_features
from .semantics.discourse import Discourse, after_offer
from .semantics.interpretation import Interpreter
from .semantics.licence_table import LicenceTable, load_licence
from .semantics.meaning import Acknowledgement, AskBack, Confidence, Control, Meaning
from .semantics.predicates import Pragmatics, load_pragmatics

LANGUAGES_FOLDER = Path(__file__).parents[1] / "ontology"

_KINDS = "lexicon clauses attitudes constructions requests conversation fragments norms"
_WORD_FILES = tuple(f"{kind}.yaml" for kind in _KINDS.split())
_SAFE = frozenset({"wait", "putDown", "putBack"})  # controls that may be obeyed without need


class LanguageTables(NamedTuple):
    """What the files of a language say, apart from names and answers."""

    degrees: Degrees
    grammar: Grammar
    builder: LexiconBuilder
    pragmatics: Pragmatics
    features: FeatureReader
    licence: LicenceTable


@dataclass(frozen=True, repr=False)
class Language:
    """One language with one vocabulary; immutable."""

    folder: Path
    parser: SentenceParser
    examples: Mapping[str, frozenset[str]]  #: sentences that are understood, each with its words
    answers: AnswerTemplates
    realizer: Realizer
    builder: LexiconBuilder
    inflection: Inflection
    degrees: Degrees
    controls: ControlPhrases
    #: confirmed turns of phrase that the grammar does not have, by their keys
    phrases: Mapping[Key, PhrasePattern] = field(default_factory=dict[Key, PhrasePattern])
    #: the taught actions on several objects or none, with the words between them
    frames: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])

    @classmethod
    @paused_garbage_collection()
    def load(
        cls,
        language: str = "english",
        *,
        vocabulary: Vocabulary | None = None,
        extra_lexicon: Path | None = None,
    ) -> "Language":
        """Load a language; DataError if a file of it is wrong, UnknownNameError if there is none.

        Args:
            language: the name of its folder beside `english`.
            vocabulary: the names of the domain; None takes those of the household objects.
            extra_lexicon: a further lexicon file, in the format of `lexicon.yaml`.
        """
        folder = language_folder(language)
        tables = load_tables(folder)
        degrees, builder = tables.degrees, tables.builder
        if extra_lexicon is not None:
            builder.read(extra_lexicon)
        names = vocabulary if vocabulary is not None else household_vocabulary()
        lexicon = LearnedLexicon(Lexicon(builder.vocabulary(names), builder.lexicon), builder)
        interpreter = Interpreter(degrees.intervals, builder.tool_acts, frozenset(names.contexts))
        combinator, readers = builder.combinator, tables[3:]
        parser = SentenceParser(tables.grammar, lexicon, combinator, interpreter, *readers)
        adverbs = {degrees.intervals[name]: each[0] for name, each in builder.qualifiers.items()}
        adverbs[degrees.intervals[degrees.default]] = ""
        answers = load_answers(folder / "answers.yaml", builder, adverbs)
        realizer = load_realizer(folder / "sentences.yaml", answers)
        if not gc.get_freeze_count():
            # All of a language is kept: make it old at once, without a collection of the young.
            gc.freeze()
            gc.unfreeze()
        sentences = read_yaml(folder / "examples.yaml").entries(required=("examples",), optional=())
        examples = {
            text: frozenset(tokenize(text, builder.contractions).words)
            for text in sentences["examples"].texts()
        }
        controls = ControlPhrases(load_word_lists(folder / "controls.yaml"))
        parts = (answers, realizer, builder, builder.inflection, degrees, controls)
        return cls(folder, parser, examples, *parts)

    def __repr__(self) -> str:
        return f"<Language {self.folder.name}, {len(self.lexicon.learned)} words learned>"

    @paused_garbage_collection()
    def with_words(self, words: Iterable[NewWord]) -> "Language":
        """Return this language with further words, known in all their forms."""
        added = tuple(words)
        lexicon = self.lexicon.with_words(added)
        if lexicon is self.lexicon:
            return self
        interpreter = self.parser.interpreter
        tool_acts = dict(interpreter.tool_acts)
        for word in added:
            if word.role == "affordance":
                tool_acts.setdefault(self.builder.bare_verb(word.word), word.word)
        acts = interpreter.acts.union(word.word for word in added if word.role == "context")
        interpreter = replace(interpreter, tool_acts=tool_acts, acts=acts)
        return replace(self, parser=replace(self.parser, lexicon=lexicon, interpreter=interpreter))

    @paused_garbage_collection()
    def understand(
        self,
        text: str,
        *,
        speaker: str = "sam",
        addressee: str = "self",
        discourse: Discourse | None = None,
        accepted: Collection[str] = (),
        heard: float = 1.0,
    ) -> Understanding:
        """Return the meaning of a text, or why it has none; never raises for any text.

        Args:
            text: one utterance.
            speaker: who says it.
            addressee: who is spoken to, `self` for Hilt.
            discourse: what the conversation mentioned so far; None at its beginning.
            accepted: words that are new although they are close to known ones.
            heard: the confidence of a speech recogniser in the text, in [0, 1]; when it is too low
                to be sure what is wanted, the meaning is a question back.
        """
        context = UtteranceContext(speaker, addressee, discourse or Discourse(), (heard, 1.0))
        tokens = self._tokens(text)
        is_heard = self.parser.pragmatics.is_enough(context.recognition)
        control = self.control(text)
        if not (control and control.is_halt):
            start = self.controls.after_polite(tokens.words)
            control = (control or self._courtesies.trust(tokens, start)) if is_heard else None
        if control:
            return Understanding(text, speaker, addressee, control, discourse=context.discourse)
        introduction = self.introduction(text)
        if introduction and not introduction.rest:
            greeting = Acknowledgement("greeting", introduction.name)
            return Understanding(text, speaker, addressee, greeting, discourse=context.discourse)
        said = introduction.rest if introduction else text
        found = replace(self._understand(said, context, accepted), text=text)
        return self._recalling(found) if found.kind in {"error", "ask_back"} else found

    def _recalling(self, turn: Understanding) -> Understanding:
        found = self.offers.mentions(self._tokens(turn.text), Discourse())
        acts = [m for m in found.names if m.role in {"act", "material"} and not m.is_new]
        uses = (m for m in found.known if (m.start, m.end) in found.required)
        spoken = tuple((m.role, m.name) for m in (*acts, *uses) if m.role != "object")
        return replace(turn, discourse=replace(turn.discourse, spoken=spoken)) if spoken else turn

    def _understand(
        self, text: str, context: UtteranceContext, accepted: Collection[str]
    ) -> Understanding:
        found = self.utterance_parser.understand(text, context, accepted)
        if _is_not_understood(found.meaning, text):
            aside, courtesy = self._control_within(text), self._courtesies.find(self._tokens(text))
            if courtesy and courtesy.kind and not courtesy.rest:
                aside = aside or Acknowledgement(courtesy.kind)
            if aside:
                return replace(found, meaning=aside, discourse=context.discourse)
            found = self._by_phrase(text, context) or self._with_offers(found, context)
        tokens, clarification = self._tokens(text), self.utterance_parser.clarification
        is_lost = found.kind == "error" and _is_not_understood(found.meaning, text)
        is_text = is_lost and not clarification.of_input(text, tokens)
        is_chatter = is_text and self._courtesies.is_by_the_way(tokens, self.offers.is_nothing)
        if is_chatter:
            said = meanings.Misunderstanding(self.answers.say("only_chatter"))
            named = self.offers.mentions(tokens, Discourse()).by_role
            last = found.discourse if "object" in named else context.discourse
            found = replace(found, meaning=said, discourse=last)
        if found.kind in {"error", "ask_back"}:
            found = self._without_courtesies(found, context, is_chatter=is_chatter) or found
        if not isinstance(found.meaning, AskBack):
            return found
        choices = found.meaning.choices
        is_guess = found.reading and context.discourse.has_failed  # of what "it" was
        if is_guess and not all(isinstance(each, meanings.Question) for each in choices):
            return found
        return replace(found, discourse=after_offer(choices, found.discourse))

    def _without_courtesies(
        self, failed: Understanding, context: UtteranceContext, *, is_chatter: bool
    ) -> Understanding | None:
        tokens, text = self._tokens(failed.text), failed.text.strip()
        courtesy = self._courtesies.find(tokens)
        ends = courtesy and text.rstrip(" .!?").endswith(courtesy.rest.rstrip(" .!?"))
        if not courtesy or courtesy.rest == text or not (courtesy.kind or ends):
            return None
        alone = replace(failed, meaning=Acknowledgement(courtesy.kind), reading=None, new_words=())
        alone = replace(alone, discourse=context.discourse)
        if not courtesy.rest:
            choices = failed.meaning.choices if isinstance(failed.meaning, AskBack) else ()
            return alone if courtesy.kind and choices and not isinstance(choices[0], str) else None
        rest = self._understand(courtesy.rest, context, ())
        # Not "Rex, drop it", nor "she told me, drop it".
        is_told = not self._speech.isdisjoint(tokens.words)
        is_own = not is_told and bool(courtesy.kind or not self.offers.known.unknown(tokens))
        if is_own and (control := self.control(courtesy.rest)):
            rest = replace(rest, meaning=control, discourse=context.discourse)
        is_harmless = rest.kind in {"question", "acknowledgement", *["control"] * is_own}
        is_sorry = courtesy.kind == "apology"  # "sorry, forget that"
        is_harmless |= is_sorry and rest.meaning == meanings.Retraction()
        if is_harmless or (rest.kind not in {"error", "ask_back"} and courtesy.is_formal):
            return replace(rest, text=failed.text)
        if not courtesy.kind or not isinstance(failed.meaning, meanings.Misunderstanding):
            return None
        message = self.answers.say(answer_to(courtesy.kind))
        has_content = self._courtesies.has_content(self._tokens(courtesy.rest))
        if is_chatter and courtesy.is_formal and not has_content:
            return alone
        message = message if is_chatter else f"{message} {failed.meaning.message}"
        return replace(failed, meaning=replace(failed.meaning, message=message))

    def _with_offers(self, found: Understanding, context: UtteranceContext) -> Understanding:
        tokens = self._tokens(found.text)
        is_slip = isinstance(found.meaning, AskBack) and bool(found.meaning.choices)
        if is_slip and not is_misspelled(tokens, self.offers.known):
            return found
        at_point = replace(context, discourse=replace(context.discourse, has_failed=False))
        question = self.offers.question(tokens, at_point)
        if isinstance(question, meanings.Question):
            found = replace(found, discourse=after_offer((question,), context.discourse))
        return replace(found, meaning=question) if question else found

    def _by_phrase(self, text: str, context: UtteranceContext) -> Understanding | None:
        named = self.offers.mentions(self._tokens(text), Discourse()) if self.phrases else None
        said = meaning_by_phrase(self.phrases, named) if named else None
        if said is None:
            return None
        sentence = self.generate(meaning_from_json(said))
        found = self.utterance_parser.understand(sentence, context, ())
        return replace(found, text=text) if found.meaning.as_json() == said else None

    def phrase_of(self, text: str, meaning: Meaning) -> PhrasePattern | None:
        """Return the phrase by which a text has a confirmed meaning; None as of `phrase_from`."""
        tokens = self._tokens(text)
        unknown = (token.word for token in self.offers.known.unknown(tokens))
        mentions = self.offers.mentions(tokens, Discourse())
        return phrase_from(mentions, meaning.as_json(), self.tool_acts, unknown)

    def with_phrases(self, phrases: Iterable[PhrasePattern]) -> "Language":
        """Return this language with further turns of phrase; a later one replaces an earlier."""
        return replace(self, phrases={**self.phrases, **{each.key: each for each in phrases}})

    @cached_property
    def _tokens(self) -> Callable[[str], Tokens]:
        return lru_cache(maxsize=8)(partial(tokenize, contractions=self.builder.contractions))

    @cached_property
    def offers(self) -> OfferFinder:
        """What is offered for an utterance that is not understood."""
        words = load_word_lists(self.folder / "offers.yaml")
        intervals = self.degrees.intervals
        # Several steps ask for the meaning of the same text.
        understand = lru_cache(maxsize=32)(partial(self.utterance_parser.understand, accepted=()))
        return OfferFinder(
            load_model(self.folder / "offers.json"),
            OfferChecks(words, self.parser.features, self.parser.licence),
            self.utterance_parser.known_words,
            {phrase: intervals[degree] for phrase, degree in self.builder.degree_of.items()},
            self.tool_acts,
            self.realizer,
            self.usual,
            understand,
        )

    def chosen(self, text: str, count: int) -> int | None:
        """Return which of `count` choices a text takes, from 1; 0 for none, None for no answer."""
        lists = load_word_lists(self.folder / "choices.yaml")
        return choice_of(self._tokens(text).words, count, lists)

    def opposites(self, prop: str) -> set[str]:
        """Return the properties that no thing has together with one: "cold" beside "hot"."""
        pairs = load_word_lists(self.folder / "choices.yaml").phrases("opposites")
        return {other for pair in pairs if prop in pair for other in pair} - {prop}

    def control(self, text: str) -> Control | None:
        """Return the control that a text is ("stop", "put it down"), None for any other text."""
        found = self.controls.match(self._tokens(text), self.parser.named_object)
        return Control(*found) if found else None

    def introduction(self, text: str) -> Courtesy | None:
        """Return who a speaker claims to be in a text and what else it says, None for nobody."""
        return self._courtesies.introduction(self._tokens(text))

    @cached_property
    def _courtesies(self) -> CourtesyPhrases:
        words = load_word_lists(self.folder / "courtesies.yaml")
        return CourtesyPhrases(words, self.utterance_parser.known_words, self.parser.features)

    @property
    def _speech(self) -> frozenset[str]:
        return self.utterance_parser.periphery.reader.words.words("speech")

    def _control_within(self, text: str) -> Control | None:
        """Return "stop" anywhere in a text, or another control beside what says little else."""
        tokens = self._tokens(text)
        parts = [tokens.part(*span) for span in tokens.parts]
        found = [self.control(each.span(0, len(each.items))) for each in parts]
        if any(each and each.control == "stop" for each in found):
            return Control("stop")
        first, one = next(((n, each) for n, each in enumerate(found) if each), (0, None))
        others = [part for part, each in zip(parts[first:], found[first:], strict=True) if not each]
        # Not "she told me, put it down", "here, puss, drop it" or "drop it, I'm tired of it".
        if one is None or one.object or (others and one.control not in _SAFE):
            return None
        is_own = self._speech.isdisjoint(tokens.words) and all(map(self._means_nothing, others))
        return one if is_own and all(map(self._says_nothing, parts[:first])) else None

    def _means_nothing(self, part: Tokens) -> bool:
        kind = self.understand(part.span(0, len(part.items))).kind
        is_address = len(part.items) == 1 and not self._says_nothing(part)
        return kind in {"error", "acknowledgement"} and not part.asks and not is_address

    def denies(self, text: str) -> bool:
        """Whether a text has words that deny something, as "not", or come close to it."""
        return self.offers.checks.denies(self._tokens(text).words)

    def reasons(self, text: str) -> tuple[str, ...]:
        """Return the properties that a text gives as a reason: "because it is heavy"."""
        tokens = self._tokens(text)
        start, end = self.utterance_parser.periphery.reader.property_clause(tokens)
        if start == end:
            return ()
        names = self.offers.mentions(tokens, Discourse()).names
        found = {each.start: each.name for each in names if each.role == "property"}
        others = {tokens.words[n] for n in range(start, end) if n not in found}
        is_plain = others <= {self.answers.phrases["joined"]}
        return tuple(found[n] for n in range(start, end) if n in found) if is_plain else ()

    def short_answers(self, text: str, discourse: Discourse) -> list[meanings.Answer]:
        """Return the short answers that a text may be to a question of Hilt, likeliest first."""
        tokens, known = self._tokens(text), self.utterance_parser.known_words
        if self.utterance_parser.clarification.of_input(text, tokens):
            return []

        def answers(said: Tokens) -> list[meanings.Answer]:
            guesses = known.guesses(said, known.unknown(said))
            return self.parser.answers(self.parser.chart(said, guesses), discourse)

        (start, end), *others = tokens.parts
        asides = [tokens.part(*span) for span in others]
        is_aside = asides and not tokens.asks and all(map(self._says_nothing, asides))
        found = answers(tokens.without_breaks())
        return found or (answers(tokens.part(start, end)) if is_aside else [])

    def _says_nothing(self, part: Tokens) -> bool:
        is_open = bool(self.offers.known.unknown(part)) or self._courtesies.has_content(part)
        has_degree = self.offers.mentions(part, Discourse()).degrees
        return not (is_open or has_degree) and self.offers.checks.is_apart(part.words)

    @cached_property
    def utterance_parser(self) -> UtteranceParser:
        """The parser of utterances with the words known now."""
        known = KnownWords(self.parser.lexicon, self.builder)
        clarification = Clarifier(self.parser, known, self.answers, self.realizer, self.examples)
        reading_filter = ReadingFilter(known, self.parser.features)
        words = load_word_lists(self.folder / "procedures.yaml")
        procedures = ProcedureReader(words, self.parser, known, self.controls, self.frames)
        words, lists = (load_word_lists(self.folder / f"{n}.yaml") for n in ("periphery", "offers"))
        operators = {kind: lists.phrases(kind) for kind in OPERATORS}
        pieces = PieceReader(words, operators, self.parser.features, known)
        periphery = PeripheryReader(pieces, load_table())
        parts = (known, reading_filter, clarification, periphery, procedures)
        return UtteranceParser(self.parser, *parts)

    @property
    def lexicon(self) -> LearnedLexicon:
        """The entries of all words, those of learned words first."""
        return self.parser.lexicon

    @property
    def usual(self) -> Confidence:
        """The confidence of a rule that is told without any word of degree."""
        return self.degrees.intervals[self.degrees.default]

    @property
    def tool_acts(self) -> Mapping[str, str]:
        """The acts done with a tool, each with the affordance that the tool must have."""
        return self.parser.interpreter.tool_acts

    @property
    def acts(self) -> Collection[str]:
        """The acts on an object that the vocabulary has or that were learned."""
        return self.parser.interpreter.acts

    def insists_on(self, word: str, text: str) -> bool:
        """Whether a text insists on a word that was taken for a slip: "no, lifting"."""
        return self.builder.insists_on(word, self._tokens(text).words)

    def say(self, key: str, **slots: Slot) -> str:
        """Return an answer of `answers.yaml` with its slots filled."""
        return self.answers.say(key, **slots)

    def generate(self, meaning: Meaning) -> str:
        """Return a sentence with this meaning; `UnknownNameError` if the language has none."""
        return self.realizer.realize(meaning)


@dataclass(frozen=True)
class Session:
    """The state of a conversation: the language with the words learned, and the discourse."""

    language: Language
    discourse: Discourse = field(default_factory=Discourse)

    def hear(self, text: str, *, speaker: str = "sam") -> "tuple[Understanding, Session]":
        """Return the meaning of an utterance at this point, and the session after it."""
        understood = self.language.understand(text, speaker=speaker, discourse=self.discourse)
        language = self.language
        if isinstance(understood.meaning, meanings.TEACHING):
            language = language.with_words(understood.new_words)
        return understood, Session(language, understood.discourse)

    def after(self, texts: Iterable[str], *, speaker: str = "sam") -> "Session":
        """Return the session after some utterances."""
        session = self
        for text in texts:
            _, session = session.hear(text, speaker=speaker)
        return session


def _is_not_understood(meaning: Meaning, text: str) -> bool:
    match meaning:
        case meanings.Misunderstanding(where=where, expected=()):
            return where != text.strip()  # else it was understood as a whole
        case meanings.Misunderstanding() | AskBack(choices=() | (str(),)):
            return True
        case _:
            return False


def language_folder(language: str) -> Path:
    """Return the folder of a language; `UnknownNameError` if there is none."""
    known = [path.parent.name for path in LANGUAGES_FOLDER.glob("*/lexicon.yaml")]
    if language not in known:
        raise UnknownNameError("language", language, known)
    return LANGUAGES_FOLDER / language


def load_tables(folder: Path) -> LanguageTables:
    """Return what the files in a folder say, a new value at each call.

    It is kept for the next program until a file of language or code changes, as reading the files
    takes several times as long. `DataError` says where a file is wrong.
    """
    code = Path(__file__).parent
    sources = (*code.glob("*.py"), *code.glob("*/*.py"), *code.glob("*/*.lark"))
    files = (*folder.glob("*.*"), *LANGUAGES_FOLDER.glob("*.*"), *sources)
    return kept(folder.name, files, partial(_read_tables, folder))


def _read_tables(folder: Path) -> LanguageTables:
    degrees = load_degrees()
    grammar = load_grammar(folder / "grammar.yaml", degrees=degrees.intervals)
    inflection = load_inflection(folder / "inflection.yaml")
    builder = LexiconBuilder(grammar, inflection, CombinationTable(grammar.unary))
    for name in _WORD_FILES:
        builder.read(folder / name)
    features = load_features(folder / "features.yaml")
    licence = load_licence(features.values, degrees.intervals)
    return LanguageTables(degrees, grammar, builder, load_pragmatics(), features, licence)
