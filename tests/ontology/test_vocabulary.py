"""Names and IRIs."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.ontology.vocabulary import KINDS, PREFIXES, Iri, external, iri, split, term


def test_space_becomes_an_underscore():
    """A space in a name is written as an underscore in its IRI."""
    assert str(iri("object", "wine glass")) == "https://w3id.org/hilt/object/wine_glass"


@given(st.sampled_from(KINDS), st.text(min_size=1))
def test_split_returns_the_name_of_an_iri(kind: str, name: str):
    """`split` is the inverse of `iri`, so no two names share an IRI."""
    name = name.encode("utf-8", "ignore").decode() or "x"

    assert split(iri(kind, name)) == (kind, name)


@given(st.text(min_size=1))
def test_special_characters_of_a_name_are_escaped(name: str):
    """No character that ends an IRI in SPARQL or Turtle is in an IRI."""
    name = name.encode("utf-8", "ignore").decode() or "x"

    assert not set(iri("word", name)) & set('<>"{}|^`\\ \n\t#?')


def test_unknown_kind_is_refused():
    """The error lists the known kinds."""
    with pytest.raises(KeyError, match="known: object, part"):
        iri("planet", "mars")


def test_foreign_iri_has_no_kind():
    """An IRI of another namespace is returned whole."""
    assert split(Iri("http://example.org/x")) == ("", "http://example.org/x")


def test_iri_never_equals_a_text():
    """An IRI and a literal with the same characters are different terms."""
    assert Iri("urn:x") != "urn:x"
    assert Iri("urn:x") == Iri("urn:x")
    assert len({Iri("urn:x"), "urn:x"}) == 2


def test_each_kind_has_a_prefix():
    """Every kind of individual has a prefix of its own."""
    assert all(PREFIXES[kind].endswith(f"/{kind}/") for kind in KINDS)
    assert str(external("prov:used")) == "http://www.w3.org/ns/prov#used"
    assert str(term("lower")) == "https://w3id.org/hilt#lower"
