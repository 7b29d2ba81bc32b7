# SPDX-License-Identifier: Apache-2.0
"""Serialization of query results: JSON, CSV, TSV and XML of SPARQL 1.1, and Turtle.

Rows have the first four formats, booleans JSON and XML, statements all; Turtle is for statements
only. pyoxigraph serializes only the results of its own queries, which those of an endpoint are not.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator, Mapping
from xml.sax.saxutils import escape, quoteattr

from ...ontology.errors import QueryError
from ..rdf.terms import BLANK, STRING, Iri, Term, as_sparql, lexical
from ..sparql.results import BooleanResult, ConstructResult, QueryResult, SelectResult

_ILLEGAL_IN_XML = dict.fromkeys(
    [*(code for code in range(0x20) if code not in {0x9, 0xA, 0xD}), 0xFFFE, 0xFFFF], "\ufffd"
)


def write_result(found: QueryResult, format: str) -> str:  # noqa: A002
    """The document of a query result in one of `FORMATS`; QueryError if that cannot hold it."""
    if format not in FORMATS:
        raise QueryError(f'There is no result format "{format}". Known: {", ".join(FORMATS)}.')
    return FORMATS[format](found)


def _csv(found: QueryResult) -> str:
    rows = _rows(found, "CSV")
    written = io.StringIO()
    writer = csv.writer(written, lineterminator="\r\n")
    writer.writerow(rows.variables)
    for row in rows:
        # One empty column would make an empty line, which readers skip.
        writer.writerow([_plain(term) for term in row])
    return written.getvalue()


def _tsv(found: QueryResult) -> str:
    rows = _rows(found, "TSV")
    lines = ["\t".join(f"?{name}" for name in rows.variables)]
    lines += ["\t".join("" if term is None else _turtle_term(term) for term in row) for row in rows]
    return "".join(f"{line}\n" for line in lines)


def _xml(found: QueryResult) -> str:
    if isinstance(found, BooleanResult):
        inside = [" <head/>", f" <boolean>{str(found.value).lower()}</boolean>"]
    else:
        names = "".join(f"<variable name={quoteattr(name)}/>" for name in found.variables)
        inside = [f" <head>{names}</head>", " <results>", *_xml_rows(found), " </results>"]
    head = '<?xml version="1.0" encoding="UTF-8"?>\n'
    space = 'xmlns="http://www.w3.org/2005/sparql-results#"'
    return "\n".join([f"{head}<sparql {space}>", *inside, "</sparql>\n"])


def _turtle(found: QueryResult) -> str:
    if not isinstance(found, ConstructResult):
        raise QueryError("Turtle is for the statements of a CONSTRUCT or DESCRIBE query.")
    from .rdf_text import write_rdf

    return write_rdf(found.quads, format="turtle").decode("utf-8")


FORMATS: Mapping[str, Callable[[QueryResult], str]] = {
    "json": lambda found: json.dumps(found.as_json(), ensure_ascii=False) + "\n",
    "csv": _csv,
    "tsv": _tsv,
    "xml": _xml,
    "turtle": _turtle,
}


def _rows(found: QueryResult, name: str) -> SelectResult:
    if isinstance(found, BooleanResult):
        raise QueryError(
            f"{name} is for rows; the result of an ASK query is a boolean. Use json or xml."
        )
    return found


def _plain(term: Term | None) -> str:
    if term is None:
        return ""
    return str(term) if isinstance(term, Iri) else lexical(term)[0]


def _turtle_term(term: Term) -> str:
    return str(term) if isinstance(term, Iri) and term.startswith(BLANK) else as_sparql(term)


def _xml_rows(found: SelectResult) -> Iterator[str]:
    for row in found:
        named = zip(found.variables, row, strict=True)
        cells = (
            f"<binding name={quoteattr(name)}>{_xml_term(term)}</binding>"
            for name, term in named
            if term is not None
        )
        yield f"  <result>{''.join(cells)}</result>"


def _xml_term(term: Term) -> str:
    if isinstance(term, Iri):
        tag, text = ("bnode", term[len(BLANK) :]) if term.startswith(BLANK) else ("uri", str(term))
        return f"<{tag}>{escape(text)}</{tag}>"
    text, datatype, language = lexical(term)
    kind = f" datatype={quoteattr(datatype)}" if datatype != STRING and not language else ""
    spoken = f" xml:lang={quoteattr(language)}" if language else ""
    return f"<literal{kind}{spoken}>{escape(text.translate(_ILLEGAL_IN_XML))}</literal>"
