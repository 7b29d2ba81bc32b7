"""Repair by sound: the sentences of the grammar that sound most like what a recogniser wrote.

A neural recogniser errs in spelling rather than in sound: "a silent rabbit" is "a salad grab it".
Its words become phones, and the sentences nearest to them are searched among those made of the
word pairs of Hilt's own grammar: costs of edits (Levenshtein 1966) and of word pairs, the best way
on from each place by dynamic programming backwards, then the best sentences by A* with these exact
costs (Soong & Huang 1991). They are only ever offered.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import count, islice, pairwise
from math import log

import numpy as np
import numpy.typing as npt

from ...nlu.jsgf import sentences
from ...nlu.language import Language
from ...nlu.semantics.meaning import Meaning
from .pronunciation import Phones, load_pronunciation

GAP = 0.8  # cost of a phone too many or too few
PAIR = 0.25  # cost of a word pair: this times its negative log probability
BONUS = 0.3  # less cost of a likely word
MOST_PHONES = 90  # longer texts are not repaired
MOST_CANDIDATES = 10
_SENTENCES, _SEED = 20_000, 0  # from which the word pairs are counted
_LONGER = 3  # by how many phones a word may be heard longer than it is
_MOST_STEPS = 600  # of the search
_MOST_BRANCHES = 30  # at each of them
_NEVER = 1e4

Floats = npt.NDArray[np.float32]
Integers = npt.NDArray[np.int64]


@dataclass(frozen=True)
class RepairCandidate:
    """A sentence that a text may have been.

    Attributes:
        cost: how far its sound is from that of the text, per phone.
        margin: how much nearer it is than the next one with another meaning, per phone.
    """

    text: str
    cost: float
    margin: float


class SoundRepair:
    """Finds sentences by sound, with the words that a language knows.

    Making one takes a moment. MissingExtraError without the pronunciations of words.
    """

    def __init__(self, language: Language) -> None:
        self.language, self._sounds = language, load_pronunciation()
        pairs = Counter[tuple[str, str]]()
        for sentence in sentences(language, _SENTENCES, random.Random(_SEED)):
            pairs.update(pairwise(["", *sentence.split(), ""]))  # "" is the beginning and the end
        self._words = sorted({word for pair in pairs for word in pair})
        self._numbers = {word: number for number, word in enumerate(self._words)}
        firsts = Counter[str]()
        for (first, _), times in pairs.items():
            firsts[first] += times
        self._pair_costs = np.full((len(self._words),) * 2, _NEVER, np.float32)
        for (first, second), times in pairs.items():
            place = self._numbers[first], self._numbers[second]
            self._pair_costs[place] = -PAIR * log(times / firsts[first])
        self._may_be_left_out = np.array([word in self._sounds.articles for word in self._words])
        self._phones = {phone: number for number, phone in enumerate(self._sounds.phones)}
        self._distances = self._sounds.distances()
        self._spoken = list(self._by_length())

    def candidates(self, text: str, bonus: Collection[str] = ()) -> list[RepairCandidate]:
        """Return the sentences of different meanings that sound like a text, the nearest first.

        The words of the names in `bonus` are likelier than others.
        """
        phones = sum(len(each) for each in self._heard(text))
        meanings: dict[Meaning, tuple[str, float]] = {}
        for cost, sentence in self.nearest(text, bonus):
            understood = self.language.understand(sentence)
            if understood.kind not in {"error", "ask_back"}:
                meanings.setdefault(understood.meaning, (sentence, cost / phones))
        found = [*meanings.values(), ("", np.inf)]
        return [
            RepairCandidate(text, cost, after - cost)
            for (text, cost), (_, after) in pairwise(found)
        ]

    def nearest(self, text: str, bonus: Collection[str] = ()) -> list[tuple[float, str]]:
        """Return the sentences that sound most like a text with their costs, the nearest first."""
        heard = self._heard(text)
        if not 0 < sum(map(len, heard)) <= MOST_PHONES:
            return []
        costs = self._span_costs(heard)
        likely = {word for name in bonus for word in name.split()} & self._numbers.keys()
        costs[:, [self._numbers[word] for word in sorted(likely)]] -= BONUS
        return list(islice(self._search(costs), MOST_CANDIDATES))

    def _heard(self, text: str) -> list[Phones]:
        words = "".join(each if each.isalnum() or each == "'" else " " for each in text).split()
        return [self._sounds.of_word(word)[0] for word in words]

    def _by_length(self) -> Iterator[tuple[list[int], Integers, Floats]]:
        """Yield the words that have as many phones, with these and how much each of them counts."""
        groups: dict[tuple[int, int], list[tuple[int, Phones, list[float]]]] = {}
        for number, word in enumerate(self._words[1:], start=1):
            for variant, phones in enumerate(self._sounds.of_word(word)):
                weights = self._sounds.weights(phones, word in self._sounds.articles)
                group = groups.setdefault((variant, len(phones)), [])
                group.append((number, phones, weights))
        for group in groups.values():
            numbers, spoken, weights = zip(*group, strict=True)
            indices = np.array([[self._phones[phone] for phone in each] for each in spoken])
            yield list(numbers), indices, np.array(weights, np.float32)

    def _span_costs(self, heard: Sequence[Phones]) -> Floats:
        """Return what it costs that a word is heard as so many phones from a place on.

        By place, word and number of phones.
        """
        phones = [self._phones[phone] for word in heard for phone in word]
        gaps = [gap for word in heard for gap in self._gaps(word)]
        most = max(spoken.shape[1] for _, spoken, _ in self._spoken) + _LONGER
        costs = np.full((len(phones) + 1, len(self._words), most + 1), _NEVER, np.float32)
        for words, spoken, weights in self._spoken:
            wide = spoken.shape[1] + _LONGER
            place = np.arange(len(phones) + 1)[:, None] + np.arange(wide)
            near = self._distances[np.pad(phones, (0, wide))[place]]
            alone = np.pad(np.array(gaps, np.float32), (0, wide), constant_values=_NEVER)[place]
            before = np.pad(np.cumsum(alone, axis=1), ((0, 0), (1, 0)))[:, None]
            rows = np.repeat(before, len(words), axis=1)
            for phone, weight in zip(spoken.T, weights.T, strict=True):
                swapped = rows[..., :-1] + near[:, :, phone].swapaxes(1, 2) * weight[:, None]
                rows = rows + weight[:, None] * GAP
                rows[..., 1:] = np.minimum(rows[..., 1:], swapped)
                rows = np.minimum.accumulate(rows - before, axis=2) + before
            costs[:, words, : wide + 1] = np.minimum(costs[:, words, : wide + 1], rows)
        costs[:, ~self._may_be_left_out, 0] = _NEVER
        return costs

    def _gaps(self, word: Phones) -> list[float]:
        is_article = any(word in self._sounds.of_word(each) for each in self._sounds.articles)
        return [GAP * weight for weight in self._sounds.weights(word, is_article)]

    def _ways_on(self, costs: Floats) -> Floats:
        """Return the least cost from each place on to the end, with each word as the next one."""
        length, (_, words, most) = len(costs) - 1, costs.shape
        after = np.full((length + most, words), _NEVER, np.float32)  # by place and word before
        after[length] = self._pair_costs[:, 0]
        ways = np.full((length + 1, words), _NEVER, np.float32)
        skipped = np.flatnonzero(self._may_be_left_out)
        for place in reversed(range(length)):
            ahead = after[place + 1 : place + most]
            ways[place] = (costs[place, :, 1:] + ahead.T).min(axis=1)
            after[place] = (self._pair_costs + ways[place]).min(axis=1)
            left_out = costs[place, skipped, 0] + after[place, skipped]
            ways[place, skipped] = np.minimum(ways[place, skipped], left_out)
            after[place] = (self._pair_costs + ways[place]).min(axis=1)
        return ways

    def _search(self, costs: Floats) -> Iterator[tuple[float, str]]:
        ways, order = self._ways_on(costs), count()
        begun = np.full(len(costs), _NEVER, np.float32)
        begun[0] = 0
        heap: list[tuple[float, int, tuple[int, ...], Floats]] = [(0, next(order), (0,), begun)]
        for _ in range(_MOST_STEPS):
            if not heap:
                return
            total, _, said, reached = heappop(heap)
            last = said[-1]
            if said[1:] and last == 0:
                yield total, " ".join(self._words[word] for word in said[1:-1])
                continue
            if said[1:]:
                reached = _reached(reached, costs[:, last]) + self._pair_costs[said[-2], last]
            totals = (reached[:, None] + ways).min(axis=0) + self._pair_costs[last]
            totals[0] = reached[-1] + self._pair_costs[last, 0]
            for word in np.argsort(totals)[:_MOST_BRANCHES].tolist():
                if totals[word] < _NEVER:
                    heappush(heap, (float(totals[word]), next(order), (*said, word), reached))


def _reached(before: Floats, costs: Floats) -> Floats:
    """Return the least cost at each place after a word, from those before it and its own costs."""
    found = np.full_like(before, _NEVER)
    for phones, cost in enumerate(costs.T[: len(before)]):
        end = len(before) - phones
        found[phones:] = np.minimum(found[phones:], before[:end] + cost[:end])
    return found
