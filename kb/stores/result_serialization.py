"""Serialization of query results: JSON, CSV, TSV and XML of SPARQL 1.1, and Turtle.

Rows have the first four formats, booleans JSON and XML, statements all; Turtle is for statements
only.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import cast

from ...ontology.errors import QueryError
from ..sparql.results import BooleanResult, ConstructResult, QueryResult, SelectResult

_ILLEGAL_IN_XML = dict.fromkeys(
    [*(code for code in range(0x20) if code not in {0x9, 0xA, 0xD}), 0xFFFE, 0xFFFF], "\ufffd"
)


def write_result(found: QueryResult, format: str) -> str:
    """The document of a query result in one of `FORMATS`; QueryError if that cannot hold it."""
    if format not in FORMATS:
        raise QueryError(f'There is no result format "{format}". Known: {", ".join(FORMATS)}.')
    return FORMATS[format](found)


def _by_engine(found: QueryResult, name: str) -> str:
    import pyoxigraph as engine

    formats = engine.QueryResultsFormat
    read = engine.parse_query_results(json.dumps(found.as_json()), formats.JSON)
    return cast(bytes, read.serialize(format=getattr(formats, name))).decode()


def _turtle(found: QueryResult) -> str:
    if not isinstance(found, ConstructResult):
        raise QueryError("Turtle is for the statements of a CONSTRUCT or DESCRIBE query.")
    from .rdf_text import write_rdf

    return write_rdf(found.quads, format="turtle").decode("utf-8")


FORMATS: Mapping[str, Callable[[QueryResult], str]] = {
    "json": lambda found: json.dumps(found.as_json(), ensure_ascii=False) + "\n",
    "csv": lambda found: _by_engine(_rows(found, "CSV"), "CSV"),
    "tsv": lambda found: _by_engine(_rows(found, "TSV"), "TSV"),
    "xml": lambda found: _by_engine(found, "XML").translate(_ILLEGAL_IN_XML),
    "turtle": _turtle,
}


def _rows(found: QueryResult, name: str) -> SelectResult:
    if isinstance(found, BooleanResult):
        raise QueryError(
            f"{name} is for rows; the result of an ASK query is a boolean. Use json or xml."
        )
    return found
