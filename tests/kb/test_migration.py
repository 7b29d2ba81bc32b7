"""Claims about bases that an earlier version of Hilt wrote."""

from __future__ import annotations

import io
from collections.abc import Iterable
from pathlib import Path

import pytest

from hilt.kb.formats.import_export import export_file, import_file
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import (
    FORMAT,
    MARK,
    STEPS,
    KnowledgeBase,
    base_format,
    migrate,
    version_quad,
)
from hilt.kb.rdf.rule_mapping import BELIEFS, DERIVED
from hilt.kb.rdf.terms import Quad, ungrouped
from hilt.kb.rule import Atom
from hilt.kb.stores.oxigraph import OxigraphStore, save_quads
from hilt.kb.stores.rdf_text import read_groups, write_rdf
from hilt.kb.validation import check_invariants, check_shapes
from hilt.ontology.errors import StoreError
from hilt.ontology.vocabulary import external, iri, split, term

# As if format 2 had given the name of what a sentence says: hilt:predicate becomes hilt:meaning.
RENAME = """
DELETE { GRAPH graph:history { ?said hilt:predicate ?form } }
INSERT { GRAPH graph:history { ?said hilt:meaning ?form } }
WHERE { GRAPH graph:history { ?said hilt:predicate ?form } }
"""
TO_3 = "INSERT DATA { GRAPH graph:base { <https://w3id.org/hilt/base> hilt:note 3 } }"
HISTORY = iri("graph", "history")
# A base that Hilt wrote on 21 November 2026: rules of every kind and status, trust, a learned
# word, an episode, and a correction.
FORMAT_1 = Path(__file__).parent / "data" / "format-1.nq"
# Another one, of 23 November: that of a robot which was taught actions and kinds, and moved.
TAUGHT = Path(__file__).parent / "data" / "format-1-taught.trig"
KIND = external("rdfs:subClassOf")  # the kinds of things were edges without a name
FOLLOWED = {term(name) for name in ("rule", "usedFor", "graspedBy", "affords")}


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


def statements(file: Path) -> list[Quad]:
    """The statements of a file."""
    form = "nquads" if file.suffix == ".nq" else "trig"
    text = io.BytesIO(file.read_bytes())
    found = ungrouped(read_groups(text, format=form, source="x", default=iri("graph", "base")))
    return [each for each in found if isinstance(each, Quad)]


def told(quads: Iterable[Quad]) -> set[Quad]:
    """What was said and done, without what follows from it and without the domain."""
    unsaid = {iri("graph", name) for name in ("derived", "domain", "base")}
    return {
        quad
        for quad in quads
        if quad.graph not in unsaid
        and not (quad.graph == BELIEFS and split(quad.subject)[0] not in {"rule", "speaker"})
    }


@pytest.fixture
def format_1(tmp_path: Path) -> Path:
    """A folder with the base of format 1."""
    save_quads(statements(FORMAT_1), tmp_path / "kb")
    return tmp_path / "kb"


@pytest.fixture(params=[FORMAT_1, TAUGHT], ids=["told", "taught"])
def old(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, set[Quad]]:
    """A folder with a base of format 1, and its statements."""
    found = statements(request.param)
    save_quads(found, tmp_path / "old")
    return tmp_path / "old", set(found)


def test_beliefs_of_format_1_become_what_was_said(old: tuple[Path, set[Quad]]):
    """What followed from the rules leaves them, and follows again; what was said is kept."""
    folder, before = old

    with KnowledgeBase.open(folder) as kb:
        after = set(kb.store.quads())

    derived = {quad for quad in after if quad.graph == DERIVED}
    assert told(after) == told(before)
    assert {split(q.subject)[0] for q in after if q.graph == BELIEFS} == {"rule", "speaker"}
    edges = {quad[:3] for quad in before if quad.predicate in FOLLOWED}
    kinds = {edge for edge in edges if (edge[0], KIND, edge[2]) in {q[:3] for q in derived}}
    assert edges - kinds <= {quad[:3] for quad in derived}


def test_migration_that_was_interrupted_is_completed(old: tuple[Path, set[Quad]]):
    """A base that has only some of what follows gets the rest when it is opened."""
    folder, _ = old
    with KnowledgeBase.open(folder) as kb:
        whole = set(kb.store.quads())
        some = [quad for quad in whole if quad.graph == DERIVED][::3]
        kb.store.apply(delete=[*some, MARK])

    with pytest.raises(StoreError, match="is not complete"):
        KnowledgeBase.open(folder, read_only=True)
    with KnowledgeBase.open(folder) as kb:
        assert set(kb.store.quads()) == whole


def test_file_of_format_1_is_imported(old: tuple[Path, set[Quad]], tmp_path: Path):
    """An old export gives the same as the old base when that is opened."""
    folder, before = old
    file = tmp_path / "old.nq"
    file.write_bytes(write_rdf(before, format="nquads"))

    with KnowledgeBase.open(folder) as kb, KnowledgeBase.open("memory:") as copy:
        import_file(copy, file)

        assert list(check_invariants(copy.store)) == []
        assert told(copy.store.quads()) == told(kb.store.quads())
        follows = (set(base.store.quads(None, None, None, DERIVED)) for base in (kb, copy))
        assert next(follows) == next(follows)


def test_base_of_format_1_is_read(format_1: Path):
    """Rules, history, trust, words and episodes have the values that were written."""
    with KnowledgeBase.open(format_1) as kb:
        assert [rule.node for rule in kb.rules()] == [
            "findObject.cutting", "pickUp.graspObject", "findObject.cutting", "pass.graspObject"
        ]  # fmt: skip
        assert {rule.status for rule in kb.rules(status=None)} == {
            "active", "superseded", "retracted"
        }  # fmt: skip
        (saw,) = kb.rules(speaker="Anna Müller")
        assert (saw.interval, saw.trust) == (Interval(0.123456, 0.9), 0.5)
        assert saw.features == {Atom("object", "saw"), Atom("property", "red")}
        assert kb.utterance(5).text == "A red saw is used for “cutting”, 刀 \\ too"
        assert (kb.sequence, [word.atom.name for word in kb.words()]) == (9, ["saw"])
        (episode,) = kb.episodes()
        assert (episode.part, episode.lifted_m, episode.utterance) == ("handle", 0.152, 9)


def test_base_of_format_1_is_valid_and_exported_unchanged(format_1: Path, tmp_path: Path):
    """The checks find nothing, and an export imported into a new base exports the same."""
    files = [tmp_path / "one.nq", tmp_path / "two.nq"]
    with KnowledgeBase.open(format_1) as kb:
        assert [*check_invariants(kb.store), *check_shapes(kb.store)] == []
        export_file(kb, files[0])

    with KnowledgeBase.open(tmp_path / "copy") as copy:
        import_file(copy, files[0])
        export_file(copy, files[1])

    one, two = (set(statements(file)) for file in files)
    assert one == two
    assert told(one) == told(statements(FORMAT_1))


def test_base_of_format_1_is_taught(format_1: Path):
    """A rule that is told again and a rule that is retracted change what they always changed."""
    with KnowledgeBase.open(format_1) as kb:
        handle, before = kb.rules(context="pickUp")[0], len(kb.rules())

        kb.retract(handle.id, "No", "not(x)", "sam")
        assert len(kb.rules()) == before - 1
        kb.believe("Yes", "implies(x)", "sam", [handle])

    with KnowledgeBase.open(format_1) as kb:
        assert kb.sequence == 11
        assert kb.rules(context="pickUp") == [kb.rule(handle.id)]
        assert list(check_invariants(kb.store)) == []
