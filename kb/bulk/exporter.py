"""Exports of any size: the statements of a store as N-Quads, N-Triples, TriG and Turtle."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import BinaryIO

from ...ontology.vocabulary import PREFIXES, Iri
from ..history import HISTORY
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import XSD, Quad, as_sparql
from ..stores.base import EmbeddedStore, Store
from .statement_scan import PAIRS, Progress, ProgressCounter, is_large, scan_graph

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

    The form is one of `TEXT_FORMATS`, in UTF-8; `progress` is called with how many statements are
    written. `rules_only` leaves out all but the rules and the utterances that they come from.

    Raises:
        OSError: the stream cannot be written to.
        StoreError: the store cannot be read.
    """
    counter, is_turtle = ProgressCounter(progress), form in {"turtle", "trig"}
    with store.writing():  # so that all of it is of one moment
        in_order = is_large(store)
        sources = {as_sparql(one) for one in _sources(store)} if rules_only else set[str]()
        for prefix, namespace in PREFIXES.items() if is_turtle else ():
            stream.write(f"@prefix {prefix}: <{namespace}> .\n".encode())
        for graph in _graphs(store, rules_only=rules_only):
            batches = scan_graph(store, graph, in_order=in_order)
            if rules_only and graph == HISTORY:
                batches = ([r for r in some if r.split("\t", 1)[0] in sources] for some in batches)
            name = as_sparql(graph) if form in {"nquads", "trig"} else ""
            write = _turtle if is_turtle else _lines
            for text in write(counter.counted(batches, len), name):
                stream.write(text.encode())
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
    if isinstance(
        store, EmbeddedStore
    ):  # it lists the graphs without going through their statements
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


def _lines(batches: Iterable[list[str]], graph: str) -> Iterator[str]:
    """N-Quads, or N-Triples where there is no graph: one statement a line."""
    end = f" {graph} .\n" if graph else " .\n"
    middles = {
        code: f" {as_sparql(key)} " + (as_sparql(value) + end if value else "")
        for code, (key, value) in PAIRS.items()
    }
    for rows in batches:
        lines: list[str] = []
        for row in rows:
            node, code, other, value = row.split("\t")
            if not value:
                lines.append(node + middles[code])
                continue
            written = value if value[0] in '<"_' else _quoted(value)
            lines.append(f"{node}{f' {other} ' if other else middles[code]}{written}{end}")
        yield "".join(lines)


def _turtle(batches: Iterable[list[str]], graph: str) -> Iterator[str]:
    """TriG, or Turtle where there is no graph: with prefixes, and each subject once."""
    middles = {
        code: ("a " if key == rule_mapping.TYPE else f"{_short(as_sparql(key))} ")
        + (_short(as_sparql(value)) if value else "")
        for code, (key, value) in PAIRS.items()
    }
    yield f"{_short(graph)} {{\n" if graph else ""
    subject = ""
    for rows in batches:
        text: list[str] = []
        for row in rows:
            node, code, other, value = row.split("\t")
            if node == subject:
                text.append(" ;\n\t")
            else:
                text.append(f"{' .' if subject else ''}\n{_name(node)} ")
                subject = node
            text.append(f"{_short(other)} " if other else middles[code])
            text.append(_value(value))
        yield "".join(text)
    yield f"{' .' if subject else ''}\n{'}' if graph else ''}\n"


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
