# SPDX-License-Identifier: Apache-2.0
"""A fast reader of N-Quads and N-Triples that groups statements by their subject.

A line in the plain form that exports have, all of whose terms came before, is split as text; any
other line goes to a parser, and the terms that it found are remembered. The lines about a rule are
passed on unread, because an import can copy most of them (`hilt.kb.bulk.rule_nquads`).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from decimal import Decimal
from typing import BinaryIO, NamedTuple, TypeAlias, TypeVar

from ...ontology.vocabulary import PREFIXES, Iri
from ..rdf import rule_mapping
from ..rdf.annotated_turtle import ReifyingTriple
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import DECIMAL, Quad, Term

# Reads the statements of one line, of which there may be none.
Parse: TypeAlias = "Callable[[str], Sequence[Quad | ReifyingTriple]]"
T = TypeVar("T", bound="Term")

_MAX_TERM = 2**24  # bytes of a line with one statement, as pyoxigraph has it
MAX_KNOWN = 200_000  # terms that are remembered
_MAX_REPEATED = 4  # characters of a bound that is likely to come again: 0.95
MAX_GROUP = 10_000  # statements; many more rules than that may hang on one node
_RULE = re.compile(f"<({re.escape(PREFIXES['rule'])}[0-9a-f]{{16}})>")
_TO_RULE = re.compile(rf"(<[^ ]+>) {_RULE.pattern}(?: (<[^ ]+>))? \.")
_NUMBER = re.compile(rf'"([0-9]{{1,9}}(?:\.[0-9]{{1,9}})?)"\^\^<{re.escape(DECIMAL)}>', re.ASCII)
# Dictionaries find identical objects without comparing them.
_PREDICATES = (
    *(rule_mapping.TYPE, rule_mapping.LABEL, rule_mapping.FEATURE, rule_mapping.CONTEXT),
    *(rule_mapping.FUNCTOR, rule_mapping.PART, rule_mapping.AFFORDANCE, rule_mapping.ARGUMENT),
    *(rule_mapping.LOWER, rule_mapping.UPPER, rule_mapping.STATUS, rule_mapping.ATTRIBUTED_TO),
    *(rule_mapping.DERIVED_FROM, rule_mapping.GENERATED_AT, rule_mapping.RULE),
)


class StatementGroup(NamedTuple):
    """Consecutive statements about one subject in one graph."""

    node: Iri
    graph: Iri
    pairs: list[tuple[Iri, Term]]

    def quads(self) -> Iterator[Quad]:
        """Iterate over the statements."""
        node, graph, pairs = self
        return (Quad(node, key, value, graph) for key, value in pairs)


class RuleBlock(NamedTuple):
    """Consecutive lines about one rule, unread.

    Attributes:
        node: the rule.
        tails: the lines without their subject.
        line: 1-based number of the first line.
        reader: reads the lines when they are needed.
    """

    node: Iri
    tails: Sequence[str]
    line: int
    reader: LineReader

    def groups(self) -> Iterator[StatementGroup | ReifyingTriple]:
        """Read the lines."""
        return self.reader.read_block(f"<{self.node}>", self.tails, self.line)

    def pair(self, tail: str) -> tuple[tuple[Iri, Term], Iri]:
        """Return predicate and object, and the graph, of one line.

        Raises:
            DataError: the line is malformed.
            KeyError, ValueError: the line is not in plain form.
        """
        return self.reader.pair(f"<{self.node}>", tail)


def read_groups(
    stream: BinaryIO,
    *,
    format: str,  # noqa: A002
    source: str,
    default: Iri,
) -> Iterator[StatementGroup | RuleBlock | ReifyingTriple]:
    """Iterate over the statements of an RDF text, those about one subject together.

    Args:
        stream: the text in UTF-8.
        format: one of `hilt.kb.stores.rdf_text.RDF_FORMATS`.
        source: its name in messages.
        default: the graph of statements without one.

    Raises:
        DataError: the text is malformed; says where.
    """
    from ..stores.errors import translated_text_errors
    from ..stores.rdf_text import line_format, read_lines  # pyoxigraph, only when it is needed

    with translated_text_errors(source):
        reader = line_reader(line_format(format), source=source, default=default)
        for chunk in read_lines(stream, format=format, source=source):
            yield from reader.feed(chunk)
            if reader.held > _MAX_TERM:
                raise MemoryError
        yield from reader.finish()


def line_reader(format: str, *, source: str, default: Iri) -> LineReader:  # noqa: A002
    """Return a reader of N-Quads or N-Triples; arguments and errors as for `read_groups`."""
    from ..stores.rdf_text import has_graphs, read_line

    def parse(line: str) -> list[Quad | ReifyingTriple]:
        return read_line(line, format=format, source=source, default=default, number=reader.line)

    reader = LineReader(parse, default=default, has_graphs=has_graphs(format))
    return reader


def expand_blocks(
    items: Iterable[StatementGroup | RuleBlock | ReifyingTriple],
) -> Iterator[StatementGroup | ReifyingTriple]:
    """Iterate over the same items, with every block of lines read."""
    for item in items:
        if isinstance(item, RuleBlock):
            yield from item.groups()
        else:
            yield item


def complete_lines(rest: bytes, chunk: bytes) -> tuple[list[str], bytes]:
    """Return the lines that a chunk of a text completes, and the beginning of the next line.

    Args:
        rest: the beginning of a line, from the chunks before.
        chunk: what comes after it.

    Raises:
        UnicodeDecodeError: the text is no UTF-8.
    """
    whole, end, left = chunk.rpartition(b"\n")
    if not end:
        return [], rest + chunk
    return (rest + whole).decode().split("\n"), left


def _is_complete(group: StatementGroup, subject: Iri, graph: Iri | None) -> bool:
    is_full = len(group.pairs) >= MAX_GROUP
    return is_full or group.node != subject or group.graph != (graph or BELIEFS)


class LineReader:
    """Reads a text in chunks of bytes and groups the statements of its lines by their subject.

    Attributes:
        line: 1-based number of the current line.
    """

    def __init__(self, parse: Parse, *, default: Iri, has_graphs: bool) -> None:
        """Start a text.

        Args:
            parse: reads a line that is not plain; statements without a graph are in `default`.
            default: the graph of statements without one.
            has_graphs: whether the lines name graphs (N-Quads); N-Triples do not.
        """
        self.line = 0
        self._parse, self._has_graphs = parse, has_graphs
        self._nodes = _Nodes({f"<{one}>": one for one in (*_PREDICATES, default)})
        self._values = _Values()
        self._tails = _Tails(self._nodes, self._values, None if has_graphs else default)
        self._rest = b""
        self._node, self._lines = "", list[str]()  # of the current subject
        self._group: StatementGroup | None = None

    @property
    def held(self) -> int:
        """Bytes of the last line, which is not complete."""
        return len(self._rest)

    def feed(self, chunk: bytes) -> Iterator[StatementGroup | RuleBlock | ReifyingTriple]:
        """Read a chunk, and iterate over what it completes.

        Raises:
            UnicodeDecodeError: the text is no UTF-8.
        """
        lines, self._rest = complete_lines(self._rest, chunk)
        return self._read(lines)

    def finish(self) -> Iterator[StatementGroup | RuleBlock | ReifyingTriple]:
        """End the text, and iterate over what is left."""
        yield from self.feed(b"\n")
        yield from self._block(self._node, self._lines, self.line - len(self._lines))

    def pair(self, node: str, tail: str) -> tuple[tuple[Iri, Term], Iri]:
        """As `RuleBlock.pair`."""
        try:
            return self._tails[tail]
        except KeyError:
            line = f"{node} {tail}"
            for one in self._parse(line):
                if isinstance(one, Quad):
                    self._remember(line, one)
        return self._tails[tail]

    def read_block(
        self, node: str, tails: Sequence[str], line: int
    ) -> Iterator[StatementGroup | ReifyingTriple]:
        """Read lines about a node, given the number of the first."""
        last, self.line = self.line, line - 1
        known, place, pairs = self._tails, None, list[tuple[Iri, Term]]()
        for tail in tails:
            self.line += 1
            try:
                pair, graph = known[tail]
                if graph is not place:
                    if graph != place:
                        subject = self._nodes[node]
                        yield from self._close_group()
                        self._group = StatementGroup(subject, graph, [])
                        pairs = self._group.pairs
                    place = graph
                pairs.append(pair)
            except (KeyError, ValueError):
                yield from self._parse_line(f"{node} {tail}")
                group = self._group
                is_same = group is not None and node == f"<{group.node}>"
                place, pairs = (group.graph, group.pairs) if group and is_same else (None, [])
        yield from self._close_group()
        self.line = last

    def _close_group(self) -> Iterator[StatementGroup]:
        """The current group, if there is one."""
        if self._group is not None:
            yield self._group
        self._group = None

    def _read(self, lines: Sequence[str]) -> Iterator[StatementGroup | RuleBlock | ReifyingTriple]:
        node, tails = self._node, self._lines
        for line in lines:
            self.line += 1
            subject, _, tail = line.partition(" ")
            if subject == node and len(tails) < MAX_GROUP:
                tails.append(tail)
                continue
            yield from self._block(node, tails, self.line - len(tails))
            self._node, self._lines = node, tails = subject, [tail]

    def _block(
        self, node: str, tails: Sequence[str], line: int
    ) -> Iterator[StatementGroup | RuleBlock | ReifyingTriple]:
        if rule := _RULE.fullmatch(node):
            yield RuleBlock(Iri(rule[1]), tails, line, self)
        elif tails:
            yield from self.read_block(node, tails, line)

    def _parse_line(self, line: str) -> Iterator[StatementGroup | ReifyingTriple]:
        """Parse a line that is not plain, and remember how its terms are written."""
        found = self._parse(line)
        if len(found) == 1 and isinstance(found[0], Quad):
            self._remember(line, found[0])
        for one in found:
            if isinstance(one, ReifyingTriple):
                yield one
                continue
            if self._group is None or _is_complete(self._group, one.subject, one.graph):
                yield from self._close_group()
                self._group = StatementGroup(one.subject, one.graph or BELIEFS, [])
            self._group.pairs.append((one.predicate, one.object))

    def _remember(self, line: str, quad: Quad) -> None:
        subject, key, value, graph = quad
        start, end = f"<{subject}> <{key}> ", f" <{graph}> ." if self._has_graphs else " ."
        text = line[len(start) : -len(end)]
        is_plain = line == f"{start}{text}{end}" and text == text.strip()
        if is_plain and (not isinstance(value, Iri) or text == f"<{value}>"):
            for node in (subject, key, graph or BELIEFS):
                self._nodes.add(f"<{node}>", node)
            self._values.add(text, value)


class _Known(dict[str, T]):
    """Terms by their text."""

    def add(self, text: str, term: T) -> T:
        """Remember a term."""
        if len(self) > MAX_KNOWN:
            self.clear()
        self[text] = term
        return term


class _Tails(dict[str, tuple[tuple[Iri, Term], Iri]]):
    """Predicate and object, and the graph, by the text of a line without its subject.

    Most lines of a large base differ in their subject only.
    """

    def __init__(self, nodes: _Nodes, values: _Values, graph: Iri | None) -> None:
        super().__init__()
        self._nodes, self._values, self._graph = nodes, values, graph

    def __missing__(self, text: str) -> tuple[tuple[Iri, Term], Iri]:
        if rule := _TO_RULE.fullmatch(text):  # they are many, and do not come again
            return (self._nodes[rule[1]], Iri(rule[2])), self._graph_of(rule[3])
        key, rest = text.split(" ", 1)
        value, graph = self._split(rest)
        found = (self._nodes[key], self._values[value]), graph
        if value in self._values:  # others hardly come again
            if len(self) > MAX_KNOWN:
                self.clear()
            self[text] = found
        return found

    def _graph_of(self, text: str | None) -> Iri:
        """The graph of a line, given its text."""
        if (text is None) != (self._graph is not None):
            raise ValueError(text)
        return self._graph or self._nodes[text or ""]

    def _split(self, text: str) -> tuple[str, Iri]:
        """The object and the graph of the end of a line."""
        if self._graph is None:
            value, graph, end = text.rsplit(" ", 2)
            place = self._nodes[graph]
        else:
            value, end = text.rsplit(" ", 1)
            place = self._graph
        if end != ".":
            raise ValueError(text)
        return value, place


class _Nodes(_Known[Iri]):
    """IRIs by their text; those of rules are not remembered."""

    def __missing__(self, text: str) -> Iri:
        found = _RULE.fullmatch(text)
        if found is None:
            raise KeyError(text)
        return Iri(found[1])


class _Values(_Known["Term"]):
    """Objects by their text; rules and bounds with many digits are not remembered."""

    def __missing__(self, text: str) -> Term:
        if number := _NUMBER.fullmatch(text):
            value = Decimal(number[1])
            # Bounds with more digits are computed, and hardly come again.
            return self.add(text, value) if len(number[1]) <= _MAX_REPEATED else value
        if rule := _RULE.fullmatch(text):
            return Iri(rule[1])
        raise KeyError(text)
