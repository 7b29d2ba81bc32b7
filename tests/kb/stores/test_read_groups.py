"""Claims about RDF texts that are read: what is found, where it is wrong, and in which memory."""

from __future__ import annotations

import io

import pyoxigraph
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.rdf.rule_mapping import BELIEFS, rule_quads
from hilt.kb.rdf.terms import Quad, ReifyingTriple, StatementGroup, ungrouped
from hilt.kb.rule import Rule
from hilt.kb.stores import rdf_text
from hilt.kb.stores.rdf_text import RDF_FORMATS, quad_from_engine, read_groups, write_rdf
from hilt.ontology.errors import DataError

from ..strategies import rules

RULE = "<https://w3id.org/hilt/rule/0123456789abcdef>"
LOWER, DECIMAL = "<https://w3id.org/hilt#lower>", "<http://www.w3.org/2001/XMLSchema#decimal>"
GRAPH = "<https://w3id.org/hilt/graph/beliefs>"
GOOD = f'{RULE} {LOWER} "0.5"^^{DECIMAL} {GRAPH} .'


def read(text: bytes, form: str = "nquads") -> list[Quad | ReifyingTriple]:
    """The statements of a text."""
    groups = read_groups(io.BytesIO(text), format=form, source="x", default=BELIEFS)
    return list(ungrouped(groups))


def read_plain(text: bytes) -> list[Quad]:
    """The statements as the engine finds them, line by line."""
    found = (
        quad_from_engine(quad)
        for line in text.decode().splitlines()
        for quad in pyoxigraph.parse(line, format=pyoxigraph.RdfFormat.N_QUADS)
    )
    return [quad._replace(graph=quad.graph or BELIEFS) for quad in found]


@given(st.lists(rules, max_size=4), st.sampled_from(sorted(RDF_FORMATS)))
@settings(deadline=None)
def test_statements_of_rules_are_read_as_they_were_written(some: list[Rule], form: str):
    """Every statement, and its graph where the format has graphs."""
    quads = [quad for rule in some for quad in rule_quads(rule)]

    found = set(read(write_rdf(quads, format=form), form))

    if RDF_FORMATS[form].supports_datasets:
        assert found == set(quads)
    else:
        assert found == {quad._replace(graph=BELIEFS) for quad in quads}


@pytest.mark.parametrize(
    "line",
    [
        GOOD,
        f'{RULE} {LOWER} "0.12345"^^{DECIMAL} {GRAPH} .',
        f'{RULE} {LOWER} "0.5"^^{DECIMAL} .',
        f'{RULE} {LOWER} "0.5"^^{DECIMAL} <urn:g> .',
        f'# {LOWER} "0.5"^^{DECIMAL} {GRAPH} .',
        f" {GOOD}",
        f'{RULE}\t{LOWER}   "0.5"^^{DECIMAL} {GRAPH}. # half',
        f'{RULE} {LOWER} "+00.50"^^{DECIMAL} {GRAPH} .',
        f'{RULE} {LOWER} "nonsense"^^{DECIMAL} {GRAPH} .',
        f'{RULE} {LOWER} "a \\" {GRAPH} ." {GRAPH} .',
        f'{RULE} {LOWER} "a b c" .',
        f'{RULE} {LOWER} "a {GRAPH}" .',
        f'{RULE} {LOWER} "Grüße"@de {GRAPH} .',
        f"{RULE} {LOWER} <urn:\\u0041> {GRAPH} .",
        f"{RULE} {LOWER} {RULE} {GRAPH} .",
        f"{RULE} {LOWER} <https://w3id.org/hilt/object/wine_glass> {GRAPH} .",
        f"{RULE} {LOWER} <https://w3id.org/hilt/object/caf%C3%A9.1> <urn:g> .",
        f"{RULE} {LOWER} <https://w3id.org/hilt/object/café> {GRAPH} .",
        f"<https://w3id.org/hilt/object/wine_glass> {LOWER} {RULE} {GRAPH} .",
        f"<https://w3id.org/hilt/object/caf\\u00E9> {LOWER} {RULE} {GRAPH} .",
        f"_:b {LOWER} _:c {GRAPH} .",
        f"{RULE} {LOWER} {RULE} {GRAPH} .\r{RULE} {LOWER} {RULE} <urn:g> .",
        "# nothing",
        "",
    ],
)
def test_lines_in_any_form_are_read_as_the_engine_reads_them(line: str):
    """Also the second time."""
    text = f"{GOOD}\n{line}\n{line}\r\n{line}\n{GOOD}\n".encode()

    assert read(text) == read_plain(text)


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
    """And as they stand there."""
    good = f"{GOOD}\n{RULE} {LOWER} {RULE} {GRAPH} .\n{GOOD.replace(RULE, '_:b')}\n"

    with pytest.raises(DataError) as error:
        read((good + line + "\n").encode())

    assert (error.value.line, error.value.text) == (4, line)


def test_missing_end_is_told_where_something_else_begins():
    """The next statement, which is shown."""
    with pytest.raises(DataError, match="x:2:1: Quads must be followed by a dot") as error:
        read(f"{GOOD.removesuffix(' .')}\n{GOOD}\n".encode())

    assert error.value.text == GOOD


@pytest.mark.parametrize("size", range(1, 300, 23))
def test_chunks_may_end_anywhere(size: int, monkeypatch: pytest.MonkeyPatch):
    """Also within a line, and within a character."""
    monkeypatch.setattr(rdf_text, "_CHUNK", size)
    text = f'{RULE} {LOWER} "Grüße" {GRAPH} .\n{RULE} {LOWER} "0.5"^^{DECIMAL} {GRAPH} .'.encode()

    assert read(text) == read_plain(text)


class Pipe(io.BytesIO):
    """A stream that is read once."""

    def seek(self, offset: int, whence: int = 0) -> int:
        """Refuse to go back."""
        raise io.UnsupportedOperation


def test_wrong_line_is_shown_however_far_in_a_stream_it_is():
    """Though it cannot be read again."""
    stream = Pipe(f"{GOOD}\n".encode() * 5_000 + b"nonsense\n" + f"{GOOD}\n".encode() * 5_000)

    with pytest.raises(DataError) as error:
        list(read_groups(stream, format="nquads", source="x", default=BELIEFS))

    assert (error.value.line, error.value.text) == (5_001, "nonsense")


def test_line_that_was_read_long_ago_is_not_shown():
    """Its number is."""
    endless = f"{RULE} {LOWER}\n".encode() + b" " * 2**21 + b"?"

    with pytest.raises(DataError) as error:
        read(endless, "turtle")

    assert error.value.line == 2


def test_an_endless_line_is_refused():
    """Before it fills the memory."""
    endless = b"<urn:" + b"a" * (17 * 2**20)

    with pytest.raises(DataError, match="more than 16 MB"):
        read(endless)


def test_other_encodings_are_refused():
    """Bytes that are no UTF-8."""
    with pytest.raises(DataError, match=r"x:1:\d+: expected UTF-8 text"):
        read(f'{RULE} {LOWER} "Gr\\u00fc'.encode() + b'\xff" .\n')


def test_comment_does_not_divide_what_is_said_of_a_subject():
    """Nor does a line in another form; another graph does."""
    other = GOOD.replace(GRAPH, "<urn:g>")
    text = "\n".join([GOOD, "# half", GOOD.replace(" ", "\t"), "", GOOD, other]).encode()

    groups = read_groups(io.BytesIO(text), format="nquads", source="x", default=BELIEFS)

    assert [len(group.pairs) for group in groups if isinstance(group, StatementGroup)] == [3, 1]
