# SPDX-License-Identifier: Apache-2.0
"""Bases and rules as files: RDF in its formats, tables, graphs and the rule sheet.

What is read is checked first, by SHACL and by the laws of intervals and rules, and applied whole
or not at all. Reading the same file twice changes nothing the second time. Two bases that know
the same write the same text, so exports can be compared line by line. `formats` tells which
format carries what.
"""

from __future__ import annotations

import io
from collections.abc import Generator, Iterable, Iterator
from contextlib import contextmanager
from itertools import chain, islice
from pathlib import Path
from typing import BinaryIO, TypeAlias, TypeVar, cast

from ...ontology.vocabulary import split, term
from ..bulk.exporter import dump_statements, is_dumped, is_large
from ..bulk.lines import LineWriter
from ..bulk.rule_lines import RuleSerializer, SerializedRule
from ..bulk.statements import Group, RuleBlock, in_full
from ..bulk.statements import read_groups as read_statement_groups
from ..history import HISTORY
from ..knowledge_base import KnowledgeBase
from ..merge import Merged, Summary, merge
from ..rdf import rule_mapping
from ..rdf.annotations import Reified, expand_annotations, write_annotated
from ..rdf.rule_mapping import BELIEFS, TYPE
from ..rdf.terms import Quad, as_sparql
from ..reader import TRUST_LOWER, TRUST_UPPER, RuleReader
from ..rule import Rule
from ..staging import GRAPHS, findings, stage, stage_rules
from ..stores.base import Store
from ..validation import RULE_CLASSES, raise_findings, rule_nodes
from .registry import FORMATS, RULE_FORMATS, Format, format_of
from .streams import InputStream, Progress, reading, writing

Thing = TypeVar("Thing")
Read: TypeAlias = Group | RuleBlock | Reified

# What stands among the beliefs besides the stars of rules.
_BESIDE_RULES = (
    *(rule_mapping.TYPE, rule_mapping.LABEL, rule_mapping.RULE, TRUST_LOWER, TRUST_UPPER),
    *(term("usedFor"), term("graspedBy"), term("affords")),
)

MAX_SORTED = 200_000  # statements; more of them are neither sorted nor checked by SHACL
MAX_RULES = 10_000  # of a table; more of them are read as they stream by


def export_file(
    base: KnowledgeBase,
    file: str | Path,
    *,
    format: str | None = None,  # noqa: A002
    rules_only: bool = False,
    progress: Progress | None = None,
) -> int:
    """Write the rules or the whole base to a file.

    Args:
        base: what is written.
        file: its extension names the format, ".gz" packs it; "-" is standard output.
        format: the name of a format; by default that of the file, turtle for "-".
        rules_only: leave out all but the rules, where the format could hold the whole base.
        progress: is told how many statements (or rules, in formats that hold only those) are
            written.

    Returns:
        How many that were.

    Raises:
        DataError: the format is unknown, or the file cannot be written.
    """
    chosen = format_of(str(file), format, "turtle")
    with writing(str(file)) as stream:
        return write_base(
            base, stream, format=chosen.name, rules_only=rules_only, progress=progress
        )


def write_base(
    base: KnowledgeBase,
    stream: BinaryIO,
    *,
    format: str,  # noqa: A002
    rules_only: bool = False,
    progress: Progress | None = None,
) -> int:
    """Write the rules or the whole base into a stream; as `export_file`."""
    chosen = FORMATS[format]
    if chosen.name in RULE_FORMATS:
        return _write_rules(base, stream, chosen, progress)
    only = rules_only or not chosen.whole
    return _write_statements(base.store, stream, chosen, progress, rules_only=only)


def import_file(
    base: KnowledgeBase,
    file: str | Path,
    *,
    format: str | None = None,  # noqa: A002
    dry_run: bool = False,
    progress: Progress | None = None,
) -> Summary:
    """Take over the rules and history of a file: checked first, applied whole or not at all.

    Args:
        base: what is written to.
        file: its extension names the format; "-" is standard input. Packed files are unpacked.
        format: the name of a format; by default that of the file, trig for "-".
        dry_run: only say what would come of it.
        progress: is told how many bytes of the file have been read.

    Returns:
        What was new, known and conflicting.

    Raises:
        DataError: the file cannot be read or parsed; says where.
        ValidationError: it breaks the shapes or laws; the base is unchanged.
    """
    chosen = format_of(str(file), format, "trig")
    is_xml = chosen.name in _XML
    with reading(str(file), most=chosen.most, is_xml=is_xml, progress=progress) as source:
        return _import(base, source, chosen, dry_run=dry_run)


def import_text(
    base: KnowledgeBase,
    data: bytes,
    *,
    format: str,  # noqa: A002
    source: str = "<text>",
    dry_run: bool = False,
) -> Merged:
    """Take over the rules and history of a text; as `import_file`.

    Args:
        base: what is written to.
        data: the text in UTF-8.
        format: the name of a format.
        source: its name, for messages and the history.
        dry_run: only say what would come of it.
    """
    chosen = format_of(source, format, "trig")
    is_xml = chosen.name in _XML
    read = InputStream(io.BytesIO(data), source, most=chosen.most, is_xml=is_xml)
    return _take(base, _staged(read, chosen), source, dry_run=dry_run)


def read_file(file: str | Path, *, format: str | None = None) -> Store:  # noqa: A002
    """What a file says, in a store of its own, unchecked; `staging.findings` checks it.

    Raises:
        DataError: the file cannot be read or parsed; says where.
    """
    chosen = format_of(str(file), format, "trig")
    with reading(str(file), most=chosen.most, is_xml=chosen.name in _XML) as source:
        return _staged(source, chosen)


_XML = frozenset({"rdfxml", "graphml"})


def _import(base: KnowledgeBase, source: InputStream, chosen: Format, *, dry_run: bool) -> Summary:
    """Small files are checked by SHACL too and explained in full; large ones as they stream by."""
    from ..bulk import importer  # it needs what this module needs

    name = source.name
    if chosen.name in RULE_FORMATS:
        rules = read_rules(source, chosen)
        some = list(islice(rules, MAX_RULES + 1))
        if len(some) > MAX_RULES:
            every = chain(some, rules)
            return importer.import_rules(base, every, source=name, dry_run=dry_run)
        staging = stage_rules(star.rule for star in some)
        return _take(base, staging, name, dry_run=dry_run).summary
    groups = read_groups(source, chosen)
    first = _first(groups, MAX_SORTED)
    if _size(first) > MAX_SORTED:
        every = chain(first, groups)
        return importer.import_groups(base, every, source=name, dry_run=dry_run)
    return _take(base, _settled(_flat(first), name), name, dry_run=dry_run).summary


def _first(groups: Iterator[Read], most: int) -> list[Read]:
    """Some groups, of more than `most` statements where there are so many."""
    found: list[Read] = []
    count = 0
    while count <= most and (group := next(groups, None)) is not None:
        found.append(group)
        count += _size([group])
    return found


def _size(things: Iterable[Read]) -> int:
    return sum(map(_count, things))


def _count(one: Read) -> int:
    if isinstance(one, RuleBlock):
        return len(one.tails)
    return len(one.pairs) if isinstance(one, Group) else 1


def _flat(things: Iterable[Read]) -> Iterator[Quad | Reified]:
    for group in in_full(things):
        yield from group.quads() if isinstance(group, Group) else (group,)


def _take(base: KnowledgeBase, staging: Store, source: str, *, dry_run: bool) -> Merged:
    try:
        raise_findings(findings(staging))
        return merge(base, RuleReader(staging), source=source, dry_run=dry_run)
    finally:
        staging.close()


def _staged(source: InputStream, chosen: Format) -> Store:
    if chosen.name in RULE_FORMATS:
        return stage_rules(star.rule for star in read_rules(source, chosen))
    return _settled(_flat(read_groups(source, chosen)), source.name)


def _settled(statements: Iterable[Quad | Reified], source: str) -> Store:
    return stage(expand_annotations(statements, source=source), source=source)


def read_all(source: InputStream, chosen: Format) -> int:
    """Read a file to its end and count what it holds, rules or statements; keep nothing.

    Raises:
        DataError: it cannot be read or parsed; says where.
    """
    if chosen.name in RULE_FORMATS:
        return sum(1 for _ in read_rules(source, chosen))
    return _size(read_groups(source, chosen))


def read_rules(source: InputStream, chosen: Format) -> Iterator[SerializedRule]:
    """The rules of a file that holds rules only."""
    match chosen.name:
        case "csv":
            from .csv_table import read_table

            yield from read_table(source.lines(), source=source.name)
        case "graphml":
            from .graphml import read_graphml

            yield from map(
                RuleSerializer().of, read_graphml(source.everything(), source=source.name)
            )
        case _:
            from .rule_yaml import read_sheet

            rules = read_sheet("".join(source.lines()), source=source.name)
            yield from map(RuleSerializer().of, rules)


def read_groups(source: InputStream, chosen: Format) -> Iterator[Read]:
    """The statements of an RDF file; those that name no graph are among the beliefs."""
    name = chosen.name.removesuffix("12")
    stream = cast(BinaryIO, source)
    for one in read_statement_groups(stream, format=name, source=source.name, default=BELIEFS):
        source.heard()
        yield one


def export_quads(store: Store, *, rules_only: bool) -> list[Quad]:
    """The statements of an export, sorted so that equal bases give equal lists."""
    return sorted(_exported(store, rules_only=rules_only), key=_order)


def write_text(quads: Iterable[Quad], *, format: str) -> bytes:  # noqa: A002
    """Statements as text in UTF-8."""
    if format == "turtle12":
        return "".join(write_annotated(quads)).encode()
    from ..stores.rdf_text import write_rdf

    return write_rdf(quads, format=format)


def _exported(store: Store, *, rules_only: bool) -> Iterator[Quad]:
    if not rules_only:
        yield from store.quads()
        return
    sources: set[object] = set()
    for quad in store.quads(None, None, None, BELIEFS):
        if quad.predicate == rule_mapping.DERIVED_FROM:
            sources.add(quad.object)
        yield quad
    yield from (q for q in store.quads(None, None, None, HISTORY) if q.subject in sources)


def _write_statements(
    store: Store,
    stream: BinaryIO,
    chosen: Format,
    progress: Progress | None,
    *,
    rules_only: bool,
) -> int:
    if is_dumped(store, chosen, MAX_SORTED):
        return dump_statements(store, stream, chosen, progress, rules_only=rules_only)
    count = _Count(progress)
    first = list(islice(_exported(store, rules_only=rules_only), MAX_SORTED + 1))
    if len(first) <= MAX_SORTED:
        stream.write(write_text(count.over(sorted(first, key=_order)), format=chosen.name))
        return count.total
    first.clear()
    quads = count.over(_together(store, rules_only=rules_only))
    if chosen.name == "nquads":
        lines = LineWriter(stream)
        lines.quads(quads)
        lines.flush()
    elif chosen.name == "turtle12":
        stream.writelines(line.encode() for line in write_annotated(quads))
    else:
        from ..stores.rdf_text import write_rdf_to

        write_rdf_to(quads, stream, format=chosen.name)
    return count.total


def _together(store: Store, *, rules_only: bool) -> Iterator[Quad]:
    """The statements of an export, those of one rule together: so that they can be streamed."""
    sources: set[object] = set()
    for node in rule_nodes(store):
        for key, value in store.properties(node, BELIEFS):
            if key == rule_mapping.DERIVED_FROM:
                sources.add(value)
            yield Quad(node, key, value, BELIEFS)
    rules = set(RULE_CLASSES)
    for key in _BESIDE_RULES:
        found = store.quads(None, key, None, BELIEFS)
        yield from (quad for quad in found if key != TYPE or quad.object not in rules)
    for graph in sorted(GRAPHS - {BELIEFS}):
        if graph == HISTORY or not rules_only:
            found = store.quads(None, None, None, graph)
            yield from (q for q in found if not rules_only or q.subject in sources)


def _write_rules(
    base: KnowledgeBase, stream: BinaryIO, chosen: Format, progress: Progress | None
) -> int:
    count = _Count(progress)
    rules = count.over(all_rules(base.reader))
    match chosen.name:
        case "csv":
            return _write_table(base, stream, progress)
        case "graphml":
            from .graphml import write_graphml

            stream.write(write_graphml(rules))
        case _:
            from .rule_yaml import write_sheet

            if is_large(base.store, MAX_SORTED):
                return _write_large_sheet(base.store, stream, progress)
            stream.writelines(line.encode() for line in write_sheet(rules))
    return count.total


def _write_large_sheet(store: Store, stream: BinaryIO, progress: Progress | None) -> int:
    from ..bulk.columns import scan_rules
    from .rule_yaml import BEGIN, HEAD, write_row

    stream.write((HEAD + BEGIN).encode())
    return scan_rules(
        store, lambda rows: stream.write("".join(map(write_row, rows)).encode()), progress
    )


def _write_table(base: KnowledgeBase, stream: BinaryIO, progress: Progress | None) -> int:
    """A small table in the order of the ids, a large one as the rules come."""
    with _as_text(stream) as text:
        if is_large(base.store, MAX_SORTED):
            from ..bulk.columns import write_columns

            return write_columns(base.store, text, progress)
        from .csv_table import write_table

        count = _Count(progress)
        write_table(count.over(all_rules(base.reader)), text)
        return count.total


@contextmanager
def _as_text(stream: BinaryIO) -> Generator[io.TextIOWrapper]:
    text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
    yield text
    text.detach()


def all_rules(base: RuleReader) -> Iterator[Rule]:
    """Every rule, whatever its status, one after the other in the order of their ids."""
    for node in rule_nodes(base.store):
        yield rule_mapping.read_rule(base.properties(node))


class _Count:
    """Counts what goes by."""

    def __init__(self, progress: Progress | None) -> None:
        self.total = 0
        self._progress = progress

    def over(self, things: Iterable[Thing]) -> Iterator[Thing]:
        """The same things."""
        for thing in things:
            self.total += 1
            if self._progress and self.total % 1000 == 0:
                self._progress(self.total)
            yield thing


def _order(quad: Quad) -> tuple[str, str, str, str, str]:
    kind, _ = split(quad.subject)
    first = "" if quad.predicate == TYPE else quad.predicate
    return (str(quad.graph), kind, str(quad.subject), str(first), as_sparql(quad.object))
