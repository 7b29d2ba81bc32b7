"""The page of the vocabulary, made from the ontology's Turtle.

    python docs/vocabulary.py > docs/vocabulary.md

A test sees to it that the page is fresh.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from rdflib import OWL, RDF, RDFS, SKOS, Graph, URIRef
from rdflib.collection import Collection
from rdflib.term import Node

from hilt.ontology.vocabulary import KINDS, PREFIXES

SOURCE = Path(__file__).parents[1] / "ontology" / "vocabulary.ttl"
OURS = "https://w3id.org/hilt"
HEAD = f"""# Vocabulary

Made by `make docs` from [vocabulary.ttl](../ontology/vocabulary.ttl).
[shapes.ttl](../ontology/shapes.ttl) says how the individuals of each class look, and
[queries](queries.md) how to ask.

`hilt:` is `{PREFIXES["hilt"]}`. Individuals have a namespace for each kind: `object:` is
`{PREFIXES["object"]}`, and likewise {", ".join(f"`{kind}:`" for kind in KINDS[1:])}.
In `hilt query` all of them are declared.
"""
SECTIONS = {
    "Classes": OWL.Class,
    "Properties between things": OWL.ObjectProperty,
    "Properties with values": OWL.DatatypeProperty,
    "Individuals": None,
}


def reference() -> str:
    """The page as Markdown."""
    graph = Graph().parse(SOURCE)
    sections = [line for each in SECTIONS.items() for line in _section(graph, *each)]
    return "\n".join([HEAD, *sections]).rstrip() + "\n"


def _section(graph: Graph, title: str, kind: URIRef | None) -> Iterator[str]:
    is_property = title.startswith("Properties")
    between = ["from", "to"] if is_property else []
    columns = ["term", "meaning", *between, "is a kind of, or close to"]
    yield f"## {title}\n\n| {' | '.join(columns)} |\n{'|---' * len(columns)}|"
    for term in sorted(_terms(graph, kind)):
        meaning = " ".join(str(each) for each in graph.objects(term, RDFS.comment))
        ends = [_names(graph, term, each) for each in (RDFS.domain, RDFS.range)]
        above = RDF.type if kind is None else RDFS.subClassOf
        related = _names(graph, term, above, RDFS.subPropertyOf, SKOS.closeMatch)
        cells = (f"`{graph.qname(term)}`", meaning, *(ends if is_property else ()), related)
        yield f"| {' | '.join(cells)} |"
    yield ""


def _terms(graph: Graph, kind: URIRef | None) -> set[Node]:
    if kind is not None:
        found = set(graph.subjects(RDF.type, kind))
    else:
        found = {term for term, of in graph.subject_objects(RDF.type) if str(of).startswith(OURS)}
    return {term for term in found if str(term).startswith(OURS)}


def _names(graph: Graph, term: Node, *relations: URIRef) -> str:
    found: list[Node] = []
    for each in (each for relation in relations for each in graph.objects(term, relation)):
        union = graph.value(each, OWL.unionOf)
        found += [each] if union is None else Collection(graph, union)
    return ", ".join(f"`{name}`" for name in sorted(map(graph.qname, found)))


if __name__ == "__main__":
    sys.stdout.write(reference())
