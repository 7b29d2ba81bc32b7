# SPDX-License-Identifier: Apache-2.0
"""Imports of any size: a million rules are checked and written without being held in memory.

The file is read once. Each rule is checked on its own as it comes (its interval, its form, its
name) and written as lines of N-Quads into a temporary file; only numbers are kept of it. When all
is right, that file is loaded into the store as one unit. What is not a rule (utterances, words,
episodes) is staged and checked as for small files.

The statements of one rule must stand together, as they do in every export.
"""

from __future__ import annotations

import tempfile
from array import array
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import groupby, islice
from pathlib import Path
from typing import BinaryIO, Protocol, TypeVar, runtime_checkable

from ..ontology.errors import DataError, ValidationError
from ..ontology.vocabulary import ATOM_KINDS, Iri, shortened, split, term
from . import stars
from .annotated import Reified
from .beliefs import KnowledgeBase
from .history import SEQUENCE, Utterance
from .lines import Lines
from .merging import (
    MAX_LISTED,
    Conflict,
    Plan,
    Summary,
    add_utterance,
    are_apart,
    claim,
    plan_history,
    plan_rest,
    plan_trust,
)
from .recall import BASE_GRAPH, BASE_NODE, Recall
from .rule import DEFAULT_SPEAKER, Rule
from .staging import findings, placed, stage
from .stars import BELIEFS, LABEL, RULE, STATUS, TYPE
from .store import Store
from .telling import to_milliseconds
from .terms import Quad
from .validation import refuse

MAX_REST = 3_000_000  # statements that belong to no rule and are held in memory
PER_UTTERANCE = 1000  # rules that one utterance of the history stands for
_DERIVED = frozenset((TYPE, LABEL, RULE, term("usedFor"), term("graspedBy"), term("affords")))
_NAMED = frozenset((*ATOM_KINDS, "node", "functor"))

T = TypeVar("T")


@runtime_checkable
class Loading(Protocol):
    """A store that loads a file of N-Quads as one unit."""

    def load(self, file: Path) -> None:
        """Add the statements of the file; durable when this returns."""
        ...


@dataclass
class _Read:
    """What is kept of what was read."""

    ids: array[int] = field(default_factory=lambda: array("Q"))  # of new rules
    utterances: array[int] = field(default_factory=lambda: array("Q"))  # of each; 0 where none
    timeless: set[int] = field(default_factory=set[int])  # ids of new rules without a time
    seen: set[int] = field(default_factory=set[int])
    known: int = 0
    conflicting: int = 0
    conflicts: list[Conflict] = field(default_factory=list[Conflict])
    speakers: set[str] = field(default_factory=set[str])


def import_statements(
    base: KnowledgeBase, statements: Iterable[Quad | Reified], *, source: str, dry_run: bool
) -> Summary:
    """Take over a large RDF file; see `exchange.import_file`.

    Args:
        base: what is written to.
        statements: as they are read.
        source: the name of the file.
        dry_run: only say what would come of it.
    """
    rest: list[Quad] = []
    quads = placed(_plain(statements, source), source=source)
    return _import(base, _rules(quads, rest, source), rest, source=source, dry_run=dry_run)


def import_rules(
    base: KnowledgeBase, rules: Iterable[Rule], *, source: str, dry_run: bool
) -> Summary:
    """Take over many rules; as `import_statements`."""
    return _import(base, rules, [], source=source, dry_run=dry_run)


def _import(
    base: KnowledgeBase, rules: Iterable[Rule], rest: list[Quad], *, source: str, dry_run: bool
) -> Summary:
    """Spool the rules, then stage the rest (which is complete then), then load all."""
    with tempfile.TemporaryDirectory(prefix="hilt-") as folder, base.store.writing():
        spool = Path(folder) / "base.nq"
        with spool.open("wb") as lines:
            read = _spool(base, rules, lines)
            staging = stage(rest, source=source)
            rest.clear()
            try:
                refuse(findings(staging))
                plan, before = Plan(base.sequence), base.sequence
                other = Recall(staging)
                plan_trust(plan, base, other)
                plan_history(plan, base, other)
                plan_rest(plan, base, other)
                _finish(base, plan, read, lines, source)
                trusted = {*base.speakers(), *other.speakers()}
            finally:
                staging.close()
        if not dry_run:
            _load(base, plan, before, spool)
    return Summary(
        len(read.ids),
        read.known,
        read.conflicting,
        len({number for number in plan.numbers.values() if number > before}),
        tuple(sorted(read.speakers - trusted)),
        tuple(read.conflicts),
    )


def _plain(statements: Iterable[Quad | Reified], source: str) -> Iterator[Quad]:
    for one in statements:
        if isinstance(one, Reified):
            raise DataError(
                "annotated edges (RDF 1.2) are read from small files only; take N-Quads or CSV.",
                source=source,
            )
        yield one


def _rules(quads: Iterable[Quad], rest: list[Quad], source: str) -> Iterator[Rule]:
    """The rules among statements; what belongs to none is put aside."""
    for node, several in groupby(quads, key=lambda quad: quad.subject):
        kind, _ = split(node)
        if kind == "rule":
            yield _rule(node, [(quad.predicate, quad.object) for quad in several])
            continue
        for quad in several:
            # What a rule stands for besides its star is written again with the rule.
            if quad.graph == BELIEFS and kind in _NAMED and quad.predicate in _DERIVED:
                continue
            rest.append(quad)
        if len(rest) > MAX_REST:
            raise DataError(
                f"has more than {MAX_REST} statements besides its rules; import the rules alone "
                "(hilt export --rules), or restore a backup.",
                source=source,
            )


def _rule(node: Iri, properties: list[tuple[Iri, object]]) -> Rule:
    try:
        return stars.read_rule(properties)  # pyright: ignore[reportArgumentType]
    except ValidationError as error:
        raise ValidationError([f"{shortened(node)}: {one}" for one in error.findings]) from error


def _spool(base: KnowledgeBase, rules: Iterable[Rule], lines: BinaryIO) -> _Read:
    """Write the statements of all new rules, but for the utterances that they come from."""
    read, write, contradicts = _Read(), Lines(lines), _Believed(base)
    there = _ids_of(base.store) if base.sequence else frozenset[int]()
    for rule in rules:
        number = _number(rule)
        if number in there:
            read.known += 1
            continue
        if number in read.seen:
            continue
        read.seen.add(number)
        read.ids.append(number)
        read.utterances.append(rule.utterance or 0)
        read.speakers.add(rule.speaker)
        if rule.time is None:
            read.timeless.add(number)
        if there and rule.status == "active":
            found = contradicts.by(rule)
            read.conflicting += len(found)
            read.conflicts += found[: MAX_LISTED - len(read.conflicts)]
        write.rule(rule)
    write.flush()
    return read


def _finish(base: KnowledgeBase, plan: Plan, read: _Read, lines: BinaryIO, source: str) -> None:
    """Write where the rules come from, and everything else that is new."""
    moment = to_milliseconds(base.clock())
    nameless = [
        (number, told)
        for number, told in zip(read.ids, read.utterances, strict=True)
        if told not in plan.numbers
    ]
    start = 1
    writer = Lines(lines)
    for some in _batched((number for number, _ in nameless), PER_UTTERANCE):
        plan.last += 1
        plan.numbers[-plan.last] = plan.last  # it stands for no number of the other's
        where = f", rules {start} to {start + len(some) - 1}" if len(nameless) > len(some) else ""
        ids = tuple(sorted(map(_id, some)))
        said = f"import of {source}{where}"
        add_utterance(
            plan,
            Utterance(plan.last, said, "", DEFAULT_SPEAKER, moment, "import", asserts=ids),
        )
        for rule_id in ids:
            writer.source(rule_id, plan.last)
        start += len(some)
    for number, told in zip(read.ids, read.utterances, strict=True):
        if told in plan.numbers:
            writer.source(_id(number), plan.numbers[told])
    writer.quads(
        Quad(stars.rule_iri(_id(number)), stars.GENERATED_AT, moment, BELIEFS)
        for number in read.timeless
    )
    writer.quads(plan.insert)
    writer.flush()


def _load(base: KnowledgeBase, plan: Plan, before: int, spool: Path) -> None:
    """The numbers first: if all ends between, some are skipped, but none is given twice."""
    store = base.store
    old = list(store.quads(BASE_NODE, SEQUENCE, None, BASE_GRAPH))
    new = [Quad(BASE_NODE, SEQUENCE, plan.last, BASE_GRAPH)] if plan.last > before else []
    store.apply(insert=new, delete=[*(old if new else ()), *plan.delete])
    if isinstance(store, Loading):
        store.load(spool)
    else:
        store.apply(insert=_spooled(spool))


def _spooled(spool: Path) -> Iterator[Quad]:
    from .oxigraph import read_rdf

    with spool.open("rb") as stream:
        for one in read_rdf(stream, format="nquads", source=str(spool), default=BELIEFS):
            if isinstance(one, Quad):
                yield one


def _ids_of(store: Store) -> frozenset[int]:
    """The numbers of all rules of a store."""
    return frozenset(
        int(split(quad.subject)[1], 16) for quad in store.quads(None, STATUS, None, BELIEFS)
    )


def _number(rule: Rule) -> int:
    return int(rule.id[len("rule/") :], 16)


def _id(number: int) -> str:
    return f"rule/{number:016x}"


def _batched(things: Iterable[T], size: int) -> Iterator[list[T]]:
    rest = iter(things)
    while some := list(islice(rest, size)):
        yield some


class _Believed:
    """The active rules of a base by what they claim, read as they are needed."""

    def __init__(self, base: KnowledgeBase) -> None:
        self._base = base
        self._nodes: set[str] = set()
        self._rules: dict[object, list[Rule]] = defaultdict(list)

    def by(self, rule: Rule) -> list[Conflict]:
        """Where a rule contradicts what is believed."""
        if rule.node not in self._nodes:
            self._nodes.add(rule.node)
            for one in self._base.rules_of([rule.node]):
                self._rules[claim(one)].append(one)
        return [
            Conflict(rule, other)
            for other in self._rules.get(claim(rule), ())
            if are_apart(rule.interval, other.interval)
        ]
