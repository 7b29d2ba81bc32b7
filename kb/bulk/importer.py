# SPDX-License-Identifier: Apache-2.0
"""Imports of any size: a million rules are checked and written without being held in memory.

The file is read once. Each rule is checked on its own as it comes (its interval, its form, its
name) and written as lines of N-Quads, which the engine takes while they are made; only numbers are
kept of it. The engine makes them visible as one unit at the end, or drops all when something is
wrong. What is not a rule (utterances, words, episodes) is staged and checked as for small files.

The statements of one rule must stand together, as they do in every export.
"""

from __future__ import annotations

import gc
import re
import tempfile
from array import array
from collections import defaultdict, deque
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import BinaryIO, Protocol, TypeVar, runtime_checkable

from ...ontology.errors import DataError, ValidationError
from ...ontology.vocabulary import ATOM_KINDS, PREFIXES, Iri, shortened, split, term
from ..history import ASSERTS, HISTORY, SEQUENCE, Utterance, import_utterance
from ..knowledge_base import KnowledgeBase
from ..merge import (
    MAX_LISTED,
    MergeConflict,
    Plan,
    Summary,
    are_apart,
    claim,
    plan_history,
    plan_rest,
    plan_trust,
)
from ..rdf import rule_mapping
from ..rdf.annotations import Reified
from ..rdf.rule_mapping import BELIEFS, LABEL, RULE, STATUS, TYPE
from ..rdf.terms import Quad, Term
from ..reader import BASE_GRAPH, BASE_NODE, RuleReader
from ..rule import Rule
from ..staging import check_graph, findings, stage
from ..stores.base import Store
from ..validation import raise_findings
from ..writer import to_milliseconds
from .copying import FastRuleReader
from .lines import LineWriter
from .rule_lines import Printer, RuleSerializer, SerializedRule
from .statements import Group, RuleBlock

MAX_REST = 3_000_000  # statements that belong to no rule and are held in memory
PER_UTTERANCE = 1000  # rules that one utterance of the history stands for
_DERIVED = frozenset((TYPE, LABEL, RULE, term("usedFor"), term("graspedBy"), term("affords")))
_NAMED = frozenset((*ATOM_KINDS, "node", "functor"))

_RULES = PREFIXES["rule"]
_ASSERTED = re.compile(f"{re.escape(_RULES)}([0-9a-f]{{16}})")

T = TypeVar("T")


@runtime_checkable
class Loading(Protocol):
    """A store that loads N-Quads as one unit, while they are made."""

    def load(self, lines: Iterable[bytes]) -> None:
        """Add the statements of the lines; durable when this returns."""
        ...


@dataclass
class _Read:
    """What is kept of what was read."""

    rest: list[Quad] = field(default_factory=list[Quad])  # what belongs to no rule
    asserted: dict[int, array[int]] = field(  # ids of rules by the number of an utterance
        default_factory=lambda: defaultdict(lambda: array("Q"))
    )
    ids: array[int] = field(default_factory=lambda: array("Q"))  # of new rules
    utterances: array[int] = field(default_factory=lambda: array("Q"))  # of each; 0 where none
    timeless: set[int] = field(default_factory=set[int])  # ids of new rules without a time
    seen: set[int] = field(default_factory=set[int])
    known: int = 0
    conflicting: int = 0
    conflicts: list[MergeConflict] = field(default_factory=list[MergeConflict])
    speakers: set[str] = field(default_factory=set[str])
    trusted: set[str] = field(default_factory=set[str])
    utterances_added: int = 0


@dataclass
class _Plan(Plan):
    """A plan that keeps apart what utterances assert: that is as much as there are rules."""

    asserted: list[tuple[int, tuple[str, ...]]] = field(
        default_factory=list[tuple[int, tuple[str, ...]]]
    )

    def add(self, utterance: Utterance) -> None:
        """As `Plan.add`, without what it asserts."""
        self.asserted.append((utterance.sequence, utterance.asserts))
        super().add(replace(utterance, asserts=()))


class _Held:
    """What was written and is not taken yet."""

    def __init__(self) -> None:
        self._chunks = deque[bytes]()

    @property
    def has_some(self) -> bool:
        return bool(self._chunks)

    def write(self, chunk: bytes) -> None:
        self._chunks.append(chunk)

    def taken(self) -> Iterator[bytes]:
        while self._chunks:
            yield self._chunks.popleft()


def import_groups(
    base: KnowledgeBase,
    groups: Iterable[Group | RuleBlock | Reified],
    *,
    source: str,
    dry_run: bool,
) -> Summary:
    """Take over a large RDF file; see `exchange.import_file`.

    Args:
        base: what is written to.
        groups: its statements as they are read.
        source: the name of the file.
        dry_run: only say what would come of it.
    """
    read = _Read()
    rules = _rules(groups, read, source)
    return _import(base, rules, read, source=source, dry_run=dry_run)


def import_rules(
    base: KnowledgeBase, rules: Iterable[SerializedRule], *, source: str, dry_run: bool
) -> Summary:
    """Take over many rules; as `import_groups`."""
    return _import(base, rules, _Read(), source=source, dry_run=dry_run)


def _import(
    base: KnowledgeBase, rules: Iterable[SerializedRule], read: _Read, *, source: str, dry_run: bool
) -> Summary:
    """Load the lines of all that is new while they are made; a mistake in any loads none."""
    store = base.store
    with store.writing(), _uncollected():
        plan = _Plan(base.sequence)
        lines = _lines(base, rules, read, plan, source)
        if dry_run:
            deque(lines, maxlen=0)
        else:
            old = set(store.quads(BASE_NODE, SEQUENCE, None, BASE_GRAPH))
            _load(store, lines, source)
            store.apply(delete={*plan.delete, *old} - {*plan.insert})
    return Summary(
        len(read.ids),
        read.known,
        read.conflicting,
        read.utterances_added,
        tuple(sorted(read.speakers - read.trusted)),
        tuple(read.conflicts),
    )


@contextmanager
def _uncollected() -> Generator[None]:
    """Look for no cycles meanwhile: millions of values are made, and none refers to itself."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def _lines(
    base: KnowledgeBase, rules: Iterable[SerializedRule], read: _Read, plan: _Plan, source: str
) -> Iterator[bytes]:
    """All that is new as N-Quads: the rules first, then the rest, which is complete then."""
    held, printer = _Held(), Printer()
    write, before = LineWriter(held), plan.last
    for star in _new(base, rules, read):
        write.text(printer.lines(star))
        if held.has_some:
            yield from held.taken()
    staging = stage(read.rest, source=source)
    read.rest.clear()
    try:
        raise_findings(findings(staging))
        other = _Staged(staging, read.asserted)
        plan_trust(plan, base, other)
        plan_history(plan, base, other)
        plan_rest(plan, base, other)
        for _ in _finish(base, plan, read, write, source):
            yield from held.taken()
        read.utterances_added = len({each for each in plan.numbers.values() if each > before})
        read.trusted = {*base.speakers(), *other.speakers()}
    finally:
        staging.close()
    write.flush()
    yield from held.taken()


def _rules(
    things: Iterable[Group | RuleBlock | Reified], read: _Read, source: str
) -> Iterator[SerializedRule]:
    """The rules among statements; what belongs to none is put aside."""
    copier, stamps = FastRuleReader(), RuleSerializer()
    for one in things:
        if isinstance(one, RuleBlock):
            star = copier.star(one)
            if star:
                yield star
                continue
        for group in one.groups() if isinstance(one, RuleBlock) else [one]:
            group = _checked(group, source)  # noqa: PLW2901
            if group.node.startswith(_RULES):
                yield stamps.of(_rule(group.node, group.pairs))
            else:
                read.rest += _beside_rules(group, read)
        if len(read.rest) > MAX_REST:
            raise DataError(
                f"has more than {MAX_REST} statements besides its rules; import the rules alone "
                "(hilt export --rules), or restore a backup.",
                source=source,
            )


def _checked(group: Group | Reified, source: str) -> Group:
    """Refuse what stands in no graph of a base, or cannot be read as it streams by."""
    if isinstance(group, Reified):
        raise DataError(
            "annotated edges (RDF 1.2) are read from small files only; take N-Quads or CSV.",
            source=source,
        )
    check_graph(group.graph, source=source)
    return group


def _beside_rules(group: Group, read: _Read) -> Iterator[Quad]:
    """What has to be kept of the statements about a node that is no rule."""
    node, graph, pairs = group
    kind, name = split(node)
    # What a rule stands for besides its star is written again with the rule.
    written = _DERIVED if graph == BELIEFS and kind in _NAMED else frozenset[Iri]()
    # Formats without graphs have it among the beliefs.
    is_told = kind == "utterance" and name.isdecimal() and graph in {HISTORY, BELIEFS}
    for key, value in pairs:
        if is_told and key == ASSERTS and (rule := _ASSERTED.fullmatch(str(value))):
            read.asserted[int(name)].append(int(rule[1], 16))
        elif key not in written:
            yield Quad(node, key, value, graph)


def _rule(node: Iri, properties: list[tuple[Iri, Term]]) -> Rule:
    try:
        return rule_mapping.read_rule(properties)
    except ValidationError as error:
        raise ValidationError([f"{shortened(node)}: {one}" for one in error.findings]) from error


def _new(
    base: KnowledgeBase, rules: Iterable[SerializedRule], read: _Read
) -> Iterator[SerializedRule]:
    """The rules that the base does not have; what has to be known of them is kept in `read`."""
    contradicts = _Believed(base)
    there = _ids_of(base.store) if base.sequence else frozenset[int]()
    for star in rules:
        number, utterance, time, *_ = star
        if number in there:
            read.known += 1
            continue
        if number in read.seen:
            continue
        read.seen.add(number)
        read.ids.append(number)
        read.utterances.append(utterance or 0)
        read.speakers.add(star.speaker)
        if time is None:
            read.timeless.add(number)
        if there and star.status == "active":
            found = contradicts.by(star.rule)
            read.conflicting += len(found)
            read.conflicts += found[: MAX_LISTED - len(read.conflicts)]
        yield star


def _finish(
    base: KnowledgeBase, plan: _Plan, read: _Read, write: LineWriter, source: str
) -> Iterator[None]:
    """Write where the rules come from, and everything else that is new; stop now and then."""
    moment = to_milliseconds(base.clock())
    for some, which in _nameless(read, plan):
        plan.last += 1
        plan.numbers[-plan.last] = plan.last  # it stands for no number of the other's
        plan.add(import_utterance(source, plan.last, moment, some=which))
        write.asserted(plan.last, some)
        write.told(some, plan.last)
        yield
    for said, ids in plan.asserted:
        write.asserted(said, map(_number, ids))
        yield
    for number, told in zip(read.ids, read.utterances, strict=True):
        if told in plan.numbers:
            write.told([number], plan.numbers[told])
    for several in _batched(read.timeless, PER_UTTERANCE):
        write.believed(several, moment)
        yield
    # The new number comes with what it counts; the old one goes after that, and never counts.
    if plan.last:
        plan.insert.append(Quad(BASE_NODE, SEQUENCE, plan.last, BASE_GRAPH))
    write.quads(plan.insert)


def _nameless(read: _Read, plan: Plan) -> Iterator[tuple[list[int], str]]:
    """The rules that no utterance asserted, some at a time, and which of all these they are."""
    numbers = [
        number
        for number, told in zip(read.ids, read.utterances, strict=True)
        if told not in plan.numbers
    ]
    start = 1
    for some in _batched(numbers, PER_UTTERANCE):
        which = f", rules {start} to {start + len(some) - 1}" if len(numbers) > len(some) else ""
        yield some, which
        start += len(some)


def _load(store: Store, lines: Iterable[bytes], source: str) -> None:
    """Add all statements as one unit."""
    if isinstance(store, Loading):
        store.load(lines)
        return
    with tempfile.TemporaryFile(prefix="hilt-") as spool:
        spool.writelines(lines)
        spool.seek(0)
        store.apply(insert=_spooled(spool, source))


def _spooled(spool: BinaryIO, source: str) -> Iterator[Quad]:
    from ..stores.rdf_text import read_rdf

    for one in read_rdf(spool, format="nquads", source=source, default=BELIEFS):
        if isinstance(one, Quad):
            yield one


def _ids_of(store: Store) -> frozenset[int]:
    """The numbers of all rules of a store."""
    return frozenset(
        int(split(quad.subject)[1], 16) for quad in store.quads(None, STATUS, None, BELIEFS)
    )


def _number(rule_id: str) -> int:
    return int(rule_id.removeprefix("rule/"), 16)


def _id(number: int) -> str:
    return f"rule/{number:016x}"


def _batched(things: Iterable[T], size: int) -> Iterator[list[T]]:
    rest = iter(things)
    while some := list(islice(rest, size)):
        yield some


class _Staged(RuleReader):
    """What was put aside; which rules an utterance asserts was kept as numbers only."""

    def __init__(self, staging: Store, asserted: Mapping[int, array[int]]) -> None:
        super().__init__(staging)
        self._asserted = asserted

    def utterance(self, sequence: int) -> Utterance:
        """As `RuleReader.utterance`, with the rules that it asserts."""
        found = super().utterance(sequence)
        ids = map(_id, self._asserted.get(sequence, ()))
        return replace(found, asserts=tuple(sorted({*found.asserts, *ids})))


class _Believed:
    """The active rules of a base by what they claim, read as they are needed."""

    def __init__(self, base: KnowledgeBase) -> None:
        self._base = base
        self._nodes: set[str] = set()
        self._rules: dict[object, list[Rule]] = defaultdict(list)

    def by(self, rule: Rule) -> list[MergeConflict]:
        """Where a rule contradicts what is believed."""
        if rule.node not in self._nodes:
            self._nodes.add(rule.node)
            for one in self._base.rules_at_nodes([rule.node]):
                self._rules[claim(one)].append(one)
        return [
            MergeConflict(rule, other)
            for other in self._rules.get(claim(rule), ())
            if are_apart(rule.interval, other.interval)
        ]
