"""Candidates: the meanings that the names of an utterance allow, in every shape that fits them."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from itertools import islice, pairwise, permutations, product

from ..lexicon.tokenizer import BREAK
from ..semantics.meaning import Json
from .meaning_shapes import MeaningShape, role_of
from .mentions import Mention, Mentions, Span

MAX_FILLINGS = 12
"""The greatest number of ways in which the names of an utterance may fill one shape."""

Asides = tuple[Span, ...]


@dataclass(frozen=True)
class CandidateMeaning:
    """A shape, and for each of its slots the value; the mentions are those used, by slot."""

    shape: MeaningShape
    values: Mapping[str, object]
    used: Mapping[str, tuple[Mention, ...]]

    @cached_property
    def meaning(self) -> Json:
        """The meaning as a JSON object of the meaning schema."""
        return self.shape.filled(self.values)

    def asides(self, mentions: Mentions) -> Asides:
        """The spans of an utterance that say nothing of this meaning."""
        return mentions.asides(m for used in self.used.values() for m in used)

    def resolved(self, mentions: Mentions) -> Mentions:
        """The mentions, where the pronouns that this uses are names."""
        said = (m for used in self.used.values() for m in used if m in mentions.references)
        return replace(mentions, names=(*mentions.names, *(m for m in said if m.end > m.start)))


def candidates(
    mentions: Mentions, shapes: Iterable[MeaningShape], tool_acts: Mapping[str, str]
) -> Iterator[CandidateMeaning]:
    """Yield the ways in which the names of an utterance fill the shapes."""
    for shape in shapes:
        given = _given(shape, mentions)
        if given is None or any(
            len(slots) > len(mentions.by_role.get(role, ())) for role, slots in shape.roles.items()
        ):
            continue
        for names in islice(_fillings(shape, mentions), MAX_FILLINGS):
            values = {**given, **names}
            if "?tool" in shape.slots:
                goal = shape.filled({**dict.fromkeys(shape.slots, ""), **values})["goal"]
                if goal not in tool_acts:
                    continue
                values["?tool"] = tool_acts[str(goal)]
            used = {slot: mentions.by_role[role_of(slot)][name] for slot, name in names.items()}
            said = {value for value in values.values() if isinstance(value, str)}
            required = mentions.required_beside(used.values())
            # What is not named has no place: each of those stands apart.
            spans = [[(m.start, m.end or -n) for m in some] for n, some in enumerate(used.values())]
            is_apart = any(len(set(chosen)) == len(spans) for chosen in product(*spans))
            if is_apart and not any(map(said.isdisjoint, required)):
                yield CandidateMeaning(shape, values, used)


def _given(shape: MeaningShape, mentions: Mentions) -> dict[str, object] | None:
    slots = [slot for slot in _DEGREES if slot in shape.slots]
    said = list(dict.fromkeys(interval for _, _, interval in mentions.degrees))
    if slots and len(said) != len(slots):
        return None
    return {slot: list(interval) for slot, interval in zip(slots, said, strict=False)}


def _fillings(shape: MeaningShape, mentions: Mentions) -> Iterator[dict[str, str]]:
    by_role = [
        [
            dict(zip(slots, names, strict=True))
            for names in islice(permutations(mentions.by_role[role], len(slots)), MAX_FILLINGS)
        ]
        for role, slots in shape.roles.items()
    ]
    for chosen in product(*by_role):
        yield {slot: name for names in chosen for slot, name in names.items()}


_DEGREES = ("?degree", "?degree2")

NONE = "none"  # the trait of the choice that no candidate was meant

_START, _END = "^", "$"


@dataclass(frozen=True)
class OfferModel:
    """What was learned from utterances: the shapes of their meanings, and weights.

    A weight is by what an utterance or a filling has, and then by the trait of the meaning.
    """

    shapes: tuple[MeaningShape, ...]
    weights: Mapping[str, Mapping[str, float]]

    def probabilities(
        self, mentions: Mentions, candidates: Sequence[CandidateMeaning]
    ) -> tuple[float, ...]:
        """Return the probability of each candidate, in [0, 1]; the rest is that of "none"."""
        said = cache(partial(self._said, mentions))

        @cache
        def of_shape(shape: MeaningShape, asides: Asides) -> float:
            return sum(said(asides).get(trait, 0.0) for trait in shape.traits)

        scores = [said(mentions.asides(mentions.known)).get(NONE, 0.0)]
        for each in candidates:
            of_traits = of_shape(each.shape, each.asides(mentions))
            found = filling_features(each, mentions)
            of_names = sum(self.weights.get(one, {}).get(trait, 0.0) for one, trait in found)
            scores.append(of_traits + of_names)
        greatest = max(scores)
        powers = [math.exp(score - greatest) for score in scores]
        total = sum(powers)
        return tuple(power / total for power in powers[1:])

    def _said(self, mentions: Mentions, asides: Asides) -> dict[str, float]:
        said: dict[str, float] = {}
        for feature in utterance_features(mentions, asides):
            for trait, weight in self.weights.get(feature, {}).items():
                said[trait] = said.get(trait, 0.0) + weight
        return said


def utterance_features(mentions: Mentions, asides: Asides) -> Iterator[str]:
    """What an utterance has: its words and labels, and pairs of neighbours; `~` is said aside."""
    labels = list(mentions.labels)
    beside = [label for start, end in asides for label in labels[start:end]]
    for start, end in asides:
        labels[start:end] = [""] * (end - start)
    kept = [label for label in labels if label and label != BREAK]
    yield ""
    yield from dict.fromkeys(kept)
    yield from dict.fromkeys(f"{one} {other}" for one, other in pairwise((_START, *kept, _END)))
    yield from dict.fromkeys(f"~{label}" for label in beside if label)
    yield from (f"!{each}" for each in sorted(mentions.features))
    yield f"words {min(len(kept) // 4, 6)}"
    yield f"sentences {min(len(mentions.tokens.sentences), 3)}"
    if mentions.tokens.asks:
        yield "?"
    if mentions.references:
        yield "context"


def filling_features(candidate: CandidateMeaning, mentions: Mentions) -> Iterator[tuple[str, str]]:
    """How the names fill the slots: pairs of a feature and the trait it goes with."""
    kind = candidate.shape.traits[0]
    labels = (*mentions.labels, _END)
    order: list[tuple[int, str]] = []
    for slot, used in candidate.used.items():
        first = used[0]
        order.append((first.start, slot))
        before = labels[first.start - 1] if first.start else _START
        yield f"{before} _", slot
        yield f"_ {labels[first.end]}", slot
        if first in mentions.references:
            names = dict.fromkeys(m.name for m in mentions.references if m.role == first.role)
            yield f"reference {[*names].index(first.name)}", slot
            yield f"elided {not first.end}", kind + slot
        yield f"{before} _", kind + slot
        if first.is_new:
            yield "new", slot
            yield labels[first.start], kind + slot
    yield " ".join(slot for _, slot in sorted(order)), kind
    if order and BREAK in mentions.tokens.words[min(order)[0] : max(order)[0]]:
        yield "across", kind
    asides = candidate.asides(mentions)
    for role, places in left_over(candidate, mentions).items():
        yield f"left {role}", kind
        yield f"left {role} {min(len(places), 3)}", ""
        if role in {"new", "person"}:
            for place in places:
                aside = any(start <= place < end for start, end in asides)
                yield ("left aside", "") if aside else (f"left {labels[place - 1]} _", kind)


def left_over(candidate: CandidateMeaning, mentions: Mentions) -> Mapping[str, frozenset[int]]:
    """Return the places of unused names by role; `new` are unknown words, `known` may be names."""
    spans = {n for used in candidate.used.values() for m in used for n in range(m.start, m.end)}
    names = {str(value) for value in candidate.values.values()}
    left: dict[str, set[int]] = {}
    for each in mentions.names:
        if each.start not in spans and each.name not in names and each.role != "act":
            new = "new" if each.is_unknown else "known"
            left.setdefault(new if each.is_new else each.role, set()).add(each.start)
    if mentions.degrees and "?degree" not in candidate.shape.slots:
        left["degree"] = {place for place, _, _ in mentions.degrees}
    return {role: frozenset(places) for role, places in left.items()}
