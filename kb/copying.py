# SPDX-License-Identifier: Apache-2.0
"""Rules copied from a file as they stand there, some times as fast as by way of `Rule`.

Most large files are exports: every rule stands in them as Hilt writes it, under the name that its
content gives it. Rules differ in their features and bounds; what else they say comes again and
again, so it is read, checked and written once, by the functions that do so for single rules.
A rule that stands there in another way, or breaks a law, is not copied but read in full
(`stars.read_rule`), which also says what is wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from decimal import Decimal
from typing import TypeAlias

from ..ontology.errors import HiltError
from ..ontology.vocabulary import PREFIXES, Iri, split
from . import stars
from .interval import DIGITS
from .rule import Atom
from .stamps import OWN, Frame, Seen, Stamps, Star, make_room
from .terms import Quad, Term

Pair: TypeAlias = "tuple[Iri, Term]"

_RULES = PREFIXES["rule"]
# Where the statements of a rule are put; what it shares with others comes last.
_PLACES = {
    key: place
    for place, key in enumerate(
        (stars.FEATURE, stars.LOWER, stars.UPPER, stars.DERIVED_FROM, stars.GENERATED_AT)
    )
}
_SHARED = len(_PLACES)
# Stands for what a rule does not share.
_ANY: tuple[Pair, ...] = (
    (stars.FEATURE, stars.atom_iri(Atom("object", "any"))),
    (stars.LOWER, Decimal(1)),
    (stars.UPPER, Decimal(1)),
)


class Copier:
    """Recognises the rules that can be copied."""

    def __init__(self) -> None:
        self._stamps = Stamps()
        self._frames: dict[tuple[Pair, ...], Frame] = {}
        self._seen: dict[tuple[Pair, ...], Seen] = {}

    def star(self, node: Iri, pairs: Sequence[Pair]) -> Star | None:
        """The rule of a node; None where it has to be read in full."""
        try:
            star = self._star(pairs)
        except (HiltError, ValueError):
            return None
        return star if f"{node}" == f"{_RULES}{star.number:016x}" else None

    def _star(self, pairs: Sequence[Pair]) -> Star:
        found: tuple[list[Pair], ...] = ([], [], [], [], [], [])
        for pair in pairs:
            found[_PLACES.get(pair[0], _SHARED)].append(pair)
        features, lowers, uppers, sources, times, shared = found
        ((_, low),), ((_, high),) = lowers, uppers
        return self._stamps.star(
            *(self._frame(tuple(shared)), self._features(tuple(features))),
            *(_bound(low), _bound(high)),
            time=_time(times),
            utterance=_utterance(sources),
        )

    def _frame(self, shared: tuple[Pair, ...]) -> Frame:
        known = self._frames.get(shared)
        if known is None:
            make_room(self._frames)
            rule = stars.read_rule([*shared, *_ANY])
            _refuse_others(shared, [q for q in stars.star(rule) if q.predicate not in OWN])
            known = self._frames[shared] = self._stamps.frame(rule)
        return known

    def _features(self, pairs: tuple[Pair, ...]) -> Seen:
        known = self._seen.get(pairs)
        if known is None:
            make_room(self._seen)
            atoms = {stars.atom_of(value) for _, value in pairs if isinstance(value, Iri)}
            written = [Quad(Iri(""), stars.FEATURE, stars.atom_iri(atom)) for atom in atoms]
            _refuse_others(pairs, written)
            known = self._seen[pairs] = self._stamps.seen(frozenset(atoms))
        return known


def _time(pairs: Sequence[Pair]) -> datetime | None:
    """When a rule was first believed."""
    if not pairs:
        return None
    ((_, time),) = pairs
    if not isinstance(time, datetime):
        raise ValueError(time)
    return time


def _refuse_others(pairs: Sequence[Pair], written: Sequence[Quad]) -> None:
    """Refuse what stands in another way than Hilt writes it."""
    if sorted(pairs, key=str) != sorted(((q.predicate, q.object) for q in written), key=str):
        raise ValueError(pairs)


def _bound(value: Term) -> str:
    """A bound as it stands in the content of a rule and in its line."""
    text = f"{value:.{DIGITS}f}" if isinstance(value, Decimal) else ""
    if not text or Decimal(text) != value:
        raise ValueError(value)
    return text


def _utterance(sources: Sequence[Pair]) -> int | None:
    if not sources:
        return None
    ((_, node),) = sources
    kind, name = split(node) if isinstance(node, Iri) else ("", "")
    if kind != "utterance" or not name.isdecimal():
        raise ValueError(node)
    return int(name)
