# SPDX-License-Identifier: Apache-2.0
"""Rules copied from a file as they stand there, some times as fast as by way of `Rule`.

Most large files are exports: every rule stands in them as Hilt writes it, under the name that its
content gives it. Rules differ in their features and bounds; what else they say comes again and
again, so it is read, checked and written once, by the functions that do so for single rules.
A rule that stands there in another way, or breaks a law, is not copied but read in full
(`rule_mapping.read_rule`), which also says what is wrong.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime
from decimal import Decimal
from typing import TypeAlias, cast

from ...ontology.errors import HiltError
from ...ontology.vocabulary import PREFIXES, Iri, split
from ..interval import DIGITS
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import DECIMAL, Quad, Term, as_sparql
from ..rule import Atom
from .rule_lines import OWN, FeatureLines, RuleSerializer, RuleTemplate, SerializedRule, make_room
from .statements import RuleBlock

Pair: TypeAlias = "tuple[Iri, Term]"

_RULES = PREFIXES["rule"]
_PLACES = (
    rule_mapping.FEATURE,
    rule_mapping.LOWER,
    rule_mapping.UPPER,
    rule_mapping.DERIVED_FROM,
    rule_mapping.GENERATED_AT,
)
_FEATURE, _LOWER, _UPPER, _SOURCE, _TIME = _PLACES
_SHARED = "shared"  # stands for all other properties
_BOUND = re.compile(
    f"({as_sparql(_LOWER)}|{as_sparql(_UPPER)}) "
    rf'"([01](?:\.[0-9]{{1,{DIGITS}}})?)"\^\^<{DECIMAL}>(?: {as_sparql(BELIEFS)})? \.'
)
_MAX_TOLD = 4  # characters of a bound as people say it: 0.95
# Stands for what a rule does not share.
_ANY: tuple[Pair, ...] = (
    (rule_mapping.FEATURE, rule_mapping.atom_iri(Atom("object", "any"))),
    (rule_mapping.LOWER, Decimal(1)),
    (rule_mapping.UPPER, Decimal(1)),
)


class FastRuleReader:
    """Recognises the rules that can be copied."""

    def __init__(self) -> None:
        self._stamps = RuleSerializer()
        self._frames: dict[tuple[str, ...], RuleTemplate] = {}
        self._seen: dict[tuple[str, ...], FeatureLines] = {}
        self._known: dict[str, tuple[str, Term]] = {}

    def star(self, block: RuleBlock) -> SerializedRule | None:
        """The rule of a block; None where it has to be read in full."""
        try:
            star = self._star(block)
        except (HiltError, KeyError, ValueError):
            return None
        return star if f"{block.node}" == f"{_RULES}{star.number:016x}" else None

    def _star(self, block: RuleBlock) -> SerializedRule:
        shared, features, own = list[str](), list[str](), dict[str, Term]()
        known = self._known
        for tail in block.tails:
            place, value = known.get(tail) or self._learn(tail, block)
            if place is _SHARED:
                shared.append(tail)
            elif place is _FEATURE:
                features.append(tail)
            elif place in own:
                raise ValueError(tail)
            else:
                own[place] = value
        return self._stamps.star(
            *(self._frame(tuple(shared), block), self._features(tuple(features), block)),
            *(cast(str, own[_LOWER]), cast(str, own[_UPPER])),
            time=cast("datetime | None", own.get(_TIME)),
            utterance=cast("int | None", own.get(_SOURCE)),
        )

    def _learn(self, tail: str, block: RuleBlock) -> tuple[str, Term]:
        """Which of the properties of a rule a line tells, and what of it."""
        if bound := _BOUND.fullmatch(tail):
            place = _LOWER if bound[1] == f"<{_LOWER}>" else _UPPER
            found = place, f"{float(bound[2]):.{DIGITS}f}"
            if len(bound[2]) > _MAX_TOLD:  # it hardly comes again
                return found
        else:
            found = _placed(*block.pair(tail))
        make_room(self._known)
        self._known[tail] = found
        return found

    def _frame(self, tails: tuple[str, ...], block: RuleBlock) -> RuleTemplate:
        known = self._frames.get(tails)
        if known is None:
            make_room(self._frames)
            pairs = [block.pair(tail)[0] for tail in tails]
            rule = rule_mapping.read_rule([*pairs, *_ANY])
            _refuse_others(
                pairs, [q for q in rule_mapping.property_quads(rule) if q.predicate not in OWN]
            )
            known = self._frames[tails] = self._stamps.frame(rule)
        return known

    def _features(self, tails: tuple[str, ...], block: RuleBlock) -> FeatureLines:
        known = self._seen.get(tails)
        if known is None:
            make_room(self._seen)
            pairs = [block.pair(tail)[0] for tail in tails]
            atoms = {
                rule_mapping.atom_from_iri(value) for _, value in pairs if isinstance(value, Iri)
            }
            written = [
                Quad(Iri(""), rule_mapping.FEATURE, rule_mapping.atom_iri(atom)) for atom in atoms
            ]
            _refuse_others(pairs, written)
            known = self._seen[tails] = self._stamps.seen(frozenset(atoms))
        return known


def _placed(pair: Pair, graph: Iri) -> tuple[str, Term]:
    """Which of the properties of a rule a statement tells, and what of it."""
    key, value = pair
    if graph != BELIEFS or key in {_LOWER, _UPPER}:  # a bound, and not as Hilt writes it
        raise ValueError(pair)
    place = next((place for place in _PLACES if place == key), _SHARED)
    if place is _SOURCE:
        return place, _utterance(value)
    if place is _TIME and not isinstance(value, datetime):
        raise ValueError(pair)
    return place, value


def _refuse_others(pairs: Sequence[Pair], written: Sequence[Quad]) -> None:
    """Refuse what stands in another way than Hilt writes it."""
    if sorted(pairs, key=str) != sorted(((q.predicate, q.object) for q in written), key=str):
        raise ValueError(pairs)


def _utterance(node: Term) -> int:
    kind, name = split(node) if isinstance(node, Iri) else ("", "")
    if kind != "utterance" or not name.isdecimal():
        raise ValueError(node)
    return int(name)
