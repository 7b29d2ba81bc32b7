"""A fast reader of N-Quads and N-Triples that groups statements by their subject.

A line that is like an earlier one but for its subject, as most lines of a large base are, is not
parsed again. Nor is one that differs from it only in the rule that it names, or in a short decimal.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from decimal import Decimal
from functools import partial
from typing import Any, BinaryIO, NamedTuple, TypeAlias

from ...ontology.vocabulary import INDIVIDUALS, PREFIXES, Iri
from ..interval import DIGITS
from ..rdf.annotated_turtle import ReifyingTriple
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import DECIMAL, Properties, Property, Quad

# What an RDF text is read into.
Statements: TypeAlias = "StatementGroup | ReifyingTriple"
_Statement: TypeAlias = "tuple[Iri, Property, Iri] | ReifyingTriple"  # the graph last

MAX_KNOWN = 2**18  # values of each kind that are remembered
MAX_GROUP = 10_000  # statements; many more rules than that may hang on one node

_RULES = PREFIXES["rule"]
_MAX_TERM = 2**24  # bytes of a line with one statement, as pyoxigraph has it
_MAX_REPEATED = 6  # characters of a decimal that is likely to come again: 0.9571
_INDIVIDUAL = rf"{re.escape(INDIVIDUALS)}[a-z]+/(?:[A-Za-z0-9_.-]|%[0-9A-F]{{2}})+"
_SUBJECT = re.compile(f"<({_INDIVIDUAL})>")
_VARIED = re.compile(  # lines that are many, and differ in an individual or a short decimal
    rf"(?P<key><[^ ]+>) (?:<(?P<node>{_INDIVIDUAL})>"
    rf'|"(?P<decimal>[01](?:\.[0-9]{{1,{DIGITS}}})?)"\^\^<{DECIMAL}>)(?P<graph> <[^ ]+>)? \.'
)


def remember(known: dict[Any, Any], key: object, value: Any) -> Any:
    """Put a value into a dictionary of bounded size, and return it."""
    if len(known) >= MAX_KNOWN:
        known.clear()
    known[key] = value
    return value


class StatementGroup(NamedTuple):
    """Consecutive statements about one subject in one graph."""

    node: Iri
    graph: Iri
    pairs: Properties


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
    """Iterate over the statements of items."""
    for item in items:
        if isinstance(item, ReifyingTriple):
            yield item
        else:
            yield from (Quad(item.node, key, value, item.graph) for key, value in item.pairs)


class LineReader:
    """Reads a text in chunks of bytes and groups the statements of its lines by their subject."""

    def __init__(self, *, format: str, source: str, default: Iri) -> None:
        """Start a text in N-Quads or N-Triples; arguments as for `read_groups`."""
        from ..stores.rdf_text import read_line

        self._line = 0
        self._parse = partial(read_line, format=format, source=source, default=default)
        self._subjects: dict[str, Iri] = {}
        # What a line says of its subject: by its text without it or, of lines like `_VARIED`, by
        # the predicate and graph.
        self._known: dict[object, tuple[Property, Iri]] = {}
        self._rest = b""
        # Of the last line: its subject, where it is written as an IRI is, and its group.
        self._node: str | None = None
        self._group = StatementGroup(Iri(""), Iri(""), [])

    @property
    def held(self) -> int:
        """Bytes of the last line, which is not complete."""
        return len(self._rest)

    def feed(self, chunk: bytes) -> Iterator[Statements]:
        """Iterate over what a chunk completes; UnicodeDecodeError if the text is no UTF-8."""
        whole, end, left = (self._rest + chunk).rpartition(b"\n")
        self._rest = left
        return self._groups(whole.decode().split("\n") if end else ())

    def finish(self) -> Iterator[Statements]:
        """End the text, and iterate over what is left."""
        yield from self.feed(b"\n")
        if self._group.pairs:
            yield self._group

    def _groups(self, lines: Sequence[str]) -> Iterator[Statements]:
        known, last, pairs, place = self._known, self._node, self._group.pairs, self._group.graph
        for line in lines:
            self._line += 1
            node, _, tail = line.partition(" ")
            found = known.get(tail) or self._varied(tail)
            if found and node == last and found[1] is place and len(pairs) < MAX_GROUP:
                pairs.append(found[0])
                continue
            about = self._subject(node) if found else None
            for one in [(about, *found)] if about and found else self._parsed(line, node, tail):
                if isinstance(one, ReifyingTriple):
                    yield one
                    continue
                about, pair, graph = one
                if self._group[:2] != (about, graph) or len(pairs) >= MAX_GROUP:
                    if pairs:
                        yield self._group
                    pairs, place = list[Property](), graph
                    self._group = StatementGroup(about, graph, pairs)
                pairs.append(pair)
            self._node = last = node if node == f"<{self._group.node}>" else None

    def _subject(self, node: str) -> Iri | None:
        individual = _SUBJECT.fullmatch(node)
        return Iri(individual[1]) if individual else self._subjects.get(node)

    def _parsed(self, line: str, node: str, tail: str) -> Iterator[_Statement]:
        found = self._parse(line, number=self._line)
        for one in found:
            if isinstance(one, ReifyingTriple):
                yield one
                continue
            subject, key, value, graph = one
            said = (key, value), graph or BELIEFS
            if len(found) == 1 and node == f"<{subject}>":
                like = _VARIED.fullmatch(tail)
                remember(self._known, like.group("key", "graph") if like else tail, said)
                remember(self._subjects, node, subject)
            yield subject, *said

    def _varied(self, tail: str) -> tuple[Property, Iri] | None:
        like = _VARIED.fullmatch(tail)
        known = like and self._known.get(like.group("key", "graph"))
        if not like or not known:
            return None
        (key, _), graph = known
        name, decimal = like.group("node", "decimal")
        found = (key, Iri(name) if name else Decimal(decimal)), graph
        is_rare = name.startswith(_RULES) if name else len(decimal) > _MAX_REPEATED
        return found if is_rare else remember(self._known, tail, found)
