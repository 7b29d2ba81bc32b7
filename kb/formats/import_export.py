# SPDX-License-Identifier: Apache-2.0
"""Export and import of files: RDF in its formats, tables, graphs and the rule sheet.

What is read is checked before it is written, and applied whole or not at all; reading the same file
twice changes nothing the second time. Two bases that know the same write the same text, so exports
can be compared line by line. `registry` lists what each format carries.
"""

from __future__ import annotations

import io
from collections.abc import Generator, Iterable, Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import BinaryIO, cast

from ..bulk.exporter import TEXT_FORMATS, statements, write_statements
from ..bulk.importer import Statements, import_rules, import_statements
from ..bulk.nquads_reader import RuleBlock, StatementGroup, expand_blocks, read_groups
from ..bulk.reconciliation import ImportSummary
from ..bulk.rule_nquads import RuleSerializer, SerializedRule
from ..bulk.rule_scan import scan_rules
from ..bulk.statement_scan import MAX_SORTED, ProgressCounter
from ..knowledge_base import KnowledgeBase
from ..merge import merge
from ..rdf.annotated_turtle import ReifyingTriple, expand_annotations, write_annotated
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import Quad
from ..rule import Rule
from ..stores.base import Store
from ..validation import findings, raise_findings, stage, stage_rules
from .file_streams import CheckedStream, Progress, open_input, open_output
from .registry import FORMATS, RULE_FORMATS, FileFormat, format_of

MAX_STAGED = MAX_SORTED  # statements; a file of more is not checked by SHACL


def export_file(
    base: KnowledgeBase,
    file: str | Path,
    *,
    format: str | None = None,  # noqa: A002
    rules_only: bool = False,
    progress: Progress | None = None,
) -> int:
    """Write the rules or the whole base to a file, and return how many statements that are.

    Args:
        base: what is written.
        file: its extension names the format, ".gz" compresses it; "-" is standard output.
        format: the name of a format; by default that of the file, turtle for "-".
        rules_only: leave out all but the rules, where the format could hold the whole base.
        progress: is called with how many statements (or rules, in formats that hold only those)
            are written.

    Returns:
        The number of statements or rules.

    Raises:
        DataError: the format is unknown, or the file cannot be written.
    """
    name = format_of(str(file), format, "turtle").name
    with open_output(str(file)) as stream:
        return write_base(base, stream, format=name, rules_only=rules_only, progress=progress)


def write_base(
    base: KnowledgeBase,
    stream: BinaryIO,
    *,
    format: str,  # noqa: A002
    rules_only: bool = False,
    progress: Progress | None = None,
) -> int:
    """Write the rules or the whole base into a stream; as `export_file`."""
    store, chosen = base.store, FORMATS[format]
    only = rules_only or not chosen.whole
    if format in RULE_FORMATS:
        return _write_rules(store, stream, format, progress)
    if format in TEXT_FORMATS:
        return write_statements(store, stream, format, progress, rules_only=only)
    counter = ProgressCounter(progress)
    quads = _counted(statements(store, rules_only=only), counter)
    if format == "turtle12":
        stream.writelines(line.encode() for line in write_annotated(quads))
    else:
        from ..stores.rdf_text import write_rdf_to

        write_rdf_to(quads, stream, format=format)
    return counter.total


def import_file(
    base: KnowledgeBase,
    file: str | Path,
    *,
    format: str | None = None,  # noqa: A002
    dry_run: bool = False,
    progress: Progress | None = None,
) -> ImportSummary:
    """Import the rules and history of a file: checked first, applied whole or not at all.

    Args:
        base: what is written to.
        file: its extension names the format; "-" is standard input. Packed files are unpacked.
        format: the name of a format; by default that of the file, trig for "-".
        dry_run: only find out what would change.
        progress: is called with how many bytes of the file have been read.

    Returns:
        How many rules are new, known and conflicting.

    Raises:
        DataError: the file cannot be read or parsed; says where.
        ValidationError: it breaks the shapes or laws; the base is unchanged.
    """
    chosen = format_of(str(file), format, "trig")
    with _opened(file, chosen, progress) as source:
        return _import(base, source, chosen, dry_run=dry_run)


def import_text(
    base: KnowledgeBase,
    data: bytes,
    *,
    format: str,  # noqa: A002
    source: str = "<text>",
    dry_run: bool = False,
) -> ImportSummary:
    """Import the rules and history of a text; as `import_file`.

    Args:
        base: what is written to.
        data: the text in UTF-8.
        format: the name of a format.
        source: its name, for messages and the history.
        dry_run: only find out what would change.
    """
    chosen = format_of(source, format, "trig")
    read = CheckedStream(io.BytesIO(data), source, most=chosen.most, is_xml=chosen.is_xml)
    return _import(base, read, chosen, dry_run=dry_run)


def read_file(file: str | Path, *, format: str | None = None) -> Store:  # noqa: A002
    """Read a file into a store of its own, unchecked; `validation.findings` checks it.

    Raises:
        DataError: the file cannot be read or parsed; says where.
    """
    chosen = format_of(str(file), format, "trig")
    with _opened(file, chosen, None) as source:
        if chosen.name in RULE_FORMATS:
            return stage_rules(one.rule for one in read_rules(source, chosen))
        return _staged(read_statements(source, chosen), source.name)


def count_contents(source: CheckedStream, chosen: FileFormat) -> int:
    """Read a file to its end and return how many rules or statements it holds; keep nothing.

    Raises:
        DataError: it cannot be read or parsed; says where.
    """
    if chosen.name in RULE_FORMATS:
        return sum(1 for _ in read_rules(source, chosen))
    return sum(map(_size, read_statements(source, chosen)))


def read_rules(source: CheckedStream, chosen: FileFormat) -> Iterator[SerializedRule]:
    """The rules of a file that holds rules only."""
    serialize = RuleSerializer().serialize
    match chosen.name:
        case "csv":
            from .csv_table import read_table

            yield from read_table(source.lines(), source=source.name)
        case "graphml":
            from .graphml import read_graphml

            yield from map(serialize, read_graphml(source.everything(), source=source.name))
        case _:
            from .rule_yaml import read_sheet

            yield from map(serialize, read_sheet("".join(source.lines()), source=source.name))


def read_statements(source: CheckedStream, chosen: FileFormat) -> Iterator[Statements]:
    """The statements of an RDF file; those that name no graph are among the beliefs."""
    name = chosen.name.removesuffix("12")
    stream = cast(BinaryIO, source)
    for item in read_groups(stream, format=name, source=source.name, default=BELIEFS):
        source.report_statement()
        yield item


# Import


@contextmanager
def _opened(
    file: str | Path, chosen: FileFormat, progress: Progress | None
) -> Generator[CheckedStream]:
    with open_input(str(file), most=chosen.most, is_xml=chosen.is_xml, progress=progress) as source:
        yield source


def _import(
    base: KnowledgeBase, source: CheckedStream, chosen: FileFormat, *, dry_run: bool
) -> ImportSummary:
    """Import rules and large RDF files as they stream by; put small RDF files in order first.

    A file that a person wrote may name its rules freely, annotate edges, and have the statements
    of a rule apart. It is staged, checked by SHACL and by the laws, and merged.
    """
    name = source.name
    if chosen.name in RULE_FORMATS:
        return import_rules(base, read_rules(source, chosen), source=name, dry_run=dry_run)
    items = read_statements(source, chosen)
    first, size = list[Statements](), 0
    for item in items:
        first.append(item)
        size += _size(item)
        if size > MAX_STAGED:
            return import_statements(base, chain(first, items), source=name, dry_run=dry_run)
    staging = _staged(first, name)
    try:
        raise_findings(findings(staging))
        return merge(base, staging, source=name, dry_run=dry_run)
    finally:
        staging.close()


def _size(item: Statements) -> int:
    if isinstance(item, RuleBlock):
        return len(item.tails)
    return len(item.pairs) if isinstance(item, StatementGroup) else 1


def _staged(items: Iterable[Statements], source: str) -> Store:
    return stage(expand_annotations(_flat(items), source=source), source=source)


def _flat(items: Iterable[Statements]) -> Iterator[Quad | ReifyingTriple]:
    for item in expand_blocks(items):
        yield from item.quads() if isinstance(item, StatementGroup) else (item,)


# Export


def _counted(quads: Iterable[Quad], counter: ProgressCounter) -> Iterator[Quad]:
    for quad in quads:
        counter.add(1)
        yield quad


def _write_rules(store: Store, stream: BinaryIO, name: str, progress: Progress | None) -> int:
    if name == "graphml":
        from .graphml import write_graphml

        rules: list[Rule] = []
        count = scan_rules(store, rules.extend, progress)
        stream.write(write_graphml(rules))
        return count
    text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
    try:
        from .csv_table import TableWriter, scan_cells

        if name == "csv":
            return scan_cells(store, TableWriter(text).write, progress)
        from .rule_yaml import RuleSheetWriter

        sheet = RuleSheetWriter(text)
        count = scan_cells(store, sheet.write, progress)
        sheet.finish()
        return count
    finally:
        text.detach()
