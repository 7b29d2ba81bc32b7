# SPDX-License-Identifier: Apache-2.0
"""Exports of any size: one pass over a store, as statements or as rules.

To look up how a term is written costs the engine more than to find its statement, and half of all
terms are a few predicates, classes and statuses. So the query returns those as codes and looks up
the rest only. For 30,000 rules that takes 4.5 s as N-Quads and 4.1 s as TriG, where the engine's
own dump takes 5.1 s and 5.4 s.

A large store on disk is written in its own order, which is the same for equal bases, and in
bounded memory. Any other store is sorted first.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Sequence
from functools import lru_cache
from typing import (
    BinaryIO,
    Generic,
    NamedTuple,
    Protocol,
    TypeAlias,
    TypeVar,
    cast,
    get_args,
    runtime_checkable,
)

from ...ontology.errors import StoreError, ValidationError
from ...ontology.garbage_collection import paused_garbage_collection
from ...ontology.vocabulary import PREFIXES, Iri, term
from ..history import ASSERTS, HISTORY
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import DECIMAL, XSD, Quad, Term, as_sparql, literal
from ..rule import GRASP_OBJECT, USED_FOR, Rule, Status
from ..stores.base import Store
from .statements import MAX_KNOWN, complete_lines

# Takes some rows, each of one statement: subject, code, predicate and object, with tabs between.
# The predicate is empty where the code stands for it, the object where the code includes it.
# Terms are written as in Turtle, numbers and booleans without quotes.
TakeRows: TypeAlias = Callable[[Sequence[str]], object]
Progress: TypeAlias = Callable[[int], None]  # is called with how many are written so far
Converted = TypeVar("Converted")  # what the rows of a rule are converted to

TEXT_FORMATS = frozenset({"nquads", "ntriples", "trig", "turtle"})
MAX_SORTED = 200_000  # statements; an export of more has the order of the store

_BUFFER = 2**18  # bytes that are split into rows at once
_STEP = 10_000  # rows or rules between two calls of the progress
_OTHER, _FIRST_CODE = 99, 10  # of two digits, so that they are sorted as text
_NAMES = {namespace: prefix for prefix, namespace in PREFIXES.items()}
# Digits may begin such a name, and nothing of it needs to be escaped.
_PLAIN = re.compile(f"<({'|'.join(map(re.escape, PREFIXES.values()))})([A-Za-z0-9_]+)>")
_RULES = f"<{PREFIXES['rule']}"
_SOURCES = f"""SELECT DISTINCT ?utterance {{
  GRAPH <{BELIEFS}> {{ ?rule <{rule_mapping.DERIVED_FROM}> ?utterance }}
}}"""


class PredicateObject(NamedTuple):
    """A predicate and, where it is one of a few, its object."""

    predicate: Iri
    object: Iri | None = None


_STATUSES = tuple(rule_mapping.status_iri(cast(Status, one)) for one in get_args(Status))
_FEW_OBJECTS = {
    rule_mapping.TYPE: (*rule_mapping.CLASSES.values(), term("Utterance")),
    rule_mapping.STATUS: _STATUSES,
    rule_mapping.FUNCTOR: (term(USED_FOR), term(GRASP_OBJECT)),
}
_MANY_OBJECTS = (
    *(rule_mapping.FEATURE, rule_mapping.CONTEXT, rule_mapping.LOWER, rule_mapping.UPPER),
    *(rule_mapping.DERIVED_FROM, rule_mapping.GENERATED_AT, rule_mapping.ATTRIBUTED_TO),
    *(rule_mapping.PART, rule_mapping.AFFORDANCE, rule_mapping.ARGUMENT),
)
_PREDICATES = (
    *(*_MANY_OBJECTS, ASSERTS, rule_mapping.RULE, rule_mapping.LABEL),
    *(rule_mapping.edge_property(USED_FOR), rule_mapping.edge_property(GRASP_OBJECT)),
    *(rule_mapping.TYPE, rule_mapping.STATUS, rule_mapping.FUNCTOR),
)
_WITH_OBJECT = [PredicateObject(key, one) for key, few in _FEW_OBJECTS.items() for one in few]
_FIRST_PREDICATE = _FIRST_CODE + len(_WITH_OBJECT)
CODES = {
    pair: number
    for number, pair in enumerate((*_WITH_OBJECT, *map(PredicateObject, _PREDICATES)), _FIRST_CODE)
}
_PAIRS = {str(number): pair for pair, number in CODES.items()}
RULE_PREDICATES = (*_MANY_OBJECTS, rule_mapping.STATUS, rule_mapping.FUNCTOR)


@runtime_checkable
class RowStore(Protocol):
    """A store that writes the rows of a query as text."""

    @property
    def is_sorted(self) -> bool:
        """Whether the statements of a graph come subject by subject."""
        ...

    def dump_rows(self, query: str, stream: BinaryIO) -> None:
        """Write the rows of a SELECT query as tab-separated values."""
        ...


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
        is_large = _is_large(store)
        sources = {as_sparql(one) for one in _sources(store)} if rules_only else set[str]()
        for graph in _graphs(store, rules_only=rules_only):
            take, is_part = writer.begin(graph), rules_only and graph == HISTORY

            def counted(
                rows: Sequence[str], take: TakeRows = take, *, is_part: bool = is_part
            ) -> None:
                some = [r for r in rows if r.split("\t", 1)[0] in sources] if is_part else rows
                take(some)
                counter.add(len(some))

            _scan(store, graph, counted, is_large=is_large)
            writer.end()
    return counter.total


def scan_rules(
    store: Store, take: Callable[[Sequence[Rule]], object], progress: Progress | None = None
) -> int:
    """Pass every rule of a store to `take`, and return their number; as `scan_converted`."""
    return scan_converted(store, _RuleReader().read, take, progress)


def scan_converted(
    store: Store,
    convert: Callable[[Sequence[str]], Converted],
    take: Callable[[Sequence[Converted]], object],
    progress: Progress | None = None,
    *,
    predicates: Collection[Iri] = RULE_PREDICATES,
) -> int:
    """Pass every rule of a store, converted, to `take`, and return the number of rules.

    Args:
        store: what is read; its rules may have any status.
        convert: converts the rows of a rule, each without the rule; see `read_row`.
        take: is called with some rules at a time.
        progress: is called with how many rules are done.
        predicates: those of the rows.

    Raises:
        OSError: `take` raised it.
        StoreError: the store cannot be read.
        ValidationError: a rule is malformed.
    """
    rules = _RuleRows(convert, take, ProgressCounter(progress))
    with store.writing(), paused_garbage_collection():
        _scan(store, BELIEFS, rules.feed, predicates=predicates, is_large=_is_large(store))
    return rules.finish()


def read_row(row: str) -> tuple[Iri, Term]:
    """Return the predicate and object of a row about a rule, which is given without the rule."""
    code, _, value = row.split("\t")
    predicate, known = _PAIRS[code]
    return predicate, known or _term(value)


def statements(store: Store, *, rules_only: bool = False) -> Iterator[Quad]:
    """The statements of an export, those about one subject together; sorted in a small store."""
    is_large = _is_large(store)
    sources = _sources(store) if rules_only else set[Iri]()
    for graph in _graphs(store, rules_only=rules_only):
        found = store.quads(None, None, None, graph)
        if rules_only and graph == HISTORY:
            found = (quad for quad in found if quad.subject in sources)
        yield from found if is_large else sorted(found, key=_order)


class ProgressCounter:
    """Counts what is written, and reports it now and then."""

    def __init__(self, progress: Progress | None) -> None:
        self.total = self._reported = 0
        self._progress = progress

    def add(self, number: int) -> None:
        """Count some more."""
        self.total += number
        if self._progress and self.total - self._reported >= _STEP:
            self._reported = self.total
            self._progress(self.total)


# Rows


def _is_large(store: Store) -> bool:
    """Whether a store has its statements subject by subject, and more than are sorted."""
    if not isinstance(store, RowStore) or not store.is_sorted:
        return False
    some = f"SELECT ?node {{ GRAPH ?graph {{ ?node ?key ?value }} }} LIMIT {MAX_SORTED + 1}"
    ((count,),) = store.select(f"SELECT (COUNT(*) AS ?count) {{ {{ {some} }} }}")
    return cast(int, count) > MAX_SORTED


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


def _scan(
    store: Store, graph: Iri, take: TakeRows, *, is_large: bool, predicates: Collection[Iri] = ()
) -> None:
    """Pass the statements of a graph to `take`, those about a subject together.

    Args:
        store: what is read.
        graph: whose statements.
        take: is called with some rows at a time.
        is_large: whether the rows are passed on as they come.
        predicates: the wanted ones, some of those with a code; all where none are given.
    """
    if is_large:
        _dump(store, graph, take, predicates)
        return
    rows: list[str] = []
    if isinstance(store, RowStore):
        _dump(store, graph, rows.extend, predicates)
    else:
        found = store.quads(None, None, None, graph)
        rows += (_row(quad) for quad in found if not predicates or quad.predicate in predicates)
    rows.sort()
    take(rows)


def _dump(store: Store, graph: Iri, take: TakeRows, predicates: Collection[Iri]) -> None:
    """Have the engine write rows, and pass them on."""
    rows = _RowStream(take)
    try:
        cast(RowStore, store).dump_rows(_query(graph, predicates), cast(BinaryIO, rows))
    except StoreError as error:
        raise (rows.failure or error) from error
    rows.pass_on()


class _RowStream:
    """The stream that the engine writes rows to.

    Attributes:
        failure: why the rows could not be passed on, where they could not.
    """

    def __init__(self, take: TakeRows) -> None:
        self.failure: OSError | None = None
        self._take, self._held, self._size = take, list[bytes](), 0
        self._rest, self._is_header = b"", True

    def write(self, chunk: bytes, /) -> int:
        self._held.append(chunk)
        self._size += len(chunk)
        if self._size > _BUFFER:
            try:
                self.pass_on()
            except OSError as error:  # of the file, not of the store
                self.failure = error
                raise
        return len(chunk)

    def flush(self) -> None:
        pass

    def pass_on(self) -> None:
        """Pass on the rows that are complete."""
        rows, self._rest = complete_lines(self._rest, b"".join(self._held))
        self._held.clear()
        self._size = 0
        if rows and self._is_header:
            self._is_header = False
            del rows[0]
        self._take(rows)


def _query(graph: Iri, predicates: Collection[Iri]) -> str:
    code = str(_OTHER)
    for key in reversed([key for key in _PREDICATES if not predicates or key in predicates]):
        inner = str(CODES[PredicateObject(key)])
        for value in _FEW_OBJECTS.get(key, ()):
            inner = f"IF(sameTerm(?end, <{value}>), {CODES[PredicateObject(key, value)]}, {inner})"
        code = f"IF(sameTerm(?key, <{key}>), {inner}, {code})"
    return f"""SELECT ?node ?code ?other ?value {{
  GRAPH <{graph}> {{ ?node ?key ?end }}
  BIND({code} AS ?code) {f"FILTER(?code < {_OTHER})" if predicates else ""}
  BIND(IF(?code = {_OTHER}, ?key, ?nothing) AS ?other)
  BIND(IF(?code < {_FIRST_PREDICATE}, ?nothing, ?end) AS ?value)
}}"""


def _row(quad: Quad) -> str:
    """The row of a statement, as the engine writes it."""
    subject, predicate, value, _ = quad
    if isinstance(value, Iri) and (code := CODES.get(PredicateObject(predicate, value))):
        return f"{as_sparql(subject)}\t{code}\t\t"
    code = CODES.get(PredicateObject(predicate), _OTHER)
    other = as_sparql(predicate) if code == _OTHER else ""
    return f"{as_sparql(subject)}\t{code}\t{other}\t{as_sparql(value)}"


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
            for code, (key, value) in _PAIRS.items()
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
            for code, (key, value) in _PAIRS.items()
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
            text.append(_name(value) if value.startswith("<") else value)
        self._stream.write("".join(text).encode())

    def end(self) -> None:
        """End a graph."""
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
def _quoted(value: str) -> str:
    """A number or boolean with quotes and its datatype."""
    if value in {"true", "false"}:
        kind = "boolean"
    elif "e" in value.lower():
        kind = "double"
    else:
        kind = "decimal" if "." in value else "integer"
    return f'"{value}"^^<{XSD}{kind}>'


# Rules


class _RuleRows(Generic[Converted]):
    """Gathers the rows of each rule, and converts them."""

    def __init__(
        self,
        convert: Callable[[Sequence[str]], Converted],
        take: Callable[[Sequence[Converted]], object],
        counter: ProgressCounter,
    ) -> None:
        self._convert, self._take, self._counter = convert, take, counter
        self._node, self._rows = "", list[str]()  # of the current rule

    def feed(self, rows: Sequence[str]) -> None:
        """Read some rows."""
        converted, node, gathered = list[Converted](), self._node, self._rows
        for row in rows:
            subject, rest = row.split("\t", 1)
            if subject != node:
                converted += self._complete(node, gathered)
                node, gathered = subject, []
            gathered.append(rest)
        self._node, self._rows = node, gathered
        self._pass_on(converted)

    def finish(self) -> int:
        """Convert the last rule, and return how many there were."""
        self._pass_on(self._complete(self._node, self._rows))
        return self._counter.total

    def _pass_on(self, converted: Sequence[Converted]) -> None:
        self._take(converted)
        self._counter.add(len(converted))

    def _complete(self, node: str, rows: Sequence[str]) -> Sequence[Converted]:
        """The converted rule, if the rows are of a rule."""
        if not node.startswith(_RULES):
            return ()
        try:
            return (self._convert(rows),)
        except ValidationError as error:
            raise ValidationError([f"{node}: {one}" for one in error.findings]) from error


class _RuleReader:
    """Reads rules from rows; a row that comes again is read once."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[Iri, Term]] = {}

    def read(self, rows: Sequence[str]) -> Rule:
        """Return the rule with some rows."""
        known = self._known
        if len(known) >= MAX_KNOWN:
            known.clear()
        for row in rows:
            if row not in known:
                known[row] = read_row(row)
        return rule_mapping.read_rule([known[row] for row in rows])


def _term(text: str) -> Term:
    """The term of a row: an IRI, a number, or a quoted literal with its datatype."""
    if text.startswith("<"):
        return Iri(text[1:-1])
    if not text.startswith('"'):
        return literal(text, DECIMAL)
    value, _, datatype = text[1:].partition('"^^<')
    return literal(value, datatype[:-1] or f"{XSD}string")
