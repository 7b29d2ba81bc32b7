# SPDX-License-Identifier: Apache-2.0
"""The statements of a scan as RDF text: N-Quads and N-Triples, TriG and Turtle."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from typing import BinaryIO, Protocol

from ...ontology.vocabulary import PREFIXES, Iri
from ..rdf import rule_mapping
from ..rdf.terms import XSD, as_sparql
from .scanning import TAILS, Take

_NAMES = {namespace: prefix for prefix, namespace in PREFIXES.items()}
# Digits may begin such a name, and nothing of it needs to be escaped.
_PLAIN = re.compile(f"<({'|'.join(map(re.escape, PREFIXES.values()))})([A-Za-z0-9_]+)>")
_RULES = f"<{PREFIXES['rule']}"
_TERMS = ("<", '"', "_")  # how terms begin; other values are numbers and truths without quotes


class Spelling(Protocol):
    """A way to write statements that come node by node."""

    def begin(self, graph: Iri) -> Take:
        """What comes now is in a graph; what is returned takes its lines."""
        ...

    def end(self) -> None:
        """What comes now is in another graph."""
        ...


def spelling(form: str, stream: BinaryIO) -> Spelling:
    """The way to write N-Quads, N-Triples, TriG or Turtle into a stream."""
    if form in {"nquads", "ntriples"}:
        return _Plain(stream, has_graphs=form == "nquads")
    return _Abbreviated(stream, has_graphs=form == "trig")


class _Plain:
    """One statement a line."""

    def __init__(self, stream: BinaryIO, *, has_graphs: bool) -> None:
        self._stream, self._has_graphs = stream, has_graphs

    def begin(self, graph: Iri) -> Take:
        end = f" {as_sparql(graph)} .\n" if self._has_graphs else " .\n"
        tails = {"0": ""}
        for number, (key, value) in enumerate(TAILS, 1):
            tails[str(number)] = f" {as_sparql(key)} " + (as_sparql(value) + end if value else "")

        def take(lines: Sequence[str]) -> None:
            said: list[str] = []
            for line in lines:
                node, number, other, value = line.split("\t")
                if not value:
                    said.append(node + tails[number])
                    continue
                term = value if value.startswith(_TERMS) else _in_full(value)
                key = f" {other} " if other else tails[number]
                said.append(f"{node}{key}{term}{end}")
            self._stream.write("".join(said).encode())

        return take

    def end(self) -> None:
        pass


class _Abbreviated:
    """With prefixes, and a node once."""

    def __init__(self, stream: BinaryIO, *, has_graphs: bool) -> None:
        self._stream, self._has_graphs, self._node = stream, has_graphs, ""
        self._tails = {"0": ""}
        for number, (key, value) in enumerate(TAILS, 1):
            start = "a" if key == rule_mapping.TYPE else _short(as_sparql(key))
            self._tails[str(number)] = f"{start} {_short(as_sparql(value)) if value else ''}"
        for prefix, namespace in PREFIXES.items():
            stream.write(f"@prefix {prefix}: <{namespace}> .\n".encode())

    def begin(self, graph: Iri) -> Take:
        self._node = ""
        if self._has_graphs:
            self._stream.write(f"{_short(as_sparql(graph))} {{\n".encode())
        return self._take

    def _take(self, lines: Sequence[str]) -> None:
        said: list[str] = []
        for line in lines:
            node, number, other, value = line.split("\t")
            if node == self._node:
                said.append(" ;\n\t")
            else:
                said.append(f"{' .' if self._node else ''}\n{_name(node)} ")
                self._node = node
            said.append(f"{_short(other)} " if other else self._tails[number])
            said.append(_name(value) if value.startswith("<") else value)
        self._stream.write("".join(said).encode())

    def end(self) -> None:
        last = " .\n" if self._node else ""
        self._stream.write(f"{last}{'}' if self._has_graphs else ''}\n".encode())


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
def _in_full(value: str) -> str:
    """A number or truth as other literals are written."""
    if value in {"true", "false"}:
        kind = "boolean"
    elif "e" in value.lower():
        kind = "double"
    else:
        kind = "decimal" if "." in value else "integer"
    return f'"{value}"^^<{XSD}{kind}>'
