# SPDX-License-Identifier: Apache-2.0
"""Claims about bases that an earlier Hilt wrote."""

from __future__ import annotations

import pytest

from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.migration import FORMAT, STEPS, base_format, migrate, version_quad
from hilt.kb.stores.oxigraph import OxigraphStore
from hilt.ontology.errors import StoreError
from hilt.ontology.vocabulary import iri, term

# As if format 2 had given the name of what a sentence says: hilt:predicate becomes hilt:meaning.
RENAME = """
DELETE { GRAPH graph:history { ?said hilt:predicate ?form } }
INSERT { GRAPH graph:history { ?said hilt:meaning ?form } }
WHERE { GRAPH graph:history { ?said hilt:predicate ?form } }
"""
TO_3 = "INSERT DATA { GRAPH graph:base { <https://w3id.org/hilt/base> hilt:note 3 } }"
HISTORY = iri("graph", "history")


def test_base_is_brought_to_a_later_format(paper: KnowledgeBase):
    """Step by step, with nothing lost on the way."""
    forms = {q.object for q in paper.store.quads(None, term("predicate"), None, HISTORY)}

    migrate(paper.store, 1, steps={1: RENAME, 2: TO_3}, to=3)

    assert base_format(paper.store) == 3
    assert {q.object for q in paper.store.quads(None, term("meaning"), None, HISTORY)} == forms
    assert not list(paper.store.quads(None, term("predicate"), None, HISTORY))
    assert list(paper.store.quads(None, term("note")))


def test_failed_step_leaves_the_format_that_was(paper: KnowledgeBase):
    """The number changes with what it stands for, or not at all."""
    before = set(paper.store.quads())

    with pytest.raises(ValueError, match="The query is wrong"):
        migrate(paper.store, 1, steps={1: f"{RENAME} ; INSERT DATA {{"}, to=2)

    assert set(paper.store.quads()) == before


@pytest.mark.parametrize("found", [FORMAT + 1, 0, "one"])
def test_format_without_a_way_is_refused(paper: KnowledgeBase, found: int | str):
    """A base of a later Hilt, or of none, is never misread."""
    paper.store.apply(
        delete=[version_quad(FORMAT)], insert=[version_quad(FORMAT)._replace(object=found)]
    )

    with pytest.raises(StoreError, match=rf"has format {found}; this Hilt reads format {FORMAT}"):
        KnowledgeBase(paper.store)


def test_reading_only_does_not_migrate(paper: KnowledgeBase):
    """It says what to do."""
    store = paper.store
    assert isinstance(store, OxigraphStore)
    store.read_only = True

    with pytest.raises(StoreError, match="open it once for writing"):
        migrate(store, 1, steps={1: RENAME}, to=2)


def test_there_is_a_way_from_every_format():
    """Each format before that of today has its step."""
    assert sorted(STEPS) == list(range(1, FORMAT))
