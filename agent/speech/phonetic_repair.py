"""Repair by sound: the sentences of the grammar that sound most like what a recogniser wrote.

A neural recogniser errs in spelling rather than in sound: "the night" is "the knife". The words
become phones by the CMU Pronouncing Dictionary that PocketSphinx brings, and the nearest sentences
are searched among those made of the word pairs of Hilt's own grammar: what a word costs on any span
of phones (Levenshtein 1966), the best way on from each place by dynamic programming backwards, and
with these exact costs the best sentences by A* (Soong & Huang 1991). People say more than that
grammar makes, so the text with a few words replaced by known ones that sound alike is searched for
in the same way where none of its sentences is near. All of it is only ever offered.
"""

import random
import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from heapq import heappop, heappush
from itertools import accumulate, combinations, count, islice, pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...nlu.jsgf import sentences
from ...nlu.language import Language
from ...nlu.lexicon.tokenizer import tokenize
from ...nlu.parsing.understanding import UtteranceContext
from ...nlu.semantics.discourse import Discourse
from ...nlu.semantics.meaning import Meaning
from ...ontology.yaml_reader import read_yaml
from .recognisers import pronunciations

GAP, NEAR, VOWEL, OTHER = 0.8, 0.4, 0.7, 1.0  # costs of a lost or added phone, and of others for it
PAIR = 0.25  # what a word pair costs: this times its negative log probability
BONUS = 0.3  # what a likely word costs less
MOST_COST, NEAR_COST = 0.5, 0.23  # of a candidate, and of the only ones searched for, per phone
MOST_PHONES = 90  # of a text that is repaired
MOST_CANDIDATES, MOST_SENTENCES = 4, 15
REPLACING, RARE = 0.6, 0.8  # what a word costs in place of others, and one not in the grammar
UNPAIRED = 0.35  # what a word costs there instead of its pair: about as much as a usual pair
MOST_REPLACED, MOST_CHANGE = 3, 3.5  # words that take the place of others, and their cost
MOST_PATHS, MOST_LIKELY = 150, 200  # texts with replaced words, and words of those likely by pairs
RARE_PAIR = 1.5  # what a pair costs at most when the likely ones are chosen

_SENTENCES, _SEED = 20_000, 0  # from which the word pairs are counted
_LONGER = 3  # by how many phones a word may be heard longer than it is
_STEPS, _BRANCHES = 600, 30  # of the search at most, and at each of them
_NEAREST = 6  # other words for a span
_NEVER = 1e4
_EDGE = ""  # stands for a word before and after a sentence
_NOTHING_SAID = UtteranceContext("sam", "self", Discourse())

Phones = tuple[str, ...]
Floats = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int64]


class _Level(NamedTuple):
    """The phones of all words at one place; those of words that begin alike are one."""

    before: Ints  # each one's number on the level before
    phones: Ints
    weights: Floats
    spoken: Ints  # the numbers of the pronunciations that end here,
    ends: Ints  # and of their last phones


class _Edge(NamedTuple):
    """A word for what was heard from a place on: its cost, where it ends, and if it is another."""

    cost: float
    end: int
    word: str
    is_other: bool


class SoundRepair:
    """Finds sentences by their sound, with the words that a language knows.

    MissingExtraError without the dictionary of pronunciations. Making one takes about a second.
    """

    def __init__(self, language: Language) -> None:
        self.language, self._sounds = language, _load_sounds()
        pairs = Counter[tuple[str, str]]()
        for sentence in sentences(language, _SENTENCES, random.Random(_SEED)):  # noqa: S311
            pairs.update(pairwise([_EDGE, *sentence.split(), _EDGE]))
        self._words = sorted({word for pair in pairs for word in pair})  # _EDGE is the first
        numbers = self._numbers = {word: number for number, word in enumerate(self._words)}
        times = np.zeros((len(numbers), len(numbers)))
        for (before, word), said in pairs.items():
            times[numbers[before], numbers[word]] = said
        with np.errstate(divide="ignore"):
            costs = -PAIR * np.log(times / times.sum(axis=1, keepdims=True))
        self._pair_costs = np.minimum(costs, _NEVER).astype(np.float32)  # by word and next word
        rare = set(filter(str.isalpha, language.lexicon.words())).difference(self._words)
        self._all_words = [*self._words, *sorted(rare)]
        self._articles = [numbers[each] for each in self._sounds.articles & numbers.keys()]
        spoken = [[*map(tuple, self._sounds.of_word(word))] for word in self._all_words]
        # Each word's first pronunciation, then all further ones, with the numbers of their words.
        further = [(n, each) for n, ways in enumerate(spoken) for each in ways[1:]]
        self._owners = [n for n, _ in further]
        self._levels = [*_levels([ways[0] for ways in spoken] + [each for _, each in further])]
        self._known = frozenset(map(str.lower, self._all_words))

    def candidates(self, text: str, names: Collection[str] = ()) -> dict[str, float]:
        """Return sentences of different meanings that sound like a text, the nearest first.

        Each has its cost: how far its sound is from that of the text, per phone. They are at most
        `MOST_CANDIDATES`; the words of some names are likelier than others.
        """
        costs, found = self.costs(text, names), dict[Meaning, tuple[str, float]]()
        phones = len(costs) - 1
        listed = [each for each in self.nearest(costs) if each[0] <= MOST_COST * phones]
        if not listed or listed[0][0] > NEAR_COST * phones:
            listed += self.respelled(text, costs)
        for cost, sentence in sorted(listed):
            if cost > MOST_COST * phones or len(found) == MOST_CANDIDATES:
                break
            if meaning := self._meaning(sentence):
                found.setdefault(meaning, (sentence, cost / phones))
        return dict(found.values())

    def nearest(self, costs: Floats) -> list[tuple[float, str]]:
        """Return the sentences that sound most like a text, with what they cost in all."""
        found = islice(self._best(costs[:, : len(self._words)]), MOST_SENTENCES)
        return [(cost, sentence) for cost, sentence in found if self._is_derived(sentence)]

    def respelled(self, text: str, costs: Floats) -> list[tuple[float, str]]:
        """Return the text with words replaced by known ones that sound alike, and what that costs.

        Those are replaced that the language does not know, alone or with a neighbour; if it knows
        all of them, any. They are sentences by the chart.
        """
        said = re.findall(r"[\w']+", text.lower())
        ends = [*accumulate((len(self._heard(word)) for word in said), initial=0)]
        if len(costs) == 1 or self._is_derived(text):
            return []
        strange = [n for n, each in enumerate(said) if not ("'" in each or each in self._known)]
        spans = [(ends[max(0, at - 1)], ends[min(len(said), at + 2)]) for at in strange]
        edges = self._other_words(costs, spans or [(0, ends[-1])])
        for at, (start, end) in enumerate(pairwise(ends)):
            if at not in strange:
                edges[start].append(_Edge(UNPAIRED, end, said[at], is_other=False))
        found, most = dict[str, float](), MOST_CHANGE + UNPAIRED * len(said)
        for cost, words in islice(_paths(edges, most), MOST_PATHS):
            found.setdefault(words.lower(), cost)
        found.pop(" ".join(said), None)
        likely = sorted(found, key=lambda words: found[words] + self._pairs_cost(words))
        tried = filter(self._is_derived, likely[: MOST_LIKELY // len(said)])
        return [(found[words], words) for words in tried]

    def _pairs_cost(self, words: str) -> float:
        numbers = [self._numbers.get(word, -1) for word in (_EDGE, *words.split(), _EDGE)]
        pairs = (self._pair_costs[p] if min(p) >= 0 else RARE_PAIR for p in pairwise(numbers))
        return sum(min(RARE_PAIR, cost) - UNPAIRED for cost in pairs)

    def _is_derived(self, sentence: str) -> bool:
        parser = self.language.parser
        chart = parser.chart(tokenize(sentence, self.language.builder.contractions), {})
        is_sentence = any(map(chart.derivations, parser.grammar.roots))
        return is_sentence or self.language.control(sentence) is not None

    def _meaning(self, text: str) -> Meaning | None:
        found = self.language.utterance_parser.understand(text, _NOTHING_SAID, ())
        is_open = found.kind in {"error", "ask_back"} or found.new_words or found.unknown
        return self.language.control(text) or (None if is_open else found.meaning)

    def _other_words(self, costs: Floats, spans: Sequence[tuple[int, int]]) -> list[list[_Edge]]:
        """Return the words within some spans that sound most like what is heard at each place."""
        edges, wide = [list[_Edge]() for _ in costs], costs.shape[2] - 1
        is_rare = np.arange(costs.shape[1]) >= len(self._words)
        near = costs[:, :, 1:] + (UNPAIRED + REPLACING + RARE * is_rare).astype(np.float32)[:, None]
        ends = np.add.outer(np.arange(len(costs)), np.arange(1, wide + 1))
        is_within = np.zeros(ends.shape, bool)
        for start, end in spans:
            is_within[start:end] |= ends[start:end] <= end
        likely = np.flatnonzero((near < UNPAIRED + MOST_CHANGE) & is_within[:, None])
        places, words, more = np.unravel_index(likely, near.shape)
        found, span = near[places, words, more], places * wide + more
        order = np.argsort(span * 2 * MOST_CHANGE + found)  # by span, then by cost
        span = np.append([-1] * _NEAREST, span[order])
        for at in order[span[_NEAREST:] != span[:-_NEAREST]].tolist():
            place, end = int(places[at]), int(ends[places[at], more[at]])
            word = self._all_words[words[at]]
            edges[place].append(_Edge(float(found[at]), end, word, is_other=True))
        return edges

    def costs(self, text: str, names: Collection[str] = ()) -> Floats:
        """Return what words cost, less for those of names, on all spans of a text that is heard.

        By where a span begins, word and number of phones; one place for too little or too much.
        """
        heard = self._heard(text)
        costs = self._span_costs(heard if len(heard) <= MOST_PHONES else ())
        costs[:, np.isin(np.arange(costs.shape[1]), self._articles, invert=True), 0] = _NEVER
        likely = {word for name in names for word in name.split()} & self._numbers.keys()
        costs[:, [self._numbers[word] for word in likely]] -= BONUS
        return costs

    def _heard(self, text: str) -> list[tuple[int, float]]:
        words = re.findall(r"[\w']+", text)
        return [each for word in words for each in self._sounds.of_word(word)[0]]

    def _span_costs(self, heard: Sequence[tuple[int, float]]) -> Floats:
        """Return what a word costs that is heard as so many phones: by place, word and number."""
        places, most = len(heard) + 1, len(self._levels) + _LONGER
        phones = np.array([phone for phone, _ in heard] + [0] * most)
        gaps = np.full(len(phones), _NEVER, np.float32)
        gaps[: len(heard)] = [GAP * weight for _, weight in heard]
        rows = np.zeros((_LONGER + 1, 1, places), np.float32)  # by number, last phone and place
        for span in range(_LONGER):
            rows[span + 1] = rows[span] + gaps[span : span + places]
        spoken = len(self._all_words) + len(self._owners)
        costs = np.full((places, spoken, most + 1), _NEVER, np.float32)
        for level in self._levels:
            before = rows[:, level.before]
            near = self._sounds.distances[level.phones][:, phones] * level.weights
            rows = np.full((len(before) + 1, *before.shape[1:]), _NEVER, np.float32)
            rows[:-1] = before + GAP * level.weights
            for span, row in enumerate(rows[1:]):
                within = slice(span, span + places)
                np.minimum(row, before[span] + near[:, within], out=row)
                np.minimum(row, rows[span] + gaps[within], out=row)
            costs[:, level.spoken, : len(rows)] = rows[:, level.ends].T
        first, further = np.split(costs, [len(self._all_words)], axis=1)
        for word, cost in zip(self._owners, further.swapaxes(0, 1), strict=True):
            first[:, word] = np.minimum(first[:, word], cost)
        return first

    def _ways_on(self, costs: Floats) -> Floats:
        """Return the least cost from each place to the end, with each word as the next one."""
        (places, words, wide), skipped = costs.shape, self._articles
        after = np.full((places + wide, words), _NEVER, np.float32)  # by place and word before it
        after[places - 1] = self._pair_costs[:, 0]
        ways = np.full((places, words), _NEVER, np.float32)
        for place in reversed(range(places - 1)):
            ways[place] = (costs[place, :, 1:] + after[place + 1 : place + wide].T).min(axis=1)
            after[place] = (self._pair_costs + ways[place]).min(axis=1)
            left_out = costs[place, skipped, 0] + after[place, skipped]
            ways[place, skipped] = np.minimum(ways[place, skipped], left_out)
            after[place] = (self._pair_costs + ways[place]).min(axis=1)
        return ways

    def _best(self, costs: Floats) -> Iterator[tuple[float, str]]:
        ways, order = self._ways_on(costs), count()
        reached = np.where(np.arange(len(costs)) == 0, 0, _NEVER).astype(np.float32)
        heap: list[tuple[float, int, tuple[int, ...], Floats]] = [(0, next(order), (0,), reached)]
        for _ in range(_STEPS):
            total, _, (*before, last), reached = heappop(heap)
            if before and last == 0:
                yield total, " ".join(self._words[word] for word in before[1:])
            else:
                if before:
                    pair = self._pair_costs[before[-1], last]
                    reached = _after_word(reached, costs[:, last]) + pair
                totals = (reached[:, None] + ways).min(axis=0) + self._pair_costs[last]
                totals[0] = reached[-1] + self._pair_costs[last, 0]
                for word in np.argsort(totals)[:_BRANCHES].tolist():
                    if totals[word] < _NEVER:
                        new = (float(totals[word]), next(order), (*before, last, word), reached)
                        heappush(heap, new)
            if not heap:
                return


def _levels(spoken: Sequence[tuple[tuple[int, float], ...]]) -> Iterator[_Level]:
    before: dict[tuple[tuple[int, float], ...], int] = {(): 0}
    for length in range(1, max(map(len, spoken)) + 1):
        begun = dict.fromkeys(phones[:length] for phones in spoken if len(phones) >= length)
        numbers = {phones: number for number, phones in enumerate(begun)}
        ended = [(at, numbers[phones]) for at, phones in enumerate(spoken) if len(phones) == length]
        last, weights = zip(*(phones[-1] for phones in begun), strict=True)
        numbered = np.array([before[phones[:-1]] for phones in begun])
        counted = np.array(weights, np.float32)[:, None]
        yield _Level(numbered, np.array(last), counted, *np.reshape(ended, (-1, 2)).astype(int).T)
        before = numbers


def _paths(edges: Sequence[Sequence[_Edge]], most: float) -> Iterator[tuple[float, str]]:
    """Return the paths from the first place to the last with few other words, cheapest first."""
    rest = [[_NEVER] * (MOST_REPLACED + 1) for _ in edges]  # by place and words that may be others
    rest[-1] = [0.0] * (MOST_REPLACED + 1)
    for costs, leaving in reversed([*zip(rest[:-1], edges[:-1], strict=True)]):
        for left in range(MOST_REPLACED + 1):
            on = [e.cost + rest[e.end][left - e.is_other] for e in leaving if left >= e.is_other]
            costs[left] = min(on, default=_NEVER)
    order, heap = count(), [(rest[0][MOST_REPLACED], 0, 0, MOST_REPLACED, "")]
    while heap:
        total, _, place, left, said = heappop(heap)
        if place == len(edges) - 1:
            yield total, said.lstrip()
        for edge in edges[place]:
            after = left - edge.is_other
            cost = total - rest[place][left] + edge.cost + rest[edge.end][after]
            if after >= 0 and cost <= most:
                heappush(heap, (cost, next(order), edge.end, after, f"{said} {edge.word}"))


def _after_word(reached: Floats, costs: Floats) -> Floats:
    phones = np.arange(costs.shape[1])
    starts = np.subtract.outer(np.arange(len(reached)), phones) % len(reached)
    # Before the first place stand the last ones, from which so many phones lead nowhere.
    return (reached[starts] + costs[starts, phones]).min(axis=1)


@dataclass(frozen=True)
class _Sounds:
    """The phones of words, and how far each phone is from each other one, in [0, 1]."""

    words: Mapping[str, Sequence[Phones]]
    letters: Mapping[str, Phones]
    numbers: Mapping[str, int]
    distances: Floats
    articles: frozenset[str]
    endings: frozenset[str]

    def of_word(self, word: str) -> list[list[tuple[int, float]]]:
        """Return the pronunciations of a word: numbers of phones, and how much each counts.

        An unknown word sounds as its letters do; articles and endings of inflection count half.
        """
        letters = re.findall("|".join(self.letters), word.lower())
        spelled = sum((self.letters[each] for each in letters), ())
        found: list[list[tuple[int, float]]] = []
        for phones in self.words.get(word.lower()) or [spelled]:
            weights = [0.5 if word.lower() in self.articles else 1.0] * len(phones)
            if len(phones) > 1 and phones[-1] in self.endings:
                weights[-1] = 0.5
            found.append([(self.numbers[p], w) for p, w in zip(phones, weights, strict=True)])
        return found


@lru_cache(maxsize=1)
def _load_sounds() -> _Sounds:
    known, names = pronunciations(), ("vowels", "endings", "articles", "near", "letters")
    fields = read_yaml(Path(__file__).with_name("phones.yaml")).entries(required=names, optional=())
    vowels, endings, articles = (frozenset(fields[name].texts()) for name in names[:3])
    letters = {key: tuple(str(n.value).split()) for key, n in fields["letters"].entries().items()}
    pairs = {pair for each in fields["near"].items() for pair in combinations(each.texts(), 2)}
    words = {word: [tuple(each.split()) for each in ways] for word, ways in known.items()}
    phones = sorted({phone for variants in words.values() for each in variants for phone in each})
    numbers = {phone: number for number, phone in enumerate(phones)}

    def distance(one: str, other: str) -> float:
        if not pairs.isdisjoint({(one, other), (other, one)}):
            return NEAR
        return (one != other) * (VOWEL if {one, other} <= vowels else OTHER)

    distances = np.array([[distance(one, other) for other in phones] for one in phones], np.float32)
    return _Sounds(words, letters, numbers, distances, articles, endings)
