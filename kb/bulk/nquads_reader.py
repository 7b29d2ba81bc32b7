"""A fast reader of N-Quads and N-Triples that groups statements by their subject.

A line that is like an earlier one but for its subject, as most lines of a large base are, is not
parsed again. The lines about a rule are passed on unread, because an import can copy most of them
(`hilt.kb.bulk.rule_nquads`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from typing import Any, BinaryIO, NamedTuple, TypeAlias

from ...ontology.vocabulary import PREFIXES, Iri
from ..rdf.annotated_turtle import ReifyingTriple
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import Properties, Quad

# What an RDF text is read into.
Statements: TypeAlias = "StatementGroup | RuleBlock | ReifyingTriple"

MAX_KNOWN = 100_000  # values of each kind that are remembered
MAX_GROUP = 10_000  # statements; many more rules than that may hang on one node

_MAX_TERM = 2**24  # bytes of a line with one statement, as pyoxigraph has it
_RULE = re.compile(f"<({re.escape(PREFIXES['rule'])}[0-9a-f]{{16}})>")
_TO_RULE = re.compile(rf"(<[^ ]+>) {_RULE.pattern}( <[^ ]+>)? \.")


def remember(known: dict[Any, Any], key: object, value: Any) -> Any:
    """Put a value into a dictionary of bounded size, and return it."""
    make_room(known)
    known[key] = value
    return value


def make_room(known: dict[Any, Any] | set[Any]) -> None:
    """Empty a dictionary or set that has become too large."""
    if len(known) >= MAX_KNOWN:
        known.clear()


class StatementGroup(NamedTuple):
    """Consecutive statements about one subject in one graph."""

    node: Iri
    graph: Iri
    pairs: Properties

    def quads(self) -> Iterator[Quad]:
        """Iterate over the statements."""
        node, graph, pairs = self
        return (Quad(node, key, value, graph) for key, value in pairs)


class RuleBlock(NamedTuple):
    """Consecutive lines about one rule, unread.

    The lines are without their subject; `line` is the 1-based number of the first one.
    """

    node: Iri
    tails: Sequence[str]
    line: int
    reader: LineReader

    def groups(self) -> Iterator[StatementGroup | ReifyingTriple]:
        """Read the lines."""
        return self.reader.read_block(f"<{self.node}>", self.tails, self.line, self.node)

    def quad(self, tail: str) -> Quad:
        """Return the only statement of a line; DataError or ValueError if it has none."""
        (quad,) = self.reader.statements(f"<{self.node}>", tail, self.node)
        if not isinstance(quad, Quad):
            raise ValueError(tail)
        return quad


def read_groups(
    stream: BinaryIO, *, format: str, source: str, default: Iri
) -> Iterator[Statements]:
    """Iterate over the statements of an RDF text, those about one subject together.

    The text is UTF-8 in one of `rdf_text.RDF_FORMATS`; statements without a graph are of `default`.
    DataError if the text is malformed; says where.
    """
    from ..stores.errors import translated_text_errors
    from ..stores.rdf_text import line_format, read_lines  # pyoxigraph, only when it is needed

    with translated_text_errors(source):
        reader = LineReader(format=line_format(format), source=source, default=default)
        for chunk in read_lines(stream, format=format, source=source):
            yield from reader.feed(chunk)
            if reader.held > _MAX_TERM:
                raise MemoryError
        yield from reader.finish()


def read_quads(items: Iterable[Statements]) -> Iterator[Quad | ReifyingTriple]:
    """Iterate over the statements of items, with every block of lines read."""
    for item in items:
        for one in item.groups() if isinstance(item, RuleBlock) else [item]:
            yield from one.quads() if isinstance(one, StatementGroup) else (one,)


class LineReader:
    """Reads a text in chunks of bytes and groups the statements of its lines by their subject."""

    def __init__(self, *, format: str, source: str, default: Iri) -> None:
        """Start a text in N-Quads or N-Triples; arguments as for `read_groups`."""
        from ..stores.rdf_text import read_line

        self.line = 0
        self._parse = partial(read_line, format=format, source=source, default=default)
        self._subjects: dict[str, Iri] = {}
        self._quads: dict[str, Quad] = {}  # by the text of a line without its subject
        self._rest = b""
        self._node, self._lines = "", list[str]()  # of the current subject

    @property
    def held(self) -> int:
        """Bytes of the last line, which is not complete."""
        return len(self._rest)

    def feed(self, chunk: bytes) -> Iterator[Statements]:
        """Iterate over what a chunk completes; UnicodeDecodeError if the text is no UTF-8."""
        whole, end, left = (self._rest + chunk).rpartition(b"\n")
        self._rest = left
        return self._blocks(whole.decode().split("\n") if end else ())

    def finish(self) -> Iterator[Statements]:
        """End the text, and iterate over what is left."""
        yield from self.feed(b"\n")
        yield from self._block(self._node, self._lines, self.line - len(self._lines))

    def statements(
        self, node: str, tail: str, subject: Iri | None
    ) -> Sequence[Quad | ReifyingTriple]:
        """Return the statements of a line, given its subject as it is written and the rest of it.

        `subject` is the IRI that is written there, where that is known.
        """
        link = _TO_RULE.fullmatch(tail)
        key = f"{link[1]}{link[3]}" if link else tail  # rules are many, and do not come again
        known, subject = self._quads.get(key), subject or self._subjects.get(node)
        if known and subject:
            value = Iri(link[2]) if link else known.object
            return (Quad(subject, known.predicate, value, known.graph),)
        found = self._parse(f"{node} {tail}", number=self.line)
        if len(found) == 1 and isinstance(found[0], Quad) and node == f"<{found[0].subject}>":
            remember(self._quads, key, found[0])
            if not subject:
                remember(self._subjects, node, found[0].subject)
        return found

    def read_block(
        self, node: str, tails: Sequence[str], line: int, subject: Iri | None = None
    ) -> Iterator[StatementGroup | ReifyingTriple]:
        """Read lines about a node, given the number of the first; otherwise as `statements`."""
        last, self.line = self.line, line - 1
        group: StatementGroup | None = None
        for tail in tails:
            self.line += 1
            for one in self.statements(node, tail, subject):
                if isinstance(one, ReifyingTriple):
                    yield one
                    continue
                about, key, value, graph = one
                if not group or len(group.pairs) >= MAX_GROUP or group[:2] != (about, graph):
                    if group:
                        yield group
                    group = StatementGroup(about, graph or BELIEFS, [])
                group.pairs.append((key, value))
        if group:
            yield group
        self.line = last

    def _blocks(self, lines: Sequence[str]) -> Iterator[Statements]:
        node, tails = self._node, self._lines
        for line in lines:
            self.line += 1
            subject, _, tail = line.partition(" ")
            if subject == node and len(tails) < MAX_GROUP:
                tails.append(tail)
                continue
            yield from self._block(node, tails, self.line - len(tails))
            self._node, self._lines = node, tails = subject, [tail]

    def _block(self, node: str, tails: Sequence[str], line: int) -> Iterator[Statements]:
        if rule := _RULE.fullmatch(node):
            yield RuleBlock(Iri(rule[1]), tails, line, self)
        elif tails:
            yield from self.read_block(node, tails, line)
