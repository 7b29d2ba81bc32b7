"""Claims about ontologies of others beside the rules."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from hilt.inference.affordance import Affordances
from hilt.inference.taxonomy import Taxonomy
from hilt.kb.formats.import_export import export_file, import_file
from hilt.kb.formats.ontology import import_ontology
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rdf.terms import Quad
from hilt.kb.rule import Atom, functional
from hilt.kb.sparql.results import BooleanResult
from hilt.kb.validation import findings
from hilt.ontology.errors import DataError, MissingExtraError
from hilt.ontology.vocabulary import Iri, external, ontology_graph

from ..conftest import teach

SOMA = """@prefix : <http://www.ease-crc.org/ont/SOMA.owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
:Spoon rdfs:subClassOf :TableCutlery , [ a owl:Restriction ; owl:onProperty :hasPart ] .
:TableCutlery rdfs:subClassOf :Cutlery ; owl:equivalentClass :Silverware .
:Silverware rdfs:subClassOf :TableCutlery .
:Cutlery rdfs:label "cutlery"@en , "Besteck"@de .
"""
FUNCTIONAL = """Prefix(:=<http://x.org/>)
Ontology(<http://x.org/kitchen>
Declaration(Class(:Spoon)) Declaration(Class(:Cutlery))
SubClassOf(:Spoon :Cutlery))
"""
OWL = {
    "kitchen.ofn": FUNCTIONAL,
    "kitchen.owl": FUNCTIONAL,
    "kitchen.owx": """<?xml version="1.0"?>
<Ontology xmlns="http://www.w3.org/2002/07/owl#" ontologyIRI="http://x.org/kitchen">
  <SubClassOf><Class IRI="http://x.org/Spoon"/><Class IRI="http://x.org/Cutlery"/></SubClassOf>
</Ontology>
""",
}
SPOON, CUTLERY = Atom("object", "spoon"), Atom("object", "cutlery")
TABLE = """/a/1\t/r/IsA\t/c/en/spoon/n\t/c/en/cutlery\t{}
/a/2\t/r/UsedFor\t/c/en/spoon\t/c/en/eating\t{}
"""
SIMPLE = "subject,predicate,object\nspoon,is a,cutlery\ncutlery,is a,spoon\n"


def graph_of(base: KnowledgeBase, name: str) -> set[Quad]:
    """The statements of an ontology."""
    return set(base.store.quads(None, None, None, ontology_graph(name)))


@pytest.fixture
def soma(tmp_path: Path, paper: KnowledgeBase) -> KnowledgeBase:
    """A base with a piece of an ontology."""
    file = tmp_path / "SOMA.ttl"
    file.write_text(SOMA)
    import_ontology(paper, str(file))
    return paper


def test_ontology_is_kept_with_the_rest(soma: KnowledgeBase, tmp_path: Path):
    """In a graph of its own that queries see, that is valid, exported and read back."""
    file = tmp_path / "whole.nq"
    export_file(soma, file)

    with KnowledgeBase.open("memory:") as copy:
        import_file(copy, file)
        assert graph_of(copy, "soma") == graph_of(soma, "soma")
    assert len(graph_of(soma, "soma")) == 10
    assert findings(soma.store, whole=True) == []
    ask = "ASK { GRAPH graph:ontology.soma { ?x rdfs:subClassOf ?y } }"
    assert soma.query(ask) == BooleanResult(True)


@pytest.mark.parametrize(("name", "text"), OWL.items())
def test_owl_in_another_syntax_is_converted(
    paper: KnowledgeBase, tmp_path: Path, name: str, text: str
):
    """Functional syntax, as SOMA has it in files that end in .owl, and OWL/XML."""
    (tmp_path / name).write_text(text)

    import_ontology(paper, str(tmp_path / name), name="kitchen")

    spoon, above = Iri("http://x.org/Spoon"), external("rdfs:subClassOf")
    assert [quad.object for quad in paper.store.quads(spoon, above)] == [
        Iri("http://x.org/Cutlery")
    ]


def test_missing_converter_is_told(
    paper: KnowledgeBase, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """With the extra that brings it."""
    monkeypatch.setitem(sys.modules, "pyhornedowl", None)
    (tmp_path / "a.ofn").write_text(OWL["kitchen.ofn"])

    with pytest.raises(MissingExtraError, match=r'"py-horned-owl".*"hilt\[owl\]"'):
        import_ontology(paper, str(tmp_path / "a.ofn"))


def test_ontology_read_again_changes_nothing_and_another_replaces_it(
    soma: KnowledgeBase, tmp_path: Path
):
    """Blank nodes have the same names; an empty file removes the graph."""
    again = import_ontology(soma, str(tmp_path / "SOMA.ttl"))
    (tmp_path / "none.ttl").write_text("")
    gone = import_ontology(soma, str(tmp_path / "none.ttl"), name="soma")

    assert (again.added, again.removed) == (0, 0)
    assert (gone.statements, gone.removed) == (0, 10)
    assert graph_of(soma, "soma") == set()
    assert soma.sequence == 5


def test_document_type_is_refused(paper: KnowledgeBase, tmp_path: Path):
    """Its entities would unfold."""
    file = tmp_path / "knowrob.owl"
    file.write_text('<?xml version="1.0"?><!DOCTYPE rdf:RDF [<!ENTITY x "y">]><rdf:RDF/>')

    with pytest.raises(DataError, match="document type"):
        import_ontology(paper, str(file))


@pytest.mark.parametrize(("name", "text"), [
    ("soma.ttl", SOMA), ("net.tsv", TABLE), ("pairs.csv", SIMPLE),
])  # fmt: skip
def test_rule_reaches_what_an_ontology_says_is_of_its_kind(
    paper: KnowledgeBase, tmp_path: Path, name: str, text: str
):
    """A rule on cutlery holds of a spoon, when it is asked for; cycles are synonyms."""
    (tmp_path / name).write_text(text)
    import_ontology(paper, str(tmp_path / name))
    teach(paper, functional("cutlery", "eating", interval=Interval(0.9, 1)))

    paper.taxonomies = ()
    assert CUTLERY not in [kind for kind, _ in Taxonomy.from_base(paper).above(SPOON)]

    paper.taxonomies = (name.partition(".")[0],)
    kinds = Affordances(paper, taxonomy=Taxonomy.from_base(paper)).taxonomy
    assert CUTLERY in [kind for kind, _ in kinds.above(SPOON)]


def test_blank_nodes_have_names_of_the_ontology(soma: KnowledgeBase):
    """None stays blank."""
    ends = {end for quad in graph_of(soma, "soma") for end in (quad.subject, quad.object)}

    names = [end for end in ends if isinstance(end, Iri) and "genid/ontology.soma/" in end]
    assert len(names) == 1
    assert not any(str(end).startswith("_:") for end in ends)
