"""Ontologies of others beside the rules: any RDF in a named graph of its own, kept as it is.

Blank nodes get names (RDF 1.1, section 3.5), the same whenever the same file is read. OWL in
functional syntax and in XML is converted by py-horned-owl where that is installed. Tables of edges
(start, relation, end; those of ConceptNet too) become statements.
"""

import csv
import io
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO, cast
from urllib.parse import quote

from ...ontology.errors import DataError, extra_required
from ...ontology.vocabulary import INDIVIDUALS, Iri, external, ontology_graph, prefixed
from ..history import import_utterance
from ..knowledge_base import KnowledgeBase
from ..rdf.rule_mapping import LABEL, TYPE
from ..rdf.terms import Literal, Quad, Term, is_blank, ungrouped
from ..stores.rdf_text import read_groups
from ..writer import to_milliseconds
from .file_streams import open_input
from .registry import FileFormat, format_of

_MOST = 256 * 2**20  # bytes that are read
_OWL = {".ofn": "ofn", ".owx": "owx"}
_TABLES = {".csv": ",", ".tsv": "\t"}
_FUNCTIONAL = re.compile(rb"\s*(Prefix|Ontology)\s*\(")
_CONCEPTNET = "http://conceptnet.io"
_RELATIONS = {
    **dict.fromkeys(("isa", "subclassof", "kindof"), external("rdfs:subClassOf")),
    **dict.fromkeys(("sameas", "synonym"), external("owl:sameAs")),
}


@dataclass(frozen=True)
class OntologySummary:
    """What the import of an ontology changed: its graph, and statements that came and went."""

    graph: Iri
    statements: int
    added: int
    removed: int

    def as_json(self) -> dict[str, object]:
        """The summary as `hilt import --json` prints it."""
        return {**vars(self), "graph": prefixed(self.graph)}


def import_ontology(
    base: KnowledgeBase,
    file: str,
    *,
    name: str | None = None,
    format: str | None = None,
    dry_run: bool = False,
) -> OntologySummary:
    """Make a file the content of the graph `ontology.NAME`, by default that of the file's name.

    A file without statements removes the graph. DataError if it cannot be read; nothing changes.
    """
    graph = ontology_graph(name or Path(file).name.partition(".")[0])
    if new := set(_named(_read(file, format, graph), graph)):
        new.add(Quad(graph, TYPE, external("owl:Ontology"), graph))
    with base.store.writing():
        old = set(base.store.quads(None, None, None, graph))
        if new != old and not dry_run:
            time = to_milliseconds(base.clock())
            said = import_utterance(file, base.sequence + 1, time, some=f" as {prefixed(graph)}")
            base.write(said, [], insert=new - old, delete=old - new)
    return OntologySummary(graph, len(new), len(new - old), len(old - new))


def _read(file: str, given: str | None, graph: Iri) -> Iterator[Quad]:
    suffix = Path(file.lower().removesuffix(".gz")).suffix
    if given is None and suffix in _TABLES:
        with open_input(file, FileFormat("table", (suffix,))) as source:
            yield from _edges(source.lines(), _TABLES[suffix], graph)
        return
    if given is None and suffix in _OWL:
        chosen = FileFormat(_OWL[suffix], (suffix,), most=_MOST, is_xml=suffix == ".owx")
    else:
        chosen = format_of(file, given, "turtle")
    with open_input(file, chosen) as source:
        stream, form = cast(BinaryIO, source), chosen.name.removesuffix("12")
        if chosen.name in _OWL.values() or chosen.name == "rdfxml":
            data = source.readall()
            form = "ofn" if _FUNCTIONAL.match(data) else form
            if form != "rdfxml":
                with extra_required("owl", "py-horned-owl"):
                    library = import_module("pyhornedowl")
                try:
                    ontology = library.open_ontology_from_string(data.decode(), form)
                    data = ontology.save_to_string("owl").encode()
                except (ValueError, UnicodeDecodeError) as error:
                    raise DataError(f"cannot be read: {error}", source=file) from error
            stream, form = io.BytesIO(data), "rdfxml"
        for one in ungrouped(read_groups(stream, format=form, source=file, default=graph)):
            if not isinstance(one, Quad):
                raise DataError("statements about statements (RDF 1.2) are not kept.", source=file)
            yield one


def _named(quads: Iterable[Quad], graph: Iri) -> Iterator[Quad]:
    names: dict[str, Iri] = {}
    start = f"{INDIVIDUALS}.well-known/genid/{graph.rpartition('/')[2]}/"

    def named(value: Any) -> Any:
        if is_blank(value):
            return names.setdefault(str(value), Iri(f"{start}{len(names) + 1}"))
        return value

    for subject, predicate, value, _ in quads:
        yield Quad(named(subject), predicate, named(value), graph)


def _edges(lines: Iterable[str], delimiter: str, graph: Iri) -> Iterator[Quad]:
    for row in csv.reader(lines, delimiter=delimiter, quoting=csv.QUOTE_MINIMAL):
        if row and row[0].startswith("/a/"):  # of ConceptNet
            relation, start, end = row[1:4]
        else:
            start, relation, end = ([one.strip() for one in row] + ["", "", ""])[:3]
        if not start or start.lower() in {"start", "subject", "source"}:
            continue
        for text in (start, end):
            yield Quad(_node(text, graph), LABEL, _label(text), graph)
        key = re.sub(r"[\W_]+", "", relation.rpartition("/")[2]).lower()
        known = _RELATIONS.get(key.rpartition("#")[2], _node(relation, graph))
        yield Quad(_node(start, graph), known, _node(end, graph), graph)


def _node(text: str, graph: Iri) -> Iri:
    if "://" in text:
        return Iri(quote(text, safe=":/#?&=%~@+,;!$'()*-._"))
    return Iri(f"{_CONCEPTNET if text.startswith('/') else f'{graph}/'}{quote(text)}")


def _label(text: str) -> Term:
    parts = text.split("/")
    if text.startswith("/c/") and len(parts) > 3:
        return Literal(parts[3].replace("_", " "), language=parts[2])
    return re.split(r"[/#]", text)[-1].replace("_", " ")
