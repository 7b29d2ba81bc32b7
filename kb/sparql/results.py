"""Query results (rows, booleans, statements), query limits, and SPARQL 1.1 Query Results JSON.

Endpoints deviate from that format in details, so it is read leniently and by value.
"""

import json
import re
import threading
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias, cast

from ...ontology.errors import QueryError, QueryLimitError
from ..rdf.terms import BLANK, STRING, Iri, Quad, Term, lexical, literal

STATEMENT = ("subject", "predicate", "object")  # the columns of statements as rows
RDF_12_UNSUPPORTED = "A statement about a statement (RDF 1.2) cannot be read as RDF 1.1."
_ASK_COLUMN = "__ASK_RETVAL"  # Virtuoso answers ASK with a row

SECONDS = 30.0
MEGABYTES = 2048
MAX_SECONDS = threading.TIMEOUT_MAX  # the longest timer: some hundred years, days on Windows
MAX_MEGABYTES = 10**9  # more than any machine has


@dataclass(frozen=True)
class QueryLimits:
    """The time and memory a query may use before it is stopped.

    `seconds`, in ]0, `MAX_SECONDS`], are from the request to the last row; `megabytes`, in
    [1, `MAX_MEGABYTES`], of the evaluating process (its engine needs about 100), and of the answer.
    """

    seconds: float = SECONDS
    megabytes: int = MEGABYTES

    def __post_init__(self) -> None:
        if not 0 < self.seconds <= MAX_SECONDS:
            raise QueryError(
                f"The time of a query is above 0 s and at most {MAX_SECONDS:.0f} s, "
                f"not {self.seconds:g} s."
            )
        if not 1 <= self.megabytes <= MAX_MEGABYTES:
            raise QueryError(
                f"The memory of a query is between 1 MB and {MAX_MEGABYTES} MB, "
                f"not {self.megabytes} MB."
            )

    def time_error(self) -> QueryLimitError:
        """The error of a query that was stopped because of its time."""
        took = f"The query took longer than {self.seconds:g} s and was stopped."
        return QueryLimitError(f"{took} Narrow it, or give it more time.")

    def memory_error(self) -> QueryLimitError:
        """The error of a query that was stopped because of its memory."""
        took = f"The query needed more than {self.megabytes} MB and was stopped."
        return QueryLimitError(f"{took} Narrow it, add a LIMIT, or give it more memory.")


@dataclass(frozen=True)
class SelectResult:
    """The rows of a SELECT query: a value for each variable, None where it is unbound."""

    variables: tuple[str, ...]
    rows: tuple[tuple[Term | None, ...], ...]

    def __iter__(self) -> Iterator[tuple[Term | None, ...]]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def as_json(self) -> dict[str, object]:
        """The document in SPARQL 1.1 Query Results JSON."""
        named = (zip(self.variables, row, strict=True) for row in self.rows)
        rows = [{name: _value(term) for name, term in row if term is not None} for row in named]
        return {"head": {"vars": list(self.variables)}, "results": {"bindings": rows}}


@dataclass(frozen=True)
class ConstructResult(SelectResult):
    """The statements of a CONSTRUCT or DESCRIBE query, as rows of three columns."""

    @property
    def quads(self) -> list[Quad]:
        """The statements, in no graph."""
        return [Quad(*cast("tuple[Iri, Iri, Term]", row)) for row in self.rows]


@dataclass(frozen=True)
class BooleanResult:
    """The answer to an ASK query."""

    value: bool

    def as_json(self) -> dict[str, object]:
        """The document in SPARQL 1.1 Query Results JSON."""
        return {"head": {}, "boolean": self.value}


QueryResult: TypeAlias = "SelectResult | ConstructResult | BooleanResult"


def read_solutions(body: bytes) -> SelectResult:
    """The rows of a JSON results document; QueryError if it is incomplete, or has RDF 1.2 terms."""
    document = _parsed(body)
    try:
        names = tuple(cast("list[str]", document["head"].get("vars", [])))
        rows = tuple(
            tuple(_term(row[name]) if name in row else None for name in names)
            for row in document["results"]["bindings"]
        )
    except (KeyError, TypeError, AttributeError) as error:
        raise QueryError("The endpoint sent no rows where rows were expected.") from error
    return SelectResult(names, rows)


def read_boolean(body: bytes) -> bool:
    """The boolean of a JSON results document; errors as for `read_solutions`."""
    if isinstance(answer := _parsed(body).get("boolean"), bool):
        return answer
    found = read_solutions(body)
    if found.variables == (_ASK_COLUMN,):
        return any(row[0] for row in found)
    raise QueryError("The endpoint sent no boolean for an ASK query.")


def _parsed(body: bytes) -> dict[str, Any]:
    try:
        document = json.loads(body)
    except ValueError as error:
        raise QueryError(
            "The endpoint sent an incomplete answer; the query may have been cut off there. "
            "Narrow it, or give it more time."
        ) from error
    if not isinstance(document, dict):
        raise QueryError("The endpoint sent no SPARQL results.")
    return cast("dict[str, Any]", document)


def _term(value: Mapping[str, Any]) -> Term:
    match value["type"]:
        case "uri":
            return Iri(value["value"])
        case "bnode":
            return Iri(BLANK + re.sub(r"\W", "_", value["value"].removeprefix(BLANK)))
        case "literal" | "typed-literal":
            return literal(value["value"], value.get("datatype", STRING), value.get("xml:lang", ""))
        case _:
            raise QueryError(RDF_12_UNSUPPORTED)


def _value(term: Term) -> dict[str, str]:
    if isinstance(term, Iri):
        if term.startswith(BLANK):
            return {"type": "bnode", "value": term.removeprefix(BLANK)}
        return {"type": "uri", "value": str(term)}
    text, datatype, language = lexical(term)
    written = {"type": "literal", "value": text}
    if language:
        return written | {"xml:lang": language}
    return written if datatype == STRING else written | {"datatype": datatype}
