# SPDX-License-Identifier: Apache-2.0
"""Claims about names and IRIs."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.ontology.vocabulary import KINDS, PREFIXES, Iri, external, iri, split, term


def test_space_becomes_an_underscore():
    """Multi-word names stay readable."""
    assert str(iri("object", "wine glass")) == "https://w3id.org/hilt/object/wine_glass"


@given(st.sampled_from(KINDS), st.text(min_size=1))
def test_every_name_comes_back_from_its_iri(kind: str, name: str):
    """`split` is the inverse of `iri`, so no two names share an IRI."""
    name = name.encode("utf-8", "ignore").decode() or "x"

    assert split(iri(kind, name)) == (kind, name)


@given(st.text(min_size=1))
def test_no_name_leaves_its_iri(name: str):
    """Nothing that SPARQL or Turtle could read as the end of an IRI gets into one."""
    name = name.encode("utf-8", "ignore").decode() or "x"

    assert not set(iri("word", name)) & set('<>"{}|^`\\ \n\t#?')


def test_unknown_kind_is_refused():
    """The error lists the kinds there are."""
    with pytest.raises(KeyError, match="known: object, part"):
        iri("planet", "mars")


def test_foreign_iri_has_no_kind():
    """What is not ours is given back whole."""
    assert split(Iri("http://example.org/x")) == ("", "http://example.org/x")


def test_iri_is_no_text():
    """A literal that reads like an IRI is another term."""
    assert Iri("urn:x") != "urn:x"
    assert Iri("urn:x") == Iri("urn:x")
    assert len({Iri("urn:x"), "urn:x"}) == 2


def test_one_prefix_a_kind():
    """Every kind of individual has a prefix of its own."""
    assert all(PREFIXES[kind].endswith(f"/{kind}/") for kind in KINDS)
    assert str(external("prov:used")) == "http://www.w3.org/ns/prov#used"
    assert str(term("lower")) == "https://w3id.org/hilt#lower"
