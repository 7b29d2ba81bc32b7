# SPDX-License-Identifier: Apache-2.0
"""Bases and rules as files: Turtle for the rules, TriG and N-Quads for the whole base.

What is read is checked first, by SHACL and by the laws of intervals and rules, and applied whole
or not at all. Reading the same file twice changes nothing the second time. Two bases that know
the same write the same text, so exports can be compared line by line.
"""

from __future__ import annotations

import os
import sys
import tempfile
from itertools import islice
from pathlib import Path

from ..ontology.errors import DataError, ValidationError
from ..ontology.vocabulary import GRAPH_NAMES, Iri, iri, shortened, split, term
from . import stars
from .beliefs import KnowledgeBase
from .episodes import EPISODES
from .history import HISTORY
from .merging import LEXICON, Merged, merge
from .recall import BASE_GRAPH, Recall
from .stars import BELIEFS, TYPE
from .store import Store
from .terms import Quad, as_sparql
from .validation import Finding, lawful, refuse, rule_nodes, shapes

STREAM = "-"  # standard input or output
SUFFIXES = {".ttl": "turtle", ".trig": "trig", ".nq": "nquads", ".nt": "ntriples"}
RULES_ONLY = frozenset({"turtle", "ntriples"})  # formats without named graphs
MAX_SHACL = 200_000  # statements; SHACL on more takes minutes, and the laws find the same
WRONG_NAME = "A rule is a node rule:ID"  # how that message of shapes.ttl begins

# Where a node of a class belongs when a format has no graphs.
_GRAPHS = {
    "Utterance": HISTORY,
    "Episode": EPISODES,
    "Step": EPISODES,
    "Word": LEXICON,
    "Base": BASE_GRAPH,
}
_KNOWN_GRAPHS = frozenset(iri("graph", name) for name in GRAPH_NAMES)


def export_file(base: KnowledgeBase, file: str | Path, *, format: str | None = None) -> int:  # noqa: A002
    """Write the rules (turtle, ntriples) or the whole base (trig, nquads) to a file.

    Args:
        base: what is written.
        file: its extension names the format; "-" is standard output.
        format: one of `SUFFIXES`' formats; by default that of the file, turtle for "-".

    Returns:
        How many statements were written.

    Raises:
        DataError: the format is unknown or the file cannot be written.
    """
    chosen = _format(str(file), format, "turtle")
    quads = export_quads(base.store, rules_only=chosen in RULES_ONLY)
    _write(str(file), write_text(quads, format=chosen))
    return len(quads)


def import_file(base: KnowledgeBase, file: str | Path, *, format: str | None = None) -> int:  # noqa: A002
    """Read rules or a whole base from a file; see `import_text`.

    Args:
        base: what is written to.
        file: its extension names the format; "-" is standard input.
        format: one of `SUFFIXES`' formats; by default that of the file, trig for "-".

    Returns:
        How many statements were read.
    """
    chosen = _format(str(file), format, "trig")
    data = _read(str(file))
    return import_text(base, data, format=chosen, source=str(file)).statements


def import_text(
    base: KnowledgeBase,
    data: bytes,
    *,
    format: str,  # noqa: A002
    source: str = "<text>",
    dry_run: bool = False,
) -> Merged:
    """Take over the rules and history of an RDF text: checked first, applied whole or not at all.

    Args:
        base: what is written to.
        data: the text in UTF-8.
        format: turtle, trig, nquads or ntriples.
        source: its name, for messages and the history.
        dry_run: only say what would come of it.

    Raises:
        DataError: the text cannot be parsed; says where.
        ValidationError: it breaks the shapes or laws; the base is unchanged.
    """
    staging = stage(data, format=format, source=source)
    try:
        refuse(findings(staging))
        return merge(base, Recall(staging), source=source, dry_run=dry_run)
    finally:
        staging.close()


def stage(data: bytes, *, format: str, source: str) -> Store:  # noqa: A002
    """The statements of a text in a store of their own, each in the graph where it belongs.

    Raises:
        DataError: the text cannot be parsed, or has graphs that a base has not.
    """
    from .oxigraph import load_rdf

    staging = load_rdf(data, format=format, source=source, default=BELIEFS)
    foreign = {quad.graph for quad in staging.quads() if quad.graph not in _KNOWN_GRAPHS}
    if foreign:
        raise DataError(
            f"the graph {shortened(str(min(map(str, foreign))))} is none of a base's; expected "
            f"{', '.join(sorted(map(shortened, _KNOWN_GRAPHS)))}.",
            source=source,
        )
    _sort(staging)
    _rename(staging)
    return staging


def findings(staging: Store) -> list[Finding]:
    """Everything that is wrong with what was staged."""
    few = sum(1 for _ in islice(staging.quads(), MAX_SHACL + 1)) <= MAX_SHACL
    found = [*(shapes(staging) if few else ()), *lawful(staging)]
    # A rule that a person named could not be given its own name because something else is wrong.
    more = {finding.node for finding in found if not finding.problem.startswith(WRONG_NAME)}
    return [
        finding
        for finding in found
        if finding.node not in more or not finding.problem.startswith(WRONG_NAME)
    ]


def export_quads(store: Store, *, rules_only: bool) -> list[Quad]:
    """The statements of an export, sorted so that equal bases give equal lists."""
    if not rules_only:
        return sorted(store.quads(), key=_order)
    beliefs = list(store.quads(None, None, None, BELIEFS))
    sources = {quad.object for quad in beliefs if quad.predicate == stars.DERIVED_FROM}
    said = (quad for quad in store.quads(None, None, None, HISTORY) if quad.subject in sources)
    return sorted((*beliefs, *said), key=_order)


def write_text(quads: list[Quad], *, format: str) -> bytes:  # noqa: A002
    """Statements as text in UTF-8."""
    from .oxigraph import write_rdf

    return write_rdf(quads, format=format)


def _sort(staging: Store) -> None:
    """Move what a format without graphs has put among the beliefs to where it belongs."""
    places = {
        typed.subject: graph
        for name, graph in _GRAPHS.items()
        for typed in staging.quads(None, TYPE, term(name), BELIEFS)
    }
    moved = [q for node in places for q in staging.quads(node, None, None, BELIEFS)]
    there = [quad._replace(graph=places[quad.subject]) for quad in moved]
    staging.apply(insert=there, delete=moved)


def _rename(staging: Store) -> None:
    """Give rules that a person named (rule:1) the names that their content makes."""
    names: dict[Iri, Iri] = {}
    for node in rule_nodes(staging):
        try:
            rule = stars.read_rule(staging.properties(node, BELIEFS))
        except ValidationError:
            continue  # validation will say it
        if stars.rule_iri(rule.id) != node:
            names[node] = stars.rule_iri(rule.id)
    if names:
        old = [q for q in staging.quads() if q.subject in names or q.object in names]
        staging.apply(insert=[_renamed(quad, names) for quad in old], delete=old)


def _renamed(quad: Quad, names: dict[Iri, Iri]) -> Quad:
    value = quad.object
    return quad._replace(
        subject=names.get(quad.subject, quad.subject),
        object=names.get(value, value) if isinstance(value, Iri) else value,
    )


def _order(quad: Quad) -> tuple[str, str, str, str, str]:
    kind, _ = split(quad.subject)
    first = "" if quad.predicate == TYPE else quad.predicate
    return (str(quad.graph), kind, str(quad.subject), str(first), as_sparql(quad.object))


def _format(file: str, given: str | None, default: str) -> str:
    known = sorted(set(SUFFIXES.values()))
    if given is not None:
        if given not in known:
            raise DataError(f'unknown format "{given}"; known: {", ".join(known)}.', source=file)
        return given
    if file == STREAM:
        return default
    suffix = Path(file).suffix.lower()
    if suffix not in SUFFIXES:
        raise DataError(
            f'the extension "{suffix}" names no format; expected {", ".join(SUFFIXES)}.',
            source=file,
        )
    return SUFFIXES[suffix]


def _read(file: str) -> bytes:
    if file == STREAM:
        return sys.stdin.buffer.read()
    try:
        return Path(file).read_bytes()
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}.", source=file) from error


def _write(file: str, text: bytes) -> None:
    if file == STREAM:
        sys.stdout.buffer.write(text)
        sys.stdout.buffer.flush()
        return
    try:
        _replace_file(Path(file), text)
    except OSError as error:
        raise DataError(f"cannot be written: {error.strerror}.", source=file) from error


def _replace_file(file: Path, text: bytes) -> None:
    """Write beside the file and then put it in its place, so that it is never half written."""
    handle, name = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(text)
        Path(name).chmod(0o644)
        Path(name).replace(file)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
