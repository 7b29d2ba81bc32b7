"""Export and import of files: RDF in its formats, tables, graphs and the rule sheet.

What is read is checked before it is written, and applied whole or not at all; reading the same file
twice changes nothing the second time. Two bases that know the same write the same text, so exports
can be compared line by line. `registry` lists what each format carries.
"""

import io
from collections.abc import Iterable, Iterator
from contextlib import closing
from itertools import chain
from pathlib import Path
from typing import BinaryIO, TypeVar, cast

from ...ontology.vocabulary import split
from ..bulk.exporter import MAX_SORTED, Progress, scan_rules, statements
from ..bulk.importer import import_rules, import_statements, merge
from ..bulk.reconciliation import ImportSummary
from ..knowledge_base import KnowledgeBase
from ..rdf.annotated_turtle import expand_annotations, write_annotated
from ..rdf.rule_mapping import BELIEFS, RULE_NODE, rule_quads
from ..rdf.terms import ReifyingTriple, StatementGroup, Statements, ungrouped
from ..rule import Rule
from ..stores.base import Store
from ..stores.rdf_text import quad_from_engine, read_groups, write_rdf_to
from ..validation import MAX_SHACL, findings, raise_findings, stage
from .file_streams import CheckedStream, open_input, open_output
from .graphml import read_graphml, write_graphml
from .registry import FORMATS, RULE_FORMATS, FileFormat, format_of
from .rule_yaml import read_sheet, write_sheet
from .value_notation import read_table, write_table

T = TypeVar("T")
_STEP = 10_000  # statements or rules between two calls of the progress
MAX_STAGED = MAX_SORTED  # statements; a file of more must be in order


def export_file(
    base: KnowledgeBase,
    file: str | Path,
    *,
    format: str | None = None,
    rules_only: bool = False,
    progress: Progress | None = None,
) -> int:
    """Write the rules or the whole base to a file, and return how many statements that are.

    The extension of the file names the format, unless it is given; ".gz" compresses. "-" is
    standard output, turtle by default. `rules_only` leaves out all but the rules, where the format
    could hold the whole base. `progress` is called with how many statements or rules are written.
    DataError if the format is unknown, or the file cannot be written.
    """
    name = format_of(str(file), format, "turtle").name
    with open_output(str(file)) as stream:
        return write_base(base.store, stream, format=name, rules_only=rules_only, progress=progress)


def write_base(
    store: Store,
    stream: BinaryIO,
    *,
    format: str,
    rules_only: bool = False,
    progress: Progress | None = None,
) -> int:
    """Write the rules or the whole base of a store into a stream; as `export_file`.

    OSError if the stream cannot be written to; StoreError if the store cannot be read.
    """
    total = 0

    def counted(things: Iterable[T]) -> Iterator[T]:
        nonlocal total
        for thing in things:
            yield thing
            total += 1
            if progress and total % _STEP == 0:
                progress(total)

    with store.writing():  # so that all of it is of one moment
        if format in RULE_FORMATS:
            _write_rules(counted(scan_rules(store)), stream, format)
            return total
        quads = counted(statements(store, rules_only=rules_only or not FORMATS[format].whole))
        if format == "turtle12":
            lines = write_annotated(map(quad_from_engine, quads))
            stream.writelines(line.encode() for line in lines)
        else:
            write_rdf_to(quads, stream, format=format)
    return total


def import_file(
    base: KnowledgeBase,
    file: str | Path,
    *,
    format: str | None = None,
    dry_run: bool = False,
    progress: Progress | None = None,
) -> ImportSummary:
    """Import the rules and history of a file: checked first, applied whole or not at all.

    The extension of the file names the format, unless it is given; packed files are unpacked. "-"
    is standard input, trig by default. A `dry_run` only finds out what would change. `progress` is
    called with how many bytes of the file have been read. DataError if it cannot be read or parsed;
    says where. ValidationError if it breaks the shapes or laws; the base is unchanged.
    """
    chosen = format_of(str(file), format, "trig")
    with open_input(str(file), chosen, progress) as source:
        name = source.name
        if chosen.name in RULE_FORMATS:
            return import_rules(base, read_rules(source, chosen), source=name, dry_run=dry_run)
        items = read_statements(source, chosen)
        first, size = list[Statements](), 0
        for item in items:
            first.append(item)
            size += len(item.pairs) if isinstance(item, StatementGroup) else 1
            if size > MAX_STAGED:
                break
        if size > MAX_STAGED or (size > MAX_SHACL and _is_in_order(first)):
            return import_statements(base, chain(first, items), source=name, dry_run=dry_run)
        with closing(_staged(first, name)) as staging:  # which puts them in order
            raise_findings(findings(staging))
            return merge(base, staging, source=name, dry_run=dry_run)


def read_file(file: str | Path, *, format: str | None = None) -> Store:
    """Read a file into a store, unchecked (see `findings`); a DataError says where it is wrong."""
    chosen = format_of(str(file), format, "trig")
    with open_input(str(file), chosen) as source:
        if chosen.name in RULE_FORMATS:
            quads = (quad for rule in read_rules(source, chosen) for quad in rule_quads(rule))
            return stage(quads, source=source.name)
        return _staged(read_statements(source, chosen), source.name)


def read_rules(source: CheckedStream, chosen: FileFormat) -> Iterator[Rule]:
    """The rules of a file that holds rules only."""
    if chosen.name == "csv":
        return read_table(source.lines(), source=source.name)
    if chosen.name == "sheet":
        return read_sheet("".join(source.lines()), source=source.name)
    return read_graphml(source.readall(), source=source.name)


def read_statements(source: CheckedStream, chosen: FileFormat) -> Iterator[Statements]:
    """The statements of an RDF file; those that name no graph are among the beliefs."""
    name = chosen.name.removesuffix("12")
    stream = cast(BinaryIO, source)
    for item in read_groups(stream, format=name, source=source.name, default=BELIEFS):
        source.report_statement()
        yield item


def _is_in_order(items: Iterable[Statements]) -> bool:
    seen = set[object]()
    for item in items:
        if isinstance(item, ReifyingTriple):
            return False
        if split(item.node)[0] == "rule":
            if item[:2] in seen or not RULE_NODE.fullmatch(item.node):
                return False
            seen.add(item[:2])
    return True


def _staged(items: Iterable[Statements], source: str) -> Store:
    return stage(expand_annotations(ungrouped(items), source=source), source=source)


def _write_rules(rules: Iterable[Rule], stream: BinaryIO, name: str) -> None:
    if name == "graphml":
        stream.write(write_graphml(rules))
        return
    text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
    try:
        (write_table if name == "csv" else write_sheet)(text, rules)
    finally:
        text.detach()
