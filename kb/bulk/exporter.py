# SPDX-License-Identifier: Apache-2.0
"""Exports of any size: the statements of a store as N-Quads, N-Triples, TriG and Turtle."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import BinaryIO

from ...ontology.vocabulary import PREFIXES, Iri
from ..history import HISTORY
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import XSD, Quad, as_sparql
from ..stores.base import Store
from .statement_scan import (
    PAIRS,
    Progress,
    ProgressCounter,
    RowStore,
    TakeRows,
    is_large,
    scan_graph,
)

TEXT_FORMATS = frozenset({"nquads", "ntriples", "trig", "turtle"})

_NAMES = {namespace: prefix for prefix, namespace in PREFIXES.items()}
# Digits may begin such a name, and nothing of it needs to be escaped.
_PLAIN = re.compile(f"<({'|'.join(map(re.escape, PREFIXES.values()))})([A-Za-z0-9_]+)>")
_RULES = f"<{PREFIXES['rule']}"
_SOURCES = f"""SELECT DISTINCT ?utterance {{
  GRAPH <{BELIEFS}> {{ ?rule <{rule_mapping.DERIVED_FROM}> ?utterance }}
}}"""


def write_statements(
    store: Store, stream: BinaryIO, form: str, progress: Progress | None, *, rules_only: bool
) -> int:
    """Write a base, or all that belongs to its rules, and return the number of statements.

    Args:
        store: what is written.
        stream: takes the text in UTF-8.
        form: one of `TEXT_FORMATS`.
        progress: is called with how many statements are written.
        rules_only: leave out all but the rules and the utterances that they come from.

    Raises:
        OSError: the stream cannot be written to.
        StoreError: the store cannot be read.
    """
    counter = ProgressCounter(progress)
    writer = (
        _TurtleWriter(stream, form) if form in {"turtle", "trig"} else _LineWriter(stream, form)
    )
    with store.writing():  # so that all of it is of one moment
        in_order = is_large(store)
        sources = {as_sparql(one) for one in _sources(store)} if rules_only else set[str]()
        for graph in _graphs(store, rules_only=rules_only):
            take, is_part = writer.begin(graph), rules_only and graph == HISTORY

            def counted(
                rows: Sequence[str], take: TakeRows = take, *, is_part: bool = is_part
            ) -> None:
                some = [r for r in rows if r.split("\t", 1)[0] in sources] if is_part else rows
                take(some)
                counter.add(len(some))

            scan_graph(store, graph, counted, in_order=in_order)
            writer.end()
    return counter.total


def statements(store: Store, *, rules_only: bool = False) -> Iterator[Quad]:
    """The statements of an export, those about one subject together; sorted in a small store."""
    in_order = is_large(store)
    sources = _sources(store) if rules_only else set[Iri]()
    for graph in _graphs(store, rules_only=rules_only):
        found = store.quads(None, None, None, graph)
        if rules_only and graph == HISTORY:
            found = (quad for quad in found if quad.subject in sources)
        yield from found if in_order else sorted(found, key=_order)


def _graphs(store: Store, *, rules_only: bool) -> list[Iri]:
    """The graphs of an export, in alphabetical order."""
    if rules_only:
        return [BELIEFS, HISTORY]
    some = "GRAPH ?graph { ?node ?key ?value }"
    if isinstance(store, RowStore):  # it lists the graphs without going through their statements
        some = f"GRAPH ?graph {{}} FILTER EXISTS {{ {some} }}"
    rows = store.select(f"SELECT DISTINCT ?graph {{ {some} }}")
    return sorted(graph for (graph,) in rows if isinstance(graph, Iri))


def _sources(store: Store) -> set[Iri]:
    """The utterances that rules come from."""
    return {node for (node,) in store.select(_SOURCES) if isinstance(node, Iri)}


def _order(quad: Quad) -> tuple[str, bool, str, str]:
    """Subject by subject, the class of each first."""
    subject, predicate, value, _ = quad
    return str(subject), predicate != rule_mapping.TYPE, str(predicate), as_sparql(value)


# Text


class _LineWriter:
    """Writes N-Quads and N-Triples: one statement a line."""

    def __init__(self, stream: BinaryIO, form: str) -> None:
        self._stream, self._has_graphs = stream, form == "nquads"

    def begin(self, graph: Iri) -> TakeRows:
        """Begin a graph; what is returned takes its rows."""
        end = f" {as_sparql(graph)} .\n" if self._has_graphs else " .\n"
        middles = {
            code: f" {as_sparql(key)} " + (as_sparql(value) + end if value else "")
            for code, (key, value) in PAIRS.items()
        }

        def take(rows: Sequence[str]) -> None:
            lines: list[str] = []
            for row in rows:
                node, code, other, value = row.split("\t")
                if not value:
                    lines.append(node + middles[code])
                    continue
                written = value if value[0] in '<"_' else _quoted(value)
                lines.append(f"{node}{f' {other} ' if other else middles[code]}{written}{end}")
            self._stream.write("".join(lines).encode())

        return take

    def end(self) -> None:
        """End a graph."""


class _TurtleWriter:
    """Writes Turtle and TriG: with prefixes, and each subject once."""

    def __init__(self, stream: BinaryIO, form: str) -> None:
        self._stream, self._has_graphs, self._node = stream, form == "trig", ""
        self._middles = {
            code: ("a " if key == rule_mapping.TYPE else f"{_short(as_sparql(key))} ")
            + (_short(as_sparql(value)) if value else "")
            for code, (key, value) in PAIRS.items()
        }
        for prefix, namespace in PREFIXES.items():
            stream.write(f"@prefix {prefix}: <{namespace}> .\n".encode())

    def begin(self, graph: Iri) -> TakeRows:
        """Begin a graph; what is returned takes its rows."""
        self._node = ""
        if self._has_graphs:
            self._stream.write(f"{_short(as_sparql(graph))} {{\n".encode())
        return self._take

    def _take(self, rows: Sequence[str]) -> None:
        text: list[str] = []
        for row in rows:
            node, code, other, value = row.split("\t")
            if node == self._node:
                text.append(" ;\n\t")
            else:
                text.append(f"{' .' if self._node else ''}\n{_name(node)} ")
                self._node = node
            text.append(f"{_short(other)} " if other else self._middles[code])
            text.append(_value(value))
        self._stream.write("".join(text).encode())

    def end(self) -> None:
        """End a graph."""
        last = " .\n" if self._node else ""
        self._stream.write(f"{last}{'}' if self._has_graphs else ''}\n".encode())


def _value(value: str) -> str:
    """An object, with the prefix of its IRI or datatype."""
    if value.startswith("<"):
        return _name(value)
    if not value.endswith(">"):
        return value
    quoted, _, datatype = value.rpartition("^^")
    return f"{quoted}^^{_short(datatype)}"


def _name(node: str) -> str:
    """An IRI with its prefix; rules are many and do not come again, so they are not remembered."""
    if node.startswith(_RULES):
        local = node[len(_RULES) : -1]
        return f"rule:{local}" if local.isalnum() and local.isascii() else node
    return _short(node)


@lru_cache(maxsize=2**16)
def _short(node: str) -> str:
    """An IRI with its prefix, where that needs no escapes."""
    match = _PLAIN.fullmatch(node)
    return f"{_NAMES[match[1]]}:{match[2]}" if match else node


@lru_cache(maxsize=2**16)
def _quoted(value: str) -> str:
    """A number or boolean with quotes and its datatype."""
    if value in {"true", "false"}:
        kind = "boolean"
    elif "e" in value.lower():
        kind = "double"
    else:
        kind = "decimal" if "." in value else "integer"
    return f'"{value}"^^<{XSD}{kind}>'
