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
from typing import Any, NamedTuple, TypeAlias

from ..ontology.errors import ValidationError
from ..ontology.vocabulary import PREFIXES, Iri, split
from . import stars
from .interval import DIGITS
from .rule import Atom, Rule, Status, name_of, spelled
from .stars import BELIEFS
from .terms import DECIMAL, Quad, Term, as_sparql

Pair: TypeAlias = "tuple[Iri, Term]"

_MAX_KNOWN = 100_000  # of each kind that are remembered
_RULES = PREFIXES["rule"]
_END = f" {as_sparql(BELIEFS)} .\n"
_LOWER, _UPPER, _TIME, _RULE = (
    f" {as_sparql(key)} " for key in (stars.LOWER, stars.UPPER, stars.GENERATED_AT, stars.RULE)
)
# Where the statements of a rule are put; what it shares with others comes last.
_PLACES = {
    key: place
    for place, key in enumerate(
        (stars.FEATURE, stars.LOWER, stars.UPPER, stars.DERIVED_FROM, stars.GENERATED_AT)
    )
}
_SHARED = len(_PLACES)
# Stands for what a rule does not share. It asserts, so that its edge is found.
_ANY: tuple[Pair, ...] = (
    (stars.FEATURE, stars.atom_iri(Atom("object", "any"))),
    (stars.LOWER, Decimal(1)),
    (stars.UPPER, Decimal(1)),
)


class Frame(NamedTuple):
    """What rules share that differ in their features, bounds, source and time."""

    speaker: str
    status: Status
    contexts: str  # as they stand in the content that gives a rule its name
    conclusion: str  # likewise
    ends: tuple[str, ...]  # of its lines, behind the name of the rule
    node: str  # how the action-tree node is written
    edge: str  # how a plain edge goes on behind its feature; empty where there is none


class Seen(NamedTuple):
    """The features of a rule."""

    spelled: str  # as they stand in the content that gives a rule its name
    ends: tuple[str, ...]  # of their lines, behind the name of the rule
    nodes: tuple[str, ...]  # how they are written


class Star(NamedTuple):
    """A rule that can be copied.

    Attributes:
        id: its name.
        utterance: number of the utterance in the file that it comes from; None without one.
        time: when it was first believed; None where nothing is said.
        asserts: whether it speaks for its conclusion.
        lines: its statements but for that of its source, as lines of N-Quads.
        pairs: its statements.
        frame: what it shares with others.
        seen: its features.
    """

    id: str
    utterance: int | None
    time: datetime | None
    asserts: bool
    lines: str
    pairs: Sequence[Pair]
    frame: Frame
    seen: Seen

    @property
    def speaker(self) -> str:
        """Who told it."""
        return self.frame.speaker

    @property
    def status(self) -> Status:
        """Whether it is believed."""
        return self.frame.status

    @property
    def rule(self) -> Rule:
        """It as a rule."""
        return stars.read_rule(self.pairs)


class Copier:
    """Recognises the rules that can be copied, and writes them."""

    def __init__(self) -> None:
        self._frames: dict[tuple[Pair, ...], Frame] = {}
        self._seen: dict[tuple[Pair, ...], Seen] = {}
        self._times: dict[datetime, str] = {}
        self._edges: set[tuple[str, str]] = set()
        self._mentioned: set[str] = set()

    def star(self, node: Iri, pairs: Sequence[Pair]) -> Star | None:
        """The rule of a node; None where it has to be read in full."""
        try:
            return self._star(node, pairs)
        except (ValidationError, ValueError):
            return None

    def lines(self, star: Star) -> str:
        """All that stands in the graph because of a rule but its utterance, as `Lines.rule`."""
        frame, said = star.frame, [star.lines]
        if frame.status == "active":
            said.append(f"{frame.node}{_RULE}<{_RULES}{star.id[len('rule/') :]}>{_END}")
            edge = star.seen.spelled, frame.edge
            if star.asserts and frame.edge and edge not in self._edges:
                _make_room(self._edges)
                self._edges.add(edge)
                said += (node + frame.edge for node in star.seen.nodes)
        about = star.seen.spelled, frame.contexts + frame.conclusion
        if not self._mentioned.issuperset(about):
            _make_room(self._mentioned)
            self._mentioned.update(about)
            said += map(_line, stars.mentions(star.rule))
        return "".join(said)

    def _star(self, node: Iri, pairs: Sequence[Pair]) -> Star | None:
        found: tuple[list[Pair], ...] = ([], [], [], [], [], [])
        for pair in pairs:
            found[_PLACES.get(pair[0], _SHARED)].append(pair)
        features, lowers, uppers, sources, times, shared = found
        ((_, low),), ((_, high),) = lowers, uppers
        frame, seen = self._frame(tuple(shared)), self._features(tuple(features))
        if not (seen.spelled or frame.contexts):
            return None
        lower, upper = _bound(low), _bound(high)
        name = name_of(
            *(frame.speaker, seen.spelled, frame.contexts, frame.conclusion, f"{lower} {upper}")
        )
        start = f"<{_RULES}{name[len('rule/') :]}>"
        time, since = self._time(times)
        ends = (
            *("", *frame.ends, *seen.ends, *since),
            *(f'{_LOWER}"{lower}"^^<{DECIMAL}>{_END}', f'{_UPPER}"{upper}"^^<{DECIMAL}>{_END}'),
        )
        belief, plausibility = float(lower), float(upper)
        if start != f"<{node}>" or not 0.0 <= belief <= plausibility <= 1.0:
            return None
        asserts = round(belief + plausibility, DIGITS) > 1.0
        said = start.join(ends)
        return Star(name, _utterance(sources), time, asserts, said, pairs, frame, seen)

    def _frame(self, shared: tuple[Pair, ...]) -> Frame:
        known = self._frames.get(shared)
        if known is None:
            _make_room(self._frames)
            rule = stars.read_rule([*shared, *_ANY])
            written = [quad for quad in stars.star(rule) if quad.predicate not in _PLACES]
            _refuse_others(shared, written)
            known = self._frames[shared] = _frame_of(rule, written)
        return known

    def _features(self, pairs: tuple[Pair, ...]) -> Seen:
        known = self._seen.get(pairs)
        if known is None:
            _make_room(self._seen)
            atoms = {stars.atom_of(value) for _, value in pairs if isinstance(value, Iri)}
            written = [Quad(Iri(""), stars.FEATURE, stars.atom_iri(atom)) for atom in atoms]
            _refuse_others(pairs, written)
            nodes = tuple(as_sparql(quad.object) for quad in written)
            known = Seen(spelled(frozenset(atoms)), tuple(map(_end, written)), nodes)
            self._seen[pairs] = known
        return known

    def _time(self, pairs: Sequence[Pair]) -> tuple[datetime | None, tuple[str, ...]]:
        """When a rule was first believed, and the end of the line that says so."""
        if not pairs:
            return None, ()
        ((_, time),) = pairs
        if not isinstance(time, datetime):
            raise ValueError(time)
        known = self._times.get(time)
        if known is None:
            _make_room(self._times)
            known = self._times[time] = f"{_TIME}{as_sparql(time)}{_END}"
        return time, (known,)


def _frame_of(rule: Rule, written: Sequence[Quad]) -> Frame:
    edges = stars.plain_edges(rule)
    return Frame(
        rule.speaker,
        rule.status,
        spelled(rule.contexts),
        rule.conclusion,
        tuple(map(_end, written)),
        as_sparql(stars.hanging(rule).subject),
        _end(edges[0]) if edges else "",
    )


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


def _end(quad: Quad) -> str:
    return f" {as_sparql(quad.predicate)} {as_sparql(quad.object)}{_END}"


def _line(quad: Quad) -> str:
    return as_sparql(quad.subject) + _end(quad)


def _make_room(known: dict[Any, Any] | set[Any]) -> None:
    if len(known) >= _MAX_KNOWN:
        known.clear()
