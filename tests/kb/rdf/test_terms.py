"""Claims about RDF terms as Python values."""

from __future__ import annotations

from datetime import datetime, timezone
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.kb.rdf.terms import Literal, Term, as_sparql, lexical, literal, read_time, write_time
from hilt.ontology.vocabulary import Iri

XSD = "http://www.w3.org/2001/XMLSchema#"
times = st.datetimes(min_value=datetime(1900, 1, 1), timezones=st.just(timezone.utc)).map(
    lambda time: time.replace(microsecond=time.microsecond // 1000 * 1000)
)
values = st.one_of(
    st.text(st.characters(exclude_categories=["Cs"])),
    st.booleans(),
    st.integers(),
    st.decimals(allow_nan=False, allow_infinity=False, places=6),
    st.floats(allow_nan=False),
    times,
)


@given(values)
def test_value_comes_back_from_its_lexical_form(value: Term):
    """`literal` is the inverse of `lexical`, for every kind of value."""
    assert literal(*lexical(value)) == value
    assert type(literal(*lexical(value))) is type(value)


@pytest.mark.parametrize(
    ("text", "datatype"),
    [("abc", "integer"), ("NaN", "decimal"), ("yes", "boolean"), ("2026-11-21", "dateTime")],
)
def test_literal_without_a_value_is_kept_as_it_is_written(text: str, datatype: str):
    """What Python cannot hold stays a `Literal`, so that nothing is lost."""
    assert literal(text, XSD + datatype) == Literal(text, XSD + datatype)


def test_language_and_foreign_types_are_kept():
    """A text in a language and an unknown type are literals of their own."""
    assert literal("knife", XSD + "string", "en") == Literal("knife", language="en")
    assert literal("x", "urn:type") == Literal("x", "urn:type")


@pytest.mark.parametrize(
    ("term", "written"),
    [
        (Iri("urn:x"), "<urn:x>"),
        ('say "hi"\n\\', '"say \\"hi\\"\\n\\\\"'),
        ("\x00", '"\\u0000"'),
        (True, f'"true"^^<{XSD}boolean>'),
        (Decimal(1), f'"1.0"^^<{XSD}decimal>'),
        (Literal("knife", language="en"), '"knife"@en'),
    ],
)
def test_term_is_written_so_that_nothing_breaks_out(term: Term, written: str):
    """Quotes, newlines and control characters are escaped."""
    assert as_sparql(term) == written


@pytest.mark.parametrize("term", [Iri("urn:a> <urn:b"), Iri("nothing"), Iri("urn:a b"), "\ud800"])
def test_malformed_term_is_refused(term: Term):
    """An IRI that could end early, and a text that is no Unicode, are never written."""
    with pytest.raises(ValueError, match="is no"):
        as_sparql(term)


def test_time_keeps_milliseconds_and_zone():
    """A time is written in UTC and read from any zone."""
    time = datetime(2026, 11, 21, 9, 0, 0, 250_000, tzinfo=timezone.utc)

    assert write_time(time) == "2026-11-21T09:00:00.250Z"
    assert read_time("2026-11-21T10:00:00.25+01:00") == time


@pytest.mark.parametrize("text", ["2026-11-21T09:00:00", "2026-13-01T00:00:00Z", "now", ""])
def test_time_without_zone_is_refused(text: str):
    """Without a zone nobody knows when it was."""
    with pytest.raises(ValueError, match=r"no time|month"):
        read_time(text)


def test_time_without_zone_is_not_written():
    """The same holds the other way."""
    with pytest.raises(ValueError, match="no time zone"):
        write_time(datetime(2026, 11, 21))


def test_iri_has_no_lexical_form():
    """An IRI is no literal."""
    with pytest.raises(ValueError, match="is an IRI"):
        lexical(Iri("urn:x"))
