"""Claims about RDF text that is read group by group."""

from __future__ import annotations

import io

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.bulk.rdf_reader import StatementGroup, read_groups, read_quads
from hilt.kb.rdf.rule_mapping import BELIEFS, rule_quads
from hilt.kb.rdf.terms import Quad
from hilt.kb.rule import Rule
from hilt.kb.stores.rdf_text import write_rdf
from hilt.ontology.errors import DataError
from hilt.ontology.vocabulary import Iri

from ..strategies import rules

RULE = "<https://w3id.org/hilt/rule/0123456789abcdef>"
LOWER, DECIMAL = "<https://w3id.org/hilt#lower>", "<http://www.w3.org/2001/XMLSchema#decimal>"
GRAPH = "<https://w3id.org/hilt/graph/beliefs>"
GOOD = f'{RULE} {LOWER} "0.5"^^{DECIMAL} {GRAPH} .'


def read(text: bytes, form: str = "nquads") -> list[object]:
    """The statements of a text."""
    groups = read_groups(io.BytesIO(text), format=form, source="x", default=BELIEFS)
    return list(read_quads(groups))


@given(st.lists(rules, max_size=4), st.sampled_from(["nquads", "trig"]))
@settings(deadline=None)
def test_rules_are_read_as_they_were_written(some: list[Rule], form: str):
    """Every statement."""
    quads = [quad for rule in some for quad in rule_quads(rule)]

    assert set(read(write_rdf(quads, format=form), form)) == set(quads)


@pytest.mark.parametrize(
    ("line", "value", "graph"),
    [
        (f'{RULE} {LOWER} "Grüße" .', "Grüße", BELIEFS),
        (f"{RULE}\t{LOWER}   <urn:\\u0041> <urn:g>. # half", Iri("urn:A"), Iri("urn:g")),
        (f"{RULE} {LOWER} _:b <urn:g> .\r", Iri("_:b"), Iri("urn:g")),
    ],
)
def test_lines_may_have_any_form(line: str, value: object, graph: Iri):
    """Statements without a graph belong to the default."""
    rule = Iri(RULE[1:-1])

    assert read(f"# nothing\n\n{line}\n".encode()) == [Quad(rule, Iri(LOWER[1:-1]), value, graph)]  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "line",
    [
        f'"0.5"^^{DECIMAL} {LOWER} {RULE} {GRAPH} .',
        f'{RULE} "0.5"^^{DECIMAL} {RULE} {GRAPH} .',
        f'{RULE} {LOWER} "0.5"^^{DECIMAL} {GRAPH} ,',
        f'{RULE} {LOWER} "0.5 {GRAPH} .',
        f'{RULE} {LOWER} {LOWER} "0.5"^^{DECIMAL} {GRAPH} .',
        f"{RULE} {LOWER} <http://[> {GRAPH} .",
        f"{RULE} {LOWER} <https://w3id.org/hilt/object/caf%C> {GRAPH} .",
        f"<https://w3id.org/hilt/object/wine glass> {LOWER} {RULE} {GRAPH} .",
        f' {LOWER} "0.5"^^{DECIMAL} {GRAPH} .',
    ],
)
def test_wrong_lines_are_told_with_their_number(line: str):
    """And with what they say."""
    good = f"{GOOD}\n{RULE} {LOWER} {RULE} {GRAPH} .\n{GOOD.replace(RULE, '_:b')}\n"

    with pytest.raises(DataError) as error:
        read((good + line + "\n").encode())

    assert (error.value.line, error.value.text) == (4, line)


def test_an_endless_line_is_refused():
    """Before it fills the memory."""
    endless = b"<urn:" + b"a" * (17 * 2**20)

    with pytest.raises(DataError, match="more than 16 MB"):
        read(endless)


def test_other_encodings_are_refused():
    """Bytes that are no UTF-8."""
    with pytest.raises(DataError, match="expected UTF-8 text"):
        read(f'{RULE} {LOWER} "Gr\\u00fc'.encode() + b'\xff" .\n')


def test_comment_does_not_divide_what_is_said_of_a_subject():
    """Nor does a line in another form; another graph does."""
    other = GOOD.replace(GRAPH, "<urn:g>")
    text = "\n".join([GOOD, "# half", GOOD.replace(" ", "\t"), "", GOOD, other]).encode()

    groups = read_groups(io.BytesIO(text), format="nquads", source="x", default=BELIEFS)

    assert [len(group.pairs) for group in groups if isinstance(group, StatementGroup)] == [3, 1]
