# SPDX-License-Identifier: Apache-2.0
"""Statements read node by node, and fast from the lines of N-Quads and N-Triples.

A line in the plain form that exports have, all of whose terms came before, is taken apart as text;
any other line is given to a parser, and what it made of the terms is remembered.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from decimal import Decimal
from typing import NamedTuple, TypeAlias, TypeVar

from ..ontology.vocabulary import PREFIXES, Iri
from . import stars
from .annotated import Reified
from .stars import BELIEFS
from .terms import DECIMAL, Quad, Term
from .texts import whole_lines

# Reads the statements of one line, of which there may be none.
Parse: TypeAlias = "Callable[[str], Sequence[Quad | Reified]]"
T = TypeVar("T", bound="Term")

MAX_KNOWN = 200_000  # terms that are remembered
_MAX_TOLD = 4  # characters of a bound as people say it: 0.95
MAX_GROUP = 10_000  # statements; many more rules than that may hang on one node
_RULE = re.compile(f"<({re.escape(PREFIXES['rule'])}[0-9a-f]{{16}})>")
_NUMBER = re.compile(rf'"([0-9]{{1,9}}(?:\.[0-9]{{1,9}})?)"\^\^<{re.escape(DECIMAL)}>', re.ASCII)
# As the same objects, they are found in dictionaries without being compared.
_KEYS = (
    *(stars.TYPE, stars.LABEL, stars.FEATURE, stars.CONTEXT, stars.FUNCTOR, stars.PART),
    *(stars.AFFORDANCE, stars.ARGUMENT, stars.LOWER, stars.UPPER, stars.STATUS),
    *(stars.ATTRIBUTED_TO, stars.DERIVED_FROM, stars.GENERATED_AT, stars.RULE),
)


class Group(NamedTuple):
    """Statements about one node in one graph that stand together."""

    node: Iri
    graph: Iri
    pairs: list[tuple[Iri, Term]]

    def quads(self) -> Iterator[Quad]:
        """They one by one."""
        node, graph, pairs = self
        return (Quad(node, key, value, graph) for key, value in pairs)


def grouped(statements: Iterable[Quad | Reified]) -> Iterator[Group | Reified]:
    """Statements by their node, as far as those of one node stand together."""
    group = None
    for one in statements:
        if isinstance(one, Reified):
            yield one
            continue
        subject, key, value, graph = one
        if group is None or _is_over(group, subject, graph):
            if group is not None:
                yield group
            group = Group(subject, graph or BELIEFS, [])
        group.pairs.append((key, value))
    if group is not None:
        yield group


def _is_over(group: Group, subject: Iri, graph: Iri | None) -> bool:
    is_full = len(group.pairs) >= MAX_GROUP
    return is_full or group.node != subject or group.graph != (graph or BELIEFS)


class Reader:
    """Takes a text in chunks of bytes and gives the statements of its lines, node by node.

    Attributes:
        line: 1-based number of the line that is read.
    """

    def __init__(self, parse: Parse, *, default: Iri, has_graphs: bool) -> None:
        """Begin a text.

        Args:
            parse: reads a line that is not plain; statements that name no graph are in `default`.
            default: the graph of statements that name none.
            has_graphs: whether the lines name graphs (N-Quads); N-Triples do not.
        """
        self.line = 0
        self._parse, self._has_graphs = parse, has_graphs
        self._nodes = _Nodes({f"<{one}>": one for one in (*_KEYS, default)})
        self._values = _Values()
        self._tails = _Tails(self._nodes, self._values, None if has_graphs else default)
        self._rest = b""
        self._at: tuple[str, Iri | None] = ("", None)  # node, as it is written, and graph at hand
        self._group: Group | None = None

    @property
    def held(self) -> int:
        """How many bytes of a line are there that is not complete."""
        return len(self._rest)

    def feed(self, chunk: bytes) -> Iterator[Group | Reified]:
        """The groups that are complete with this chunk.

        Raises:
            UnicodeDecodeError: it is no UTF-8.
        """
        lines, self._rest = whole_lines(self._rest, chunk)
        yield from self._read(lines)

    def finish(self) -> Iterator[Group | Reified]:
        """What is left at the end."""
        yield from self.feed(b"\n")
        if self._group is not None:
            yield self._group
        self._group = None

    def _read(self, lines: Sequence[str]) -> Iterator[Group | Reified]:
        tails, nodes = self._tails, self._nodes
        pairs = self._group.pairs if self._group else []
        node, place = self._at
        for line in lines:
            self.line += 1
            try:
                subject, tail = line.split(" ", 1)
                pair, graph = tails[tail]
                is_same = subject == node and (graph is place or graph == place)
                if is_same and len(pairs) < MAX_GROUP:
                    pairs.append(pair)
                    continue
                group = Group(nodes[subject], graph, [pair])
            except (KeyError, ValueError):
                yield from self._learnt(line)
                pairs = self._group.pairs if self._group else []
                node, place = self._at
                continue
            if self._group is not None:
                yield self._group
            node, place = self._at = subject, graph
            self._group, pairs = group, group.pairs

    def _learnt(self, line: str) -> Iterator[Group | Reified]:
        """What a line says that is not plain; how its terms are written is remembered."""
        found = self._parse(line)
        if len(found) == 1 and isinstance(found[0], Quad):
            self._remember(line, found[0])
        for one in found:
            if isinstance(one, Reified):
                yield one
                continue
            if self._group is None or _is_over(self._group, one.subject, one.graph):
                if self._group is not None:
                    yield self._group
                graph = self._nodes.get(f"<{one.graph}>") or one.graph or BELIEFS
                self._at = f"<{one.subject}>", graph
                self._group = Group(one.subject, graph, [])
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
    """Terms by how they are written."""

    def add(self, text: str, term: T) -> T:
        """Remember one."""
        if len(self) > MAX_KNOWN:
            self.clear()
        self[text] = term
        return term


class _Tails(dict[str, tuple[tuple[Iri, Term], Iri]]):
    """What follows the subject of a line: property and object, and the graph.

    Most lines of a large base differ from others in their subject alone, so their rest is found
    at once.
    """

    def __init__(self, nodes: _Nodes, values: _Values, graph: Iri | None) -> None:
        super().__init__()
        self._nodes, self._values, self._graph = nodes, values, graph

    def __missing__(self, text: str) -> tuple[tuple[Iri, Term], Iri]:
        key, rest = text.split(" ", 1)
        value, graph = self._ended(rest)
        found = (self._nodes[key], self._values[value]), graph
        if value in self._values:  # others hardly come again
            if len(self) > MAX_KNOWN:
                self.clear()
            self[text] = found
        return found

    def _ended(self, text: str) -> tuple[str, Iri]:
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
    """IRIs; those of rules are read as they come."""

    def __missing__(self, text: str) -> Iri:
        found = _RULE.fullmatch(text)
        if found is None:
            raise KeyError(text)
        return Iri(found[1])


class _Values(_Known["Term"]):
    """Objects of statements; bounds and rules are read as they come."""

    def __missing__(self, text: str) -> Term:
        if number := _NUMBER.fullmatch(text):
            value = Decimal(number[1])
            # Nobody says more digits; what is computed hardly comes again.
            return self.add(text, value) if len(number[1]) <= _MAX_TOLD else value
        if rule := _RULE.fullmatch(text):
            return Iri(rule[1])
        raise KeyError(text)
