"""The strategies for understanding an utterance, tried in order until one finds a meaning.

1. as one sentence, by the grammar;
2. as a sequence of segments, split at the pauses, which have one meaning together: beside the main
   segment there may be replies, the object that "it" refers to, a question whether that object is
   seen, or the same request again: "Hello. That hammer, could I have it, please?";
3. both again without discourse markers, and with a qualifier moved to the front;
4. as the steps of an action that is taught: "to serve a mug, pick it up and point to it";
5. as a core beside what says nothing more of it: "my hands are wet, so pass me the ladle";
6. as several commands in order: "pick up the mug and then point to it".
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import combinations, islice, pairwise, takewhile
from operator import and_

from ..lexicon.discourse_markers import move_to_front
from ..lexicon.tokenizer import BREAK, Tokens, tokenize
from ..lexicon.unknown_words import MAX_NEW_WORDS, KnownWords
from ..lexicon.vocabulary import NewWord
from ..semantics import meaning as meanings
from ..semantics.clause_features import FeatureReader
from ..semantics.discourse import THIRD_PERSON
from ..semantics.meaning import Acknowledgement, AskBack, Meaning, Plan, Question, Rule, Statement
from ..semantics.predicates import PredicateForm, UnlearnableError
from .chart import Chart
from .clarification import Clarifier
from .parser import SentenceParser, Topic, decide
from .periphery import MAX_CORES, Core, PeripheryReader, kinds_of_core
from .procedures import ProcedureReader
from .readings import ReadingFilter, features_of
from .understanding import Reading, Understanding, UtteranceContext

MAX_SEGMENTS = 4
_TOPIC = 4  # the greatest length of a segment that only names something [words]

_ANYTHING = PredicateForm("anythingNamed")  # stands for whatever a pronoun may refer to
_ANSWERS = frozenset({"yes", "no"})  # they outweigh all politeness around them
_INDEFINITE = frozenset({"a", "an"})
_SOMEBODY = frozenset({"i", "am", "he", "she"})  # "I am a tailor" names no thing
_ENDINGS = ("ing", "ed", "ly")  # of words that name no thing
_CLOSING = frozenset({"thanks", "okay"})

Strategy = Callable[[Tokens, UtteranceContext], Understanding | None]


@dataclass(frozen=True, repr=False)
class UtteranceParser:
    """Understands utterances, whole or in segments."""

    parser: SentenceParser
    known_words: KnownWords
    reading_filter: ReadingFilter
    clarification: Clarifier
    periphery: PeripheryReader
    procedures: ProcedureReader

    def understand(
        self, text: str, context: UtteranceContext, accepted: Collection[str]
    ) -> Understanding:
        """Return what an utterance means, or its clarification; no word in `accepted` is a slip."""
        tokens = tokenize(text, self.known_words.builder.contractions)
        problem = self.clarification.of_input(text, tokens)
        if problem is not None:
            return _failed(Understanding.of(tokens, context, problem), ())
        found, before = _Attempt(self, accepted).understand(tokens, context), context.discourse
        meant = found.meaning
        is_open = isinstance(meant, AskBack) and not meant.choices
        if before.has_failed and (is_open or isinstance(meant, meanings.Misunderstanding)):
            at_point = replace(context, discourse=replace(before, has_failed=False))
            again = _Attempt(self, accepted).understand(tokens, at_point)
            is_whole = again.reading and again.reading.speech_act.name == "QUESTION"
            if is_whole and isinstance(again.meaning, Question) and not before.has_unknown:
                return again  # the answer says what "it" was taken for
            if again.reading and not isinstance(again.meaning, AskBack):
                offer = replace(again.reading, meaning=AskBack(choices=(again.meaning,)))
                return replace(again, discourse=before).chosen(self.clarification.licensed(offer))
        if found.reading is None and not _is_procedure(found):
            known = self.known_words
            # If it may name an object, "it" no longer is the last one.
            may_name = any(not known.has(word) or known.names(word) for word in tokens.words)
            features = self.parser.features
            own = [*takewhile(lambda word: word not in THIRD_PERSON, tokens.words)]
            named = list(_known_objects(own, known, features))
            is_new, thing = _new_object(tokens.part(0, len(own)), known, features)
            if thing and (is_new or not (named or before.object)):
                named.append(thing)
            within = (t for n, t in enumerate(tokens.items) if n not in tokens.beginnings)
            people = [t.word for t in within if t.capital and not known.has(t.word)]
            if len(people) == 1:
                found = replace(found, discourse=found.discourse.with_person(people[0]))
            return _failed(found, named, known.unknown(tokens)) if may_name else found
        sure = found.reading.interval if found.reading else context.recognition
        if self.parser.pragmatics.is_enough(sure):
            return found
        question = self.clarification.answers.say("heard_badly", text=found.text)
        return Understanding.of(tokens, context, AskBack(question, (found.text,)))


class _Attempt:
    """The strategies on one utterance; what several of them ask for is parsed once."""

    def __init__(self, tools: UtteranceParser, accepted: Collection[str]) -> None:
        self._tools, self._accepted = tools, accepted
        self._markers = tools.known_words.builder.discourse_markers
        self._charts: dict[object, Chart] = {}
        self._plain_chart = cache(partial(tools.parser.chart, guesses={}))
        self._sentence = cache(self._read_sentence)
        self._fronted: set[Tokens] = set()  # those with a qualifier moved to the front
        reader = tools.procedures
        self._by_definition = partial(reader.definition, sentence=self._sentence)
        self._by_plan = partial(reader.plan, sentence=self._sentence)
        self._by_name = reader.about

    def understand(self, tokens: Tokens, context: UtteranceContext) -> Understanding:
        """Return the result for the utterance, whose tag ("..., okay?") is taken off first."""
        request = self._markers.request_before_tag(tokens)
        found = self._understand(request, context) if request else None
        is_command = found and isinstance(found.meaning, meanings.SimpleCommand)
        if found and (is_command or meanings.only_revises(found.meaning)):
            return found
        return self._understand(self._markers.remove_tag(tokens), context)

    def _understand(
        self, tokens: Tokens, context: UtteranceContext, *, is_core: bool = False
    ) -> Understanding:
        unknown = self._tools.known_words.unknown(tokens)
        if len({token.word for token in unknown}) <= MAX_NEW_WORDS:
            result = self._as_sentence(tokens, context)
            strategies = self._strategies_after(result, is_core=is_core)
        else:
            problem = self._tools.clarification.of_unknown_words(tokens, unknown)
            result = Understanding.of(tokens, context, problem)
            others = (self._by_definition, self._by_name, self._by_core, self._by_plan)
            strategies = () if is_core else others
        for found in filter(None, (strategy(tokens, context) for strategy in strategies)):
            if found.reading is not None or _is_procedure(found):
                return found
            if isinstance(result.meaning, meanings.Misunderstanding):
                result = found
        return result

    def _strategies_after(self, result: Understanding, *, is_core: bool) -> Sequence[Strategy]:
        by_grammar = (self._by_segments, self._without_markers)
        whole = (*by_grammar, self._by_definition, self._by_name, self._by_core, self._by_plan)
        strategies = by_grammar if is_core else whole
        if result.reading is not None:
            return ()
        match result.meaning:
            case meanings.Misunderstanding() | AskBack(choices=()):
                return strategies
            case AskBack(choices=(_,)):
                # With one word corrected it would be a sentence: there is no need to guess.
                taught = () if is_core else (self._by_definition, self._by_plan)
                return (*by_grammar, *taught) if result.readings else strategies
            case _:
                return ()

    def _as_sentence(self, tokens: Tokens, context: UtteranceContext) -> Understanding:
        found = self._sentence(tokens, context)
        if found.reading is None and BREAK in tokens.words:
            again = self._sentence(tokens.without_breaks(), context)
            # "Do you think it is? Used for spreading, I mean."
            asking = self._tools.parser.features.words["asking"]
            is_asked = "?" in tokens.text.rstrip("?!. ") and not asking.isdisjoint(tokens.words)
            is_told = is_asked and isinstance(again.meaning, Statement)
            found = again if again.reading is not None and not is_told else found
        return found

    def _by_segments(self, tokens: Tokens, context: UtteranceContext) -> Understanding | None:
        splits = (each for split in _segmentations(tokens) for each in self._with_topics(split))
        for segments in splits:
            found = self._segments(segments, context)
            combined = _combined([each.meaning for each in found]) if found else None
            if combined is None:
                continue
            main, meaning = combined
            is_grip = isinstance(meaning, meanings.Command) and meaning.part is not None
            charts = map(self._plain_chart, segments if is_grip else ())
            if any(map(self._tools.parser.is_generic, charts)):
                continue  # it may be a rule
            words = tuple(dict.fromkeys(word for each in found for word in each.new_words))
            whole = replace(found[main], meaning=meaning, new_words=words)
            named = {*words} - {
                word for each in found if each.reading for word in each.reading.new_words
            }
            if named and whole.reading and not isinstance(meaning, Question):
                # What is told of a thing that nobody has named before.
                offer = replace(whole.reading, meaning=AskBack(choices=(meaning,)), new_words=words)
                return whole.chosen(self._tools.clarification.licensed(offer))
            after = (*(each.words[:2] for each in found[1:]), ())  # "sure, and a shoe is ..."
            said = zip(found, after, strict=True)
            replies = [e.words + n for e, n in said if isinstance(e.meaning, Acknowledgement)]
            if not replies or whole.reading is None or isinstance(meaning, AskBack):
                return whole
            features = self._tools.parser.features.with_asides(whole.reading.features, replies)
            reading = replace(whole.reading, meaning=meaning, features=features)
            answer = self._tools.clarification.licensed(reading)
            return replace(whole, meaning=answer, reading=reading)
        return None

    def _with_topics(self, segments: Sequence[Tokens]) -> Iterator[Sequence[Tokens]]:
        """Yield the segments; and with names of what is spoken of next: "and a spoon, it is .."."""
        words, (*first, last) = self._tools.periphery.reader.words, segments
        ends = [words.end("topic", each.words) for each in first]
        starts = [
            end if 0 < len(e.items) - end < _TOPIC else 0
            for end, e in zip(ends, first, strict=True)
        ]
        after = (words.end("impersonal", each.words) > 0 for each in segments[1:])
        if not any(map(and_, map(bool, starts), after)):
            yield segments
        if any(starts):
            yield (
                *(e.part(start, len(e.items)) for e, start in zip(first, starts, strict=True)),
                last,
            )

    def _without_markers(self, tokens: Tokens, context: UtteranceContext) -> Understanding | None:
        tried = {tokens.words}
        for variant in self._variants(tokens):
            if variant.words in tried or not variant.items:
                continue
            tried.add(variant.words)
            found = None if set(variant.words) == {BREAK} else self._as_sentence(variant, context)
            if found is None or found.reading is None:
                found = None if variant in self._fronted else self._by_segments(variant, context)
            if found is not None:
                return found
        return None

    def _by_core(self, tokens: Tokens, context: UtteranceContext) -> Understanding | None:
        for core in islice(self._tools.periphery.cores(tokens), MAX_CORES):
            found = self._core(core, context)
            if found is None:
                continue
            asked = found.reading if isinstance(found.meaning, AskBack) else None
            kinds = kinds_of_core((asked or found).meaning)
            if not kinds or not kinds <= core.kinds:
                return None
            before = (self._understand(each, context, is_core=True) for each in core.preamble)
            said = (each.meaning for each in before if each.reading is not None)
            return found if all(isinstance(each, Acknowledgement) for each in said) else None
        return None

    def _core(self, core: Core, context: UtteranceContext) -> Understanding | None:
        if not core.is_referring:
            return self._with_reading(core.tokens, context)
        found = self._with_reading(core.tokens, context.with_object(None))
        referring = self._with_reading(core.tokens, context.with_object(_ANYTHING))
        is_command = referring and isinstance(referring.meaning, meanings.SimpleCommand)
        if referring is None or (is_command and core.has_person):
            return None
        if found is not None:
            return found if referring.meaning == found.meaning else None
        thing = PredicateForm(core.referent) if core.referent else None
        return self._with_reading(core.tokens, context.with_object(thing)) if thing else None

    def _with_reading(self, tokens: Tokens, context: UtteranceContext) -> Understanding | None:
        found = self._understand(tokens, context, is_core=True)
        return found if found.reading is not None and "askOf" not in found.content else None

    def _variants(self, tokens: Tokens) -> Iterator[Tokens]:
        builder = self._tools.known_words.builder
        qualifiers = builder.degree_of
        barriers = self._tools.parser.features.words["embedding"]
        untagged = self._markers.remove_tag(tokens)
        for each in (untagged, builder.expand_endings(untagged)):
            marked = self._markers.remove_markers(each, qualifiers)
            bare = self._markers.leave_last_degree(marked, qualifiers)
            yield from (each, marked, bare)
            fronted = None if BREAK in bare.words else move_to_front(bare, qualifiers, barriers)
            if fronted:
                self._fronted.add(fronted)
                yield fronted

    def _segments(self, parts: Sequence[Tokens], context: UtteranceContext) -> list[Understanding]:
        if self._topic(parts[-1], context) is not None:
            # An object named at the end goes first: "You pass it by the blade, the knife."
            parts = (parts[-1], *parts[:-1])
        found: list[Understanding] = []
        topic: PredicateForm | None = None
        new: tuple[NewWord, ...] = ()
        for part in parts:
            each = self._sentence(part, context)
            if each.reading is None or "askOf" in each.content:
                named = self._topic(part, context) if topic is None else None
                if named is None:
                    return []
                topic, words = named
                new += words
                context = context.with_object(topic)
                continue
            # A topic is only said for a part that refers to it.
            alone = context.with_object(None)
            if topic is not None and self._sentence(part, alone).reading is not None:
                return []
            if topic is not None and meanings.is_used_on_itself(each.meaning):
                return []  # "tea, of course, it is for drinking tea"
            topic = None
            found.append(replace(each, new_words=each.new_words + new))
            context = replace(context, discourse=each.discourse)
        return found if topic is None else []

    def _read_sentence(self, tokens: Tokens, context: UtteranceContext) -> Understanding:
        found = self._parse(tokens, context)
        if tokens in self._fronted and found.content.startswith("and("):
            # The qualifier was said of one of them; moved, it no longer shows of which.
            return Understanding.of(tokens, context, meanings.Misunderstanding(tokens.text))
        return found

    def _parse(self, tokens: Tokens, context: UtteranceContext) -> Understanding:
        tools, clarify = self._tools, self._tools.clarification
        unknown = tools.known_words.unknown(tokens)
        # No name goes over a pause, so the guesses depend on the pauses, too.
        key = (tuple((token.word, token.capital) for token in tokens.items), tokens.pauses)
        if key not in self._charts:
            guesses = tools.known_words.guesses(tokens, unknown)
            self._charts[key] = tools.parser.chart(tokens, guesses)
        chart = self._charts[key]
        readings, refusal = tools.parser.readings(chart, tokens, context)
        accepted = tools.reading_filter.accepted(readings, tokens)
        chosen = decide(accepted)
        answer: Meaning | None
        if chosen is not None:
            answer = clarify.of_new_words([chosen], tokens, self._accepted)
            if answer is None:
                features = features_of(tools.parser.features, chosen, tokens)
                chosen = replace(chosen, features=features)
                if self._is_guess(chosen, tokens):
                    chosen = replace(chosen, meaning=AskBack(choices=(chosen.meaning,)))
                licensed = clarify.licensed(chosen)
                return Understanding.of(tokens, context, licensed, chosen, len(accepted))
        elif accepted:
            answer = clarify.of_new_words(accepted, tokens, self._accepted)
            answer = answer or clarify.of_ambiguity(accepted)
        elif isinstance(refusal, UnlearnableError):
            answer = meanings.Misunderstanding(clarify.answers.say(refusal.key), where=tokens.text)
        elif readings:
            answer = clarify.of_new_words(readings[:1], tokens, self._accepted)
        else:
            answer = clarify.of_misspelling(unknown, self._accepted)
        if answer is None and unknown and not (refusal and refusal.asks):
            answer = clarify.of_unknown_words(tokens, unknown)
        answer = answer or clarify.of_failure(chart, tokens, refusal)
        return Understanding.of(tokens, context, answer, readings=len(accepted))

    def _is_guess(self, reading: Reading, tokens: Tokens) -> bool:
        """Whether a fragment is of a word that nobody knows and that may name no thing.

        "And a fork" and "forks too" name one; "also hungry" and "funny?" may not.
        """
        is_added = isinstance(reading.meaning, Statement) or len(tokens.items) == 1
        if reading.speech_act.name != "FRAGMENT" or not is_added:
            return False
        articles = {after for before, after in pairwise(tokens.words) if before in _INDEFINITE}
        is_plural = self._tools.known_words.builder.inflection.is_plural_only
        things = (word for word in reading.new_words if word.role == "object")
        single = [each.said for each in things if each.said == each.word]
        return not all(is_plural(said) or said.partition(" ")[0] in articles for said in single)

    def _topic(self, tokens: Tokens, context: UtteranceContext) -> Topic | None:
        parser, known = self._tools.parser, self._tools.known_words
        unknown, is_short = known.unknown(tokens), len(tokens.items) <= _TOPIC
        is_new = unknown and is_short and known.builder.is_determiner(tokens.words[0])
        chart = parser.chart(tokens, known.guesses(tokens, unknown)) if is_new else None
        return parser.topic(chart or self._plain_chart(tokens), context)


def _is_procedure(found: Understanding) -> bool:
    meant = found.meaning
    is_about = isinstance(meant, (Question, meanings.Retraction)) and found.reading is None
    return is_about or isinstance(meant, (Plan, meanings.ActionDefinition, meanings.ActionCommand))


def _known_objects(
    words: Sequence[str], known: KnownWords, features: FeatureReader
) -> Iterator[str]:
    end = 0
    for start in range(len(words)):
        for stop, node in sorted(known.lexicon.nodes(words, start), key=lambda each: -each[0]):
            names = (each for each in node.entries if each.category == each.category.atom)
            categories = {each.category.atom.name: each.name for each in names}
            is_thing = "N" in categories and {"P", "MS"}.isdisjoint(categories)
            if start >= end and is_thing and not features.is_elsewhere(words[stop - 1]):
                end = stop
                yield categories["N"]


def _new_object(tokens: Tokens, known: KnownWords, features: FeatureReader) -> tuple[bool, str]:
    """Return a new thing that is named, and whether it is introduced: "a chisel", "pliers"."""
    kinds, found = (features.is_part, features.is_elsewhere, features.is_abstract), (False, "")
    for place, entries in sorted(known.guesses(tokens, known.unknown(tokens)).items()):
        word, before = tokens.words[place], tokens.words[:place]
        names = [e.name for e in entries if e.role == "object" and not e.says.endswith(_ENDINGS)]
        is_introduced = not _INDEFINITE.isdisjoint(before[-1:]) and _SOMEBODY.isdisjoint(
            before[-3:-1]
        )
        name = max(names, key=len, default="")
        end = place + 1 + name.count(" ")
        is_introduced |= known.builder.inflection.is_plural_only(word)
        is_introduced |= {place, end} <= tokens.edges and not word.endswith(("s", *_ENDINGS))
        is_noun = is_introduced or before[-1:] == ("the",)
        is_other = any(is_kind(word) for is_kind in kinds)
        is_other |= tokens.words[end : end + 1] in {("one",), ("ones",)}
        if name and is_noun and not is_other and (is_introduced or not found[1]):
            found = is_introduced, name
    return found


def _failed(found: Understanding, things: Sequence[str], unknown: object = True) -> Understanding:
    discourse = found.discourse
    if things:
        discourse = discourse.naming(*map(PredicateForm.named, things))
        if discourse.rule and discourse.rule.object not in things:
            discourse = replace(discourse, rule=None, last=None)
    discourse = replace(discourse, has_failed=True, has_unknown=bool(unknown))
    return replace(found, discourse=discourse)


def _segmentations(tokens: Tokens) -> Iterator[tuple[Tokens, ...]]:
    """All ways to split an utterance at its pauses, those with fewer segments first."""
    places = tokens.beginnings[1:]
    if len(places) >= MAX_SEGMENTS:
        return
    for count in range(1, len(places) + 1):
        for chosen in combinations(places, count):
            segments = tuple(map(tokens.part, (0, *chosen), (*chosen, len(tokens.items))))
            if all(segment.items for segment in segments):
                yield segments


def _combined(said: Sequence[Meaning]) -> tuple[int, Meaning] | None:
    """Return the index of the main segment and the combined meaning, None when there is none."""
    replies = [each for each in said if isinstance(each, Acknowledgement)]
    if len(replies) == len(said):
        decisive = {reply for reply in replies if reply.ack in _ANSWERS}
        thanked = next((reply for reply in replies if reply.ack == "thanks"), replies[-1])
        chosen = next(iter(decisive), thanked)
        return (said.index(chosen), chosen) if len(decisive) < 2 else None
    places = [i for i, each in enumerate(said) if not isinstance(each, Acknowledgement)]
    after = said[places[-1] + 1 :]
    if any(isinstance(each, Acknowledgement) and each.ack not in _CLOSING for each in after):
        return None
    meaning = _combined_content([said[place] for place in places])
    return (places[-1], meaning) if meaning is not None else None


def _combined_content(said: Sequence[Meaning]) -> Meaning | None:
    statements = [each for each in said if isinstance(each, Statement)]
    match said:
        case _ if all(each == said[-1] for each in said):
            is_one = True
        case _ if len(statements) == len(said):
            return _combined_statement([rule for each in statements for rule in each.rules])
        case meanings.Retraction() as first, Statement() as last if first == meanings.Retraction():
            return meanings.with_rules(last, revises=True)
        case meanings.TopicStatement(topic=topic), Statement(rules=rules):
            is_one = all(rule.object == topic for rule in rules)
        case Question(ask="see", object=seen), meanings.ToolCommand(patient=patient):
            is_one = seen == patient
        case Question(ask="see", object=seen, affordance=use), meanings.Command(target=target):
            is_one = (seen, use) in {(target.object, None), (None, target.used_for)}
        case _:
            is_one = False
    return said[-1] if is_one else None


def _combined_statement(rules: Sequence[Rule]) -> Statement | None:
    kept: list[Rule] = []
    for rule in rules:
        repairs = rule.revises and kept and type(kept[-1]) is type(rule)
        kept.append(replace(rule, revises=kept.pop().revises) if repairs else rule)
    distinct = tuple(dict.fromkeys(kept))
    is_one = len({(rule.revises, rule.source) for rule in distinct}) == 1
    return Statement(distinct) if is_one and not meanings.is_contradictory(distinct) else None
