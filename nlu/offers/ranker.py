# SPDX-License-Identifier: Apache-2.0
"""The ranker: a log-linear model of which candidate was meant, or none of them.

A candidate's score is the sum of the weights of its features: a trait of the meaning together with
a word, a pair of words or a label of the utterance; the words around the name that fills a slot;
the order of the slots; the names that are left over. The weights are data, trained by
`benchmarks/train_offers.py`. The probability is the softmax over all candidates and "none".
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from .candidates import CandidateMeaning
from .mentions import Mentions

NONE = "none"
"""The trait of the choice that no candidate was meant."""

_START, _END = "^", "$"


@dataclass(frozen=True)
class Ranker:
    """The weights of the model.

    Attributes:
        weights: by what an utterance or a filling has, and within it by the trait of the meaning.
    """

    weights: Mapping[str, Mapping[str, float]]

    def probabilities(
        self, mentions: Mentions, candidates: Sequence[CandidateMeaning]
    ) -> tuple[float, ...]:
        """Return the probability of each candidate, in [0, 1]; the rest is that of "none"."""
        said: dict[str, float] = {}
        for feature in utterance_features(mentions):
            for trait, weight in self.weights.get(feature, {}).items():
                said[trait] = said.get(trait, 0.0) + weight
        of_shape: dict[str, float] = {}
        scores = [said.get(NONE, 0.0)]
        for each in candidates:
            shape = each.shape
            if shape.text not in of_shape:
                of_shape[shape.text] = sum(said.get(trait, 0.0) for trait in shape.traits)
            scores.append(of_shape[shape.text] + self._of_filling(each, mentions))
        greatest = max(scores)
        powers = [math.exp(score - greatest) for score in scores]
        total = sum(powers)
        return tuple(power / total for power in powers[1:])

    def _of_filling(self, candidate: CandidateMeaning, mentions: Mentions) -> float:
        found = (
            self.weights.get(feature, {}).get(trait, 0.0)
            for feature, trait in filling_features(candidate, mentions)
        )
        return sum(found)


def utterance_features(mentions: Mentions) -> Iterator[str]:
    """What an utterance has: its words and labels, and pairs of neighbours."""
    labels = _labels(mentions)
    yield ""
    yield from dict.fromkeys(labels)
    yield from dict.fromkeys(f"{one} {other}" for one, other in pairwise((_START, *labels, _END)))
    yield from (f"!{each}" for each in sorted(mentions.features))
    if mentions.tokens.asks:
        yield "?"
    if mentions.last is not None:
        yield "last"


def _labels(mentions: Mentions) -> tuple[str, ...]:
    return tuple(filter(None, mentions.labels))


def filling_features(candidate: CandidateMeaning, mentions: Mentions) -> Iterator[tuple[str, str]]:
    """How the names fill the slots: pairs of a feature and the trait it goes with."""
    kind = candidate.shape.traits[1]
    labels = (*mentions.labels, _END)
    order: list[tuple[int, str]] = []
    for slot, used in candidate.used.items():
        first = used[0]
        order.append((first.start, slot))
        before = labels[first.start - 1] if first.start else _START
        yield f"{before} _", slot
        yield f"_ {labels[first.end]}", slot
        yield f"{before} _", kind + slot
        if first.is_new:
            yield "new", slot
            yield labels[first.start], kind + slot
    yield " ".join(slot for _, slot in sorted(order)), kind
    for role, count in left_over(candidate, mentions).items():
        yield f"left {role}", kind
        yield f"left {role} {min(count, 3)}", ""


def left_over(candidate: CandidateMeaning, mentions: Mentions) -> Mapping[str, int]:
    """The number of names that a candidate does not use, by role; `new` for unknown words."""
    spans = {
        place for used in candidate.used.values() for m in used for place in range(m.start, m.end)
    }
    names = {str(value) for value in candidate.values.values()}
    left: dict[str, set[int]] = {}
    for each in mentions.names:
        if each.start not in spans and each.name not in names and each.role != "act":
            left.setdefault("new" if each.is_new else each.role, set()).add(each.start)
    if mentions.degrees and "?degree" not in candidate.shape.slots:
        left["degree"] = {place for place, _, _ in mentions.degrees}
    return {role: len(places) for role, places in left.items()}
