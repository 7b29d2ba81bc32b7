"""Offers for an utterance that is not understood, as a question with at most three choices.

Candidates are built from the names in the utterance, ranked, and checked; the sentence that the
language generates for an offer must be understood as just this meaning. An offer is never believed
or acted on before its speaker has chosen it.
"""

import json
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import islice, product
from pathlib import Path

from ...ontology.errors import UnknownNameError
from ..generation.realizer import Realizer
from ..grammar.word_patterns import Phrase, WordLists
from ..lexicon.misspelling import slips
from ..lexicon.tokenizer import BREAK, MAX_TOKENS, Tokens
from ..lexicon.unknown_words import MAX_NEW_WORDS, KnownWords
from ..parsing.clarification import MAX_CHOICES
from ..parsing.understanding import Understanding, UtteranceContext
from ..semantics import meaning as meanings
from ..semantics.discourse import Discourse
from ..semantics.meaning import AskBack, Meaning, Question, SimpleCommand
from .candidates import CandidateMeaning, OfferModel, candidates, left_over
from .checks import LESS_LIKELY, OfferChecks
from .meaning_shapes import composed_shapes, meaning_from_json, shape_from
from .mentions import Mention, Mentions, Span, find_mentions

_QUOTES = frozenset('"“”„«»')
_OFFERED = (meanings.Statement, Question, SimpleCommand)

LEAST = 0.5  # the least probability of all offers together, beside that of "none"
LEAST_ASKED = 0.75  # the least of a question that is answered at once
LEAST_SECOND, LEAST_ALONE = 0.1, 0.65  # the same where no second meaning is as likely as that
LEAST_ASKED_BESIDE = 0.85  # the same beside other words that may be names, or without "?"
LEAST_OTHER = 0.03  # the least probability of any other meaning
MOST_OF_NOTHING = 0.1  # the greatest probability of all meanings of what is said by the way
LOSING = 0.25  # how likely a meaning stays that seems to lose something of what was said
MAX_TRIED = 6  # how many of the likeliest candidates are checked
MAX_SENTENCES = 4  # how many sentences of an utterance are tried
_OTHER = "tool"  # stands for what is asked for before a name
MAX_REQUEST = 4  # how many words a request may have that is nothing but a name
MAX_UNKNOWN = 5  # how many unknown words an utterance may have


@dataclass(frozen=True, repr=False)
class OfferFinder:
    """Finds meanings to offer."""

    model: OfferModel
    checks: OfferChecks
    known: KnownWords
    #: the words for degrees of confidence, with their intervals
    degrees: Mapping[tuple[str, ...], meanings.Confidence]
    #: the acts done with a tool, each with the affordance that the tool must have
    tool_acts: Mapping[str, str]
    realizer: Realizer
    usual: meanings.Confidence  #: the confidence of a rule without a word for it
    #: returns what a text means that somebody says at some point
    understand: Callable[[str, UtteranceContext], Understanding]

    def question(self, tokens: Tokens, context: UtteranceContext) -> AskBack | Question | None:
        """Return the question which of some meanings was meant, None when none is to be offered.

        A likely question of the speaker is returned itself: its answer believes and does nothing.
        """
        choices = self.meanings(tokens, context)
        if not choices:
            return None
        if isinstance(choices[0], Question):
            is_said = choices == self.of_sentences(tokens, context)
            if is_said or self._is_sure(choices[0], tokens, context):
                return choices[0]
        said: list[str] = []
        for meaning in choices:
            first, *rest = self.realizer.realize(meaning).rstrip("?").split(" ")
            aloud = (w.upper() if self.checks.words.has("negative", w) else w for w in rest)
            said.append(" ".join([first, *aloud]))
        return AskBack(self.realizer.answers.offer(said), choices)

    def _is_sure(self, meant: Meaning, tokens: Tokens, context: UtteranceContext) -> bool:
        mentions = self.mentions(tokens, context.discourse)
        likely = (*self.ranked(mentions), (0.0, None), (0.0, None))
        (probability, best), (second, _) = likely[:2]
        left = left_over(best, mentions) if best else {}
        if best is None or meaning_from_json(best.meaning) != meant or left.keys() - {"known"}:
            return False
        if self.rejected(best, mentions, context):
            return False
        last = tokens.beginnings[-1]
        asked = tokens.words[last:]
        reader = self.checks.reader
        is_asked = not reader.words["interrogative"].isdisjoint(asked)
        start = tokens.sentences[-1][0]
        begins = (n for n in tokens.beginnings if tokens.words[n] in reader.words["asking"])
        # A request may follow what is told: "I've nothing to cut with, can you help?"
        is_asked |= tokens.asks and any(
            n == start or tokens.words[n + 1 : n + 2] != ("you",) for n in begins
        )
        is_over = any(each.endswith(("=perfect", "=past")) for each in mentions.features)
        if is_over or not is_asked or not best.used or self.checks.denies(asked):
            return False
        is_about = (all if left else any)(m.end > last for u in best.used.values() for m in u)
        least = LEAST_ASKED if second > LEAST_SECOND else LEAST_ALONE
        is_likely = probability >= (least if tokens.asks and not left else LEAST_ASKED_BESIDE)
        return is_likely and (is_about or (is_asked and not left))

    def meanings(self, tokens: Tokens, context: UtteranceContext) -> tuple[Meaning, ...]:
        """Return at most `MAX_CHOICES` meanings that an utterance may have, the likeliest first."""
        if not self.is_text(tokens):
            return ()
        mentions = self.mentions(tokens, context.discourse)
        found = self.of_corrected(tokens, context) or self.of_sentences(tokens, context)
        return found or self.of_mentions(mentions, context) or self.of_name(mentions, context)

    def is_nothing(self, tokens: Tokens) -> bool:
        """Whether an utterance most likely means nothing that is learned, done or answered."""
        ranked = self.ranked(self.mentions(tokens, Discourse()))
        return sum(chance for chance, _ in ranked) <= MOST_OF_NOTHING

    def mentions(self, tokens: Tokens, discourse: Discourse) -> Mentions:
        """Return what an utterance names, with its features."""
        found = find_mentions(tokens, self.known, self.degrees, discourse)
        found = replace(found, names=tuple(m for m in found.names if self._is_name(m, tokens)))
        return replace(found, features=self.checks.signs(found))

    def _is_name(self, one: Mention, tokens: Tokens) -> bool:
        if one.role == "affordance":
            return one.name not in self.checks.reader.words["acts"]
        said = tokens.words[one.start : one.end]
        is_vague = any(self.checks.words.has(key, *said) for key in ("gripping", "generic"))
        return one.role == "act" or not is_vague

    def of_corrected(self, tokens: Tokens, context: UtteranceContext) -> tuple[Meaning, ...]:
        """Return the meanings that an utterance has with its misspelled words corrected."""
        if any(self.checks.reader.is_noun(each.word) for each in self.known.unknown(tokens)):
            return ()
        texts = corrected_texts(tokens, self.known)
        said = dict.fromkeys(self.understand(text, context).meaning for text in texts)
        found = (each for each in said if self._is_understood(each, context))
        return tuple(islice(found, MAX_CHOICES))

    def of_mentions(self, mentions: Mentions, context: UtteranceContext) -> tuple[Meaning, ...]:
        """Return the meanings to offer for an utterance that names this."""
        found: list[Meaning] = []
        ranked = self.ranked(mentions)
        nothing = 1 - sum(chance for chance, _ in ranked)  # the probability that none was meant
        offered = 0.0  # the probability that one of those offered was meant
        kept = ((chance * self.keeping(each, mentions), each) for chance, each in ranked)
        likely = sorted(kept, key=lambda each: -each[0]) if nothing <= 1 - LEAST else ()
        for chance, candidate in likely:
            meaning = meaning_from_json(candidate.meaning)
            is_plain = len(candidate.used) + isinstance(meaning, Question) > 1
            if chance < (LEAST_OTHER if is_plain else LEAST) or len(found) == MAX_CHOICES:
                continue
            named = candidate.resolved(mentions)
            checked = self.checks.weakened(meaning, named, candidate.asides(mentions))
            is_new = _uncorrecting(checked) not in map(_uncorrecting, found)
            if is_new and self._is_understood(checked, context):
                offered += chance
                found.append(checked)
        return tuple(found) if offered >= LEAST * (offered + nothing) else ()

    def of_sentences(self, tokens: Tokens, context: UtteranceContext) -> tuple[Meaning, ...]:
        """Return the meaning of the one sentence understood beside others that say little."""
        is_part = len(tokens.sentences) == 1  # "by the handle, I mixed it up"
        spans = tokens.parts if is_part else tokens.sentences
        if not 1 < len(spans) <= MAX_SENTENCES or (is_part and tokens.asks):
            return ()
        last = tokens.text[tokens.items[spans[-1][0]].start :]  # with its question mark
        texts = [*(tokens.span(*each) for each in spans[:-1]), last]
        said: dict[Span, Meaning] = {}
        for span, text in zip(spans, texts, strict=True):
            heard = self.understand(text, context)
            act = heard.reading.speech_act.name if heard.reading else ""
            if not is_part or (act == "FRAGMENT" and not isinstance(heard.meaning, Question)):
                said[span] = heard.meaning
            context = replace(context, discourse=replace(heard.discourse, has_failed=False))
        known = [s for s, each in said.items() if isinstance(each, _OFFERED)]
        clear = [each for each in known if self._is_understood(said[each], context)]
        if all(isinstance(said[each], Question) for each in clear):
            clear = clear[-1:]
        meant = _joined([said[each] for each in clear])
        if isinstance(meant, Question):  # who asks and then says something gives the answer
            is_alone = clear[0] == spans[-1] and len(meant.as_json()) > 1
        else:
            others = {each: tokens.words[slice(*each)] for each in spans if each not in clear}
            before = (words for each, words in others.items() if each < clear[0]) if clear else ()
            after = (words for each, words in others.items() if each > clear[0]) if clear else ()
            is_framed = any(map(self.checks.frames, before))
            beside = (self.mentions(tokens.part(*each), Discourse()) for each in others)
            is_framed |= any(each.degrees for each in beside)
            is_alone = not is_framed and all(map(self.checks.is_apart, after))
        return (meant,) if meant and is_alone else ()

    def of_name(self, mentions: Mentions, context: UtteranceContext) -> tuple[Meaning, ...]:
        """Return the request that a short utterance is which only names a thing: "quick, knife"."""
        tokens = mentions.tokens
        verbs = self.checks.reader.words["asking"].intersection(tokens.words)
        is_open = tokens.asks or verbs or self.known.unknown(tokens)
        if is_open or self.checks.limits(tokens.words) or len(mentions.required) != 1:
            return ()
        before = meanings.Command("pass", meanings.ObjectReference(_OTHER))
        at_point = replace(context, discourse=Discourse(last=before, command=before))
        found = self.understand(tokens.text, at_point).meaning  # "now the hammer"
        asked = list(found.choices if isinstance(found, AskBack) else (found,))
        if len(tokens.words) <= MAX_REQUEST:
            things = (m for m in mentions.names if m.role == "object" and m.start in tokens.edges)
            bare = (m.name for m in things if tokens.span(m.start, m.end).lower() == m.name)
            asked += [meanings.Command("pass", meanings.ObjectReference(name)) for name in bare]
        requests = (e for e in asked if isinstance(e, meanings.Command) and e.goal == "pass")
        named = (each for each in requests if each.target.object not in {_OTHER, None})
        return tuple(each for each in named if self._is_understood(each, context))[:1]

    def rejected(self, one: CandidateMeaning, mentions: Mentions, context: UtteranceContext) -> str:
        """Return what is against a candidate, empty if nothing is."""
        lost = " and ".join(self.lost(one, mentions))
        if lost:
            return lost
        meaning, named = meaning_from_json(one.meaning), one.resolved(mentions)
        checked = self.checks.weakened(meaning, named, one.asides(mentions))
        return "" if self._is_understood(checked, context) else "sentence"

    def keeping(self, one: CandidateMeaning, mentions: Mentions) -> float:
        """Return how likely a candidate stays for what it keeps of an utterance, in [0, 1].

        What seems to be lost may belong to another clause, so most of it is only less likely.
        """
        lost = self.lost(one, mentions)
        return LOSING ** len(lost) if LESS_LIKELY.issuperset(lost) else 0.0

    def lost(self, one: CandidateMeaning, mentions: Mentions) -> tuple[str, ...]:
        """Return what a candidate loses of an utterance, or what is wrong with it."""
        determiners = self.checks.reader.words["determiners"]
        left, beside = left_over(one, mentions), _beside(one, mentions, determiners)
        meaning = meaning_from_json(one.meaning)
        lost = self.checks.lost(meaning, one.resolved(mentions), one.asides(mentions))
        is_cut = bool(beside & {*left.get("new", ()), *left.get("person", ())})
        things, uses = (one.used.get(slot, ()) for slot in ("?object", "?affordance"))
        is_beside = not {m.start for m in things}.isdisjoint(m.end for m in uses if m.end)
        is_on_itself = is_beside or meanings.is_used_on_itself(meaning)
        return (*lost, *["names"] * is_cut, *["itself"] * is_on_itself)

    def ranked(self, mentions: Mentions) -> Sequence[tuple[float, CandidateMeaning]]:
        """Return the likeliest candidates with their probabilities, the likeliest first."""
        some = tuple(candidates(mentions, self.model.shapes, self.tool_acts))
        found: dict[str, tuple[float, CandidateMeaning]] = {}  # by meaning, which shapes may share
        for chance, each in zip(self.model.probabilities(mentions, some), some, strict=True):
            said = json.dumps(each.meaning, sort_keys=True)
            before, first = found.get(said, (0.0, each))
            found[said] = (before + chance, first)
        return sorted(found.values(), key=lambda each: -each[0])[:MAX_TRIED]

    def is_text(self, tokens: Tokens) -> bool:
        """Whether an utterance consists of words, not of too many, and most of them known."""
        words = tokens.words
        are_words = all(word.isalpha() or word in {BREAK, "'s"} for word in words)
        if len(words) > MAX_TOKENS or not are_words or _QUOTES.intersection(tokens.text):
            return False
        return len({token.word for token in self.known.unknown(tokens)}) <= MAX_UNKNOWN

    def _is_understood(self, meaning: Meaning, context: UtteranceContext) -> bool:
        alone = replace(context, discourse=Discourse())
        try:
            found = self.understand(self.realizer.realize(meaning), alone).meaning
        except UnknownNameError:
            return False
        return found == meaning or (isinstance(found, AskBack) and found.choices == (meaning,))


def _beside(
    candidate: CandidateMeaning, mentions: Mentions, determiners: Collection[str]
) -> set[int]:
    pauses, words = mentions.tokens.pauses, mentions.tokens.words
    used = [each for mentions in candidate.used.values() for each in mentions]
    acts = [each for each in mentions.names if each.role == "act" and not each.is_new]
    before = {each.start - 1 for each in (*used, *acts) if each.start not in pauses}
    before |= {place - 1 for place in before if words[place] in determiners}  # "praise the handle"
    return before | {each.end for each in used if each.end not in pauses}


def _joined(said: Sequence[Meaning]) -> Meaning | None:
    """Return the one meaning of some sentences, or that of several rules; None without one."""
    rules = [each.rules for each in said if isinstance(each, meanings.Statement)]
    if 1 < len(rules) == len(said):
        return meanings.Statement(tuple(dict.fromkeys(rule for some in rules for rule in some)))
    return said[0] if len(said) == 1 else None


_uncorrecting = partial(meanings.with_rules, revises=False)  # whether it is a correction or not


@lru_cache(maxsize=4)
def load_model(path: Path) -> OfferModel:
    """Return the model in a file, which `benchmarks/train_offers.py` writes."""
    data = json.loads(path.read_text(encoding="utf-8"))
    pairs = {f: zip(said[::2], said[1::2], strict=True) for f, said in data["weights"].items()}
    weights = {f: {data["traits"][n]: w / 10 for n, w in each} for f, each in pairs.items()}
    shapes = dict.fromkeys((*composed_shapes(), *map(shape_from, data["shapes"])))
    return OfferModel(tuple(shapes), weights)


def choice_of(words: Phrase, count: int, lists: WordLists) -> int | None:
    """Return which of `count` choices words take, from 1 on: 0 for none, None for no answer."""
    if lists.has("none", *words):
        return 0
    # "The first one", but also "one": it is a number only where there is no other.
    named = tuple(word for word in words if not lists.has("around", word)) or words[-1:]
    if len(named) != 1:
        return None
    if count > 1 and lists.has("last", *named):
        return count
    numbers = (int(number) for number, _, _ in lists.of_group("numbers", named))
    return next((number for number in numbers if number <= count), None)


MAX_WORDS = 4  # how many known words are tried for an unknown one
MAX_TEXTS = 12  # how many corrected utterances are tried


def corrected_texts(tokens: Tokens, known: KnownWords) -> Iterator[str]:
    """Yield the utterance with the words corrected that are near known ones, likeliest first."""
    words, text = dict.fromkeys(token.word for token in known.unknown(tokens)), tokens.text
    if not words or len(words) > MAX_NEW_WORDS or not all(map(str.isalpha, words)):
        return
    options = [_known_slips(word, known) or [word] for word in words]
    numbered = product(*(list(enumerate(each)) for each in options))
    ranked = sorted(numbered, key=lambda chosen: sum(number for number, _ in chosen))
    for chosen in ranked[:MAX_TEXTS]:
        meant = dict(zip(words, (word for _, word in chosen), strict=True))
        if any(word != other for word, other in meant.items()):
            yield re.sub(r"[^\W\d_]+", lambda said: meant.get(said[0].lower(), said[0]), text)  # noqa: B023


def is_misspelled(tokens: Tokens, known: KnownWords) -> bool:
    """Whether an utterance has several unknown words, which are all near known ones."""
    words = {token.word for token in known.unknown(tokens)}
    return len(words) > 1 and all(_known_slips(word, known) for word in words)


def _known_slips(word: str, known: KnownWords) -> list[str]:
    found = dict.fromkeys(other for other in slips(word) if len(other) > 1 and known.has(other))
    return list(found)[:MAX_WORDS]
