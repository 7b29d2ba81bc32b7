"""Claims about results as documents, checked by rdflib's readers of the same formats."""

from __future__ import annotations

import csv
import io
import json
from datetime import datetime, timezone
from decimal import Decimal

import pytest
from rdflib.query import Result

from hilt.kb.rdf.terms import Literal
from hilt.kb.sparql.results import BooleanResult, ConstructResult, SelectResult, read_solutions
from hilt.kb.stores.rdf_text import RESULT_FORMATS, write_result
from hilt.ontology.errors import QueryError
from hilt.ontology.vocabulary import Iri

ROWS = SelectResult(
    ("a", "b"),
    (
        (Iri("urn:x"), 'a "quoted" <&> text,\n刀'),
        (None, Decimal("0.95")),
        (Iri("_:b0"), Literal("Messer", language="de")),
        (True, datetime(2026, 11, 21, 9, tzinfo=timezone.utc)),
    ),
)


@pytest.mark.parametrize("format", ["json", "xml", "tsv"])
def test_rows_are_read_back(format: str):
    """What another library reads is what was written."""
    found = Result.parse(io.BytesIO(write_result(ROWS, format).encode()), format=format)

    assert [str(name) for name in found.vars or ()] == ["a", "b"]
    values = [[None if v is None else str(v) for v in row] for row in found]
    assert [row[1] for row in values[:3]] == ['a "quoted" <&> text,\n刀', "0.95", "Messer"]
    assert values[0][0] == "urn:x" and values[1][0] is None


def test_json_comes_back_as_the_same_values():
    """Our own reader undoes our own writer."""
    assert read_solutions(write_result(ROWS, "json").encode()) == ROWS


def test_csv_holds_plain_values():
    """As the recommendation says: no types, lines end in CR LF."""
    written = write_result(ROWS, "csv")

    assert written.startswith("a,b\r\nurn:x,")
    assert list(csv.reader(io.StringIO(written)))[1:3] == [["urn:x", ROWS.rows[0][1]], ["", "0.95"]]


def test_yes_or_no_is_json_or_xml():
    """The other formats have no place for it."""
    assert json.loads(write_result(BooleanResult(True), "json")) == {"head": {}, "boolean": True}
    assert "<boolean>false</boolean>" in write_result(BooleanResult(False), "xml")
    with pytest.raises(QueryError, match="for rows"):
        write_result(BooleanResult(True), "csv")


def test_statements_are_turtle_with_prefixes():
    """Rows are not."""
    statement = (Iri("https://w3id.org/hilt/object/knife"), Iri("urn:p"), 1)
    made = ConstructResult(("subject", "predicate", "object"), (statement,))

    assert "object:knife <urn:p> 1 ." in write_result(made, "turtle")
    with pytest.raises(QueryError, match="CONSTRUCT or DESCRIBE"):
        write_result(ROWS, "turtle")


def test_control_characters_do_not_break_xml():
    """XML has no way to write them, so a mark stands in their place."""
    written = write_result(SelectResult(("a",), (("a\x00b\x0bc",),)), "xml")

    assert "a\ufffdb\ufffdc" in written


def test_unknown_format_lists_the_known():
    """The error names them."""
    with pytest.raises(QueryError, match=", ".join(RESULT_FORMATS)):
        write_result(ROWS, "pdf")
