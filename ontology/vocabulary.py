"""The RDF vocabulary: namespaces, prefixes, and IRIs for names.

`vocabulary.ttl` beside this file defines each class and property; `shapes.ttl` constrains their
instances. Terms of the vocabulary are `hilt:...` (`term("lower")`). Individuals have
one path for each kind: `object:knife`, `part:blade`, `rule:3f9c...` (`iri("part", "blade")`).
"""

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from urllib.parse import quote, unquote

VOCABULARY_FILE = Path(__file__).with_name("vocabulary.ttl")
SHAPES_FILE = Path(__file__).with_name("shapes.ttl")

HILT = "https://w3id.org/hilt#"
INDIVIDUALS = "https://w3id.org/hilt/"

ATOM_KINDS = ("object", "part", "property", "action", "place", "role", "affordance", "material")
# Kinds of nodes that rules speak of.
NAMED_KINDS = (*ATOM_KINDS, "node", "functor")
EPISODE_KINDS = ("episode", "step", "trial")
LEARNED_KINDS = ("word", "phrase", "taught")
_OTHER_KINDS = ("rule", "utterance", "speaker", "relation", "activity", "graph")
KINDS = (*NAMED_KINDS, *EPISODE_KINDS, *LEARNED_KINDS, *_OTHER_KINDS)

# The named graphs of a knowledge base; `base` holds its format version and sequence number, and
# `derived` what follows from the others.
GRAPH_NAMES = ("base", "domain", "beliefs", "history", "lexicon", "episodes", "actions", "derived")

_FOREIGN = {
    "rdf": "http://www.w3.org/1999/02/22-rdf-syntax-ns#",
    "rdfs": "http://www.w3.org/2000/01/rdf-schema#",
    "xsd": "http://www.w3.org/2001/XMLSchema#",
    "owl": "http://www.w3.org/2002/07/owl#",
    "sosa": "http://www.w3.org/ns/sosa/",
    "prov": "http://www.w3.org/ns/prov#",
    "skos": "http://www.w3.org/2004/02/skos/core#",
    "sh": "http://www.w3.org/ns/shacl#",
    "dct": "http://purl.org/dc/terms/",
    "ontolex": "http://www.w3.org/ns/lemon/ontolex#",
    "dul": "http://www.ontologydesignpatterns.org/ont/dul/DUL.owl#",
    "soma": "http://www.ease-crc.org/ont/SOMA.owl#",
}
PREFIXES: Mapping[str, str] = MappingProxyType(
    {"hilt": HILT} | {kind: f"{INDIVIDUALS}{kind}/" for kind in KINDS} | _FOREIGN
)

ONTOLOGIES = f"{PREFIXES['graph']}ontology."  # how the graphs of ontologies of others begin

_UNSAFE = re.compile(r"[^\w.-]|_")


class Iri(str):
    """An IRI: a `str` that never equals a plain `str`, which stands for a literal.

    >>> Iri("urn:x") == "urn:x"
    False
    """

    __slots__ = ()
    __hash__ = str.__hash__

    def __eq__(self, other: object) -> bool:
        return type(other) is Iri and str.__eq__(self, other)

    def __ne__(self, other: object) -> bool:
        return type(other) is not Iri or str.__ne__(self, other)

    def __repr__(self) -> str:
        return f"Iri({str(self)!r})"


def iri(kind: str, name: str) -> Iri:
    """Return the IRI of an individual; a space becomes `_`, other invalid characters are escaped.

    >>> print(iri("object", "wine glass"))
    https://w3id.org/hilt/object/wine_glass

    KeyError if there is no such kind.
    """
    if kind not in KINDS:
        raise KeyError(f'there is no kind "{kind}"; known: {", ".join(KINDS)}.')
    escaped = _UNSAFE.sub(lambda found: quote(found[0], safe="").replace("_", "%5F"), name)
    return Iri(PREFIXES[kind] + escaped.replace("%20", "_"))


def ontology_graph(name: str) -> Iri:
    """Return the graph of an ontology of others beside those of Hilt (`GRAPH_NAMES`).

    >>> print(prefixed(ontology_graph("SOMA")))
    graph:ontology.soma
    """
    given = name.removeprefix(ONTOLOGIES).removeprefix("graph:").removeprefix("ontology.")
    return Iri(ONTOLOGIES + (re.sub(r"[^a-z0-9]+", "-", given.lower()).strip("-") or "unnamed"))


def is_ontology(graph: Iri | None) -> bool:
    """Return whether a graph holds an ontology of others, which is kept and never interpreted."""
    return graph is not None and graph.startswith(ONTOLOGIES)


def term(name: str) -> Iri:
    """Return the IRI of a class or property of Hilt's vocabulary."""
    return Iri(HILT + name)


def external(prefixed: str) -> Iri:
    """Return the IRI of a prefixed name such as "prov:wasDerivedFrom"."""
    prefix, _, local = prefixed.partition(":")
    return Iri(PREFIXES[prefix] + local)


def prefixed(full: Iri) -> str:
    """Return an IRI in prefixed form, or unchanged if no prefix fits.

    >>> prefixed(iri("object", "wine glass"))
    'object:wine_glass'
    """
    name = next((name for name, space in PREFIXES.items() if full.startswith(space)), "")
    return f"{name}:{full.removeprefix(PREFIXES[name])}" if name else str(full)


def shortened(node: str) -> str:
    """Return an IRI in prefixed form, or in angle brackets if no prefix fits.

    >>> shortened(iri("object", "knife"))
    'object:knife'
    """
    short = prefixed(Iri(node))
    return f"<{node}>" if short == str(node) else short


@lru_cache(maxsize=2**18)
def split(individual: Iri) -> tuple[str, str]:
    """Return the kind and name of an individual of Hilt, or ("", IRI) for other IRIs.

    >>> split(iri("object", "wine glass"))
    ('object', 'wine glass')
    """
    kind, _, local = individual.removeprefix(INDIVIDUALS).partition("/")
    if kind not in KINDS or not local:
        return "", str(individual)
    return kind, unquote(local.replace("_", " "))
