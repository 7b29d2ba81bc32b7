"""RDF terms and statements as plain Python values, independent of any engine.

An IRI is an `Iri`. A literal is the Python value it stands for (`str`, `bool`, `int`, `float`,
`Decimal`, an aware `datetime`); one that has no such value, or a language, is a `Literal`. Blank
nodes do not occur in a base; in the results of a query they are IRIs that start with `_:`.

Literals are compared by value: engines write the decimal 1.0 as 1, and 1.50 as 1.5.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from decimal import Decimal, InvalidOperation
from typing import Any, NamedTuple, TypeAlias

from ...ontology.vocabulary import PREFIXES, Iri, iri

XSD = PREFIXES["xsd"]
LANGUAGE_TEXT = PREFIXES["rdf"] + "langString"
STRING = XSD + "string"
DECIMAL = XSD + "decimal"
DATE_TIME = XSD + "dateTime"
BASE_NODE, BASE_GRAPH = Iri("https://w3id.org/hilt/base"), iri("graph", "base")
BLANK = "_:"  # what the name of a blank node begins with

_TIME = re.compile(r"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d)(?:\.(\d{1,6})\d*)?(Z|[+-]\d\d:\d\d)", re.A)
_BAD_IRI = re.compile(r'[\x00-\x20<>"{}|^`\\\ud800-\udfff]')
_SURROGATE = re.compile(r"[\ud800-\udfff]")
_ESCAPES = str.maketrans(
    {chr(code): f"\\u{code:04X}" for code in (*range(0x20), 0x7F)}
    | {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"}
)


@dataclass(frozen=True, slots=True)
class Literal:
    """A literal that no plain Python value represents; `language` is a tag as "en", or empty."""

    lexical: str
    datatype: str = LANGUAGE_TEXT
    language: str = ""


Term: TypeAlias = Iri | Literal | str | bool | int | float | Decimal | datetime


class Quad(NamedTuple):
    """One statement and its named graph (None: the default graph)."""

    subject: Iri
    predicate: Iri
    object: Term
    graph: Iri | None = None


# A predicate and an object, and all those of a node.
Property: TypeAlias = "tuple[Iri, Term]"
Properties: TypeAlias = "list[Property]"


class StatementGroup(NamedTuple):
    """Consecutive statements about one subject in one graph."""

    node: Iri
    graph: Iri
    pairs: Properties


class AnnotatedEdge(NamedTuple):
    """A statement that is annotated; it need not be asserted."""

    subject: Iri
    predicate: Iri
    object: Term


class ReifyingTriple(NamedTuple):
    """The statement that a node reifies an edge."""

    subject: Iri
    predicate: Iri
    edge: AnnotatedEdge
    graph: Iri


# What an RDF text is read into.
Statements: TypeAlias = "StatementGroup | ReifyingTriple"


def ungrouped(items: "Iterable[Statements]") -> "Iterator[Quad | ReifyingTriple]":
    """Iterate over the statements of items."""
    for item in items:
        if isinstance(item, ReifyingTriple):
            yield item
        else:
            yield from (Quad(item.node, key, value, item.graph) for key, value in item.pairs)


def is_blank(term: "Term | None") -> bool:
    """Whether a term is a blank node."""
    return isinstance(term, Iri) and term.startswith(BLANK)


def literal(lexical: str, datatype: str, language: str = "") -> Term:
    """The term of an RDF literal."""
    if language:
        return Literal(lexical, LANGUAGE_TEXT, language)
    if datatype == STRING:
        return lexical
    read = _READERS.get(datatype)
    try:
        return read(lexical) if read else Literal(lexical, datatype)
    except (KeyError, ValueError, InvalidOperation):
        return Literal(lexical, datatype)


def lexical(term: Term) -> tuple[str, str, str]:
    """The lexical form, datatype and language of a literal.

    ValueError if it is an IRI, a time without zone, or a text that is no Unicode.
    """
    if isinstance(term, Iri):
        raise ValueError(f"<{term}> is an IRI where a literal is expected.")
    if isinstance(term, Literal):
        return _encodable(term.lexical), term.datatype, term.language
    write, datatype = _WRITERS[type(term)]
    return write(term), datatype, ""


def as_sparql(term: Term) -> str:
    """A term in the syntax of SPARQL and N-Quads, escaped; ValueError if it is not valid."""
    if isinstance(term, Iri):
        if _BAD_IRI.search(term) or ":" not in term:
            raise ValueError(f"{str(term)!r} is no IRI.")
        return f"<{term}>"
    text, datatype, language = lexical(term)
    quoted = f'"{text.translate(_ESCAPES)}"'
    if language:
        return f"{quoted}@{language}"
    return quoted if datatype == STRING else f"{quoted}^^{as_sparql(Iri(datatype))}"


def as_line(quad: Quad) -> str:
    """A statement, with its graph if it has one, as a line of N-Quads; as `as_sparql`."""
    return " ".join(as_sparql(part) for part in quad if part is not None) + " .\n"


def write_time(time: datetime) -> str:
    """The xsd:dateTime in UTC of a time, with milliseconds if any; ValueError without a zone."""
    if time.tzinfo is None:
        raise ValueError(f"{time} has no time zone.")
    text = time.astimezone(timezone.utc).replace(tzinfo=None).isoformat(timespec="milliseconds")
    return text.removesuffix(".000") + "Z"


def read_time(text: str) -> datetime:
    """The time of an xsd:dateTime with a zone, to the microsecond; ValueError if it is none."""
    if not (match := _TIME.fullmatch(text)):
        raise ValueError(f"{text!r} is no time with a zone.")
    moment, fraction, zone = match.groups()
    time = datetime.fromisoformat(moment + zone.replace("Z", "+00:00")).astimezone(timezone.utc)
    return time + timedelta(microseconds=int(fraction.ljust(6, "0"))) if fraction else time


def _read_decimal(text: str) -> Decimal:
    if not (value := Decimal(text)).is_finite():
        raise ValueError(text)
    return value


_READERS: dict[str, Callable[[str], Term]] = {
    DECIMAL: _read_decimal,
    XSD + "integer": int,
    XSD + "boolean": {"true": True, "1": True, "false": False, "0": False}.__getitem__,
    XSD + "double": float,
    DATE_TIME: read_time,
}


def _write_decimal(value: Decimal) -> str:
    text = f"{value:f}"
    return text if "." in text else f"{text}.0"  # Turtle and people read 1 as an integer


def _encodable(text: str) -> str:
    if _SURROGATE.search(text):
        raise ValueError(f"{text!r} is no Unicode text.")
    return text


_WRITERS: dict[type, tuple[Callable[[Any], str], str]] = {
    str: (_encodable, STRING),
    bool: (lambda value: str(value).lower(), XSD + "boolean"),
    int: (str, XSD + "integer"),
    Decimal: (_write_decimal, DECIMAL),
    float: (lambda value: repr(value).replace("inf", "INF").replace("nan", "NaN"), XSD + "double"),
    datetime: (write_time, DATE_TIME),
}
