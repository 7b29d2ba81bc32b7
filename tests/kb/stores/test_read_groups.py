"""Claims about the fast reader of lines: it finds what the engine's parser finds."""

from __future__ import annotations

import io
from collections.abc import Iterator
from functools import partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.bulk.nquads_reader import (
    LineReader,
    StatementGroup,
    Statements,
    read_groups,
    read_quads,
)
from hilt.kb.rdf.rule_mapping import BELIEFS, rule_quads
from hilt.kb.rdf.terms import Quad
from hilt.kb.rule import Rule
from hilt.kb.stores.rdf_text import read_line, write_rdf
from hilt.ontology.errors import DataError

from ..strategies import rules

RULE = "<https://w3id.org/hilt/rule/0123456789abcdef>"
LOWER, DECIMAL = "<https://w3id.org/hilt#lower>", "<http://www.w3.org/2001/XMLSchema#decimal>"
GRAPH = "<https://w3id.org/hilt/graph/beliefs>"
GOOD = f'{RULE} {LOWER} "0.5"^^{DECIMAL} {GRAPH} .'


def read_fast(text: bytes, form: str = "nquads") -> list[Quad]:
    """The statements as the fast reader finds them."""
    groups = read_groups(io.BytesIO(text), format=form, source="x", default=BELIEFS)
    return list(read_quads(groups))


def read_plain(text: bytes, form: str = "nquads") -> list[object]:
    """The statements as the engine finds them."""
    read = partial(read_line, format=form, source="x", default=BELIEFS, number=0)
    return [quad for line in text.decode().splitlines() for quad in read(line)]


@given(st.lists(rules, max_size=4), st.sampled_from(["nquads", "ntriples"]))
@settings(deadline=None)
def test_rules_are_read_as_the_engine_reads_them(some: list[Rule], form: str):
    """Every statement, in its order."""
    text = write_rdf([quad for rule in some for quad in rule_quads(rule)], format=form)

    assert read_fast(text, form) == read_plain(text, form)


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
    """Also the second time, when their terms are remembered."""
    text = f"{GOOD}\n{line}\n{line}\r\n{line}\n{GOOD}\n".encode()

    assert read_fast(text) == read_plain(text)


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
        f"{RULE} {LOWER} {GRAPH}",
    ],
)
def test_wrong_lines_are_told_with_their_number(line: str):
    """Although the terms of the lines before are remembered."""
    good = f"{GOOD}\n{RULE} {LOWER} {RULE} {GRAPH} .\n{GOOD.replace(RULE, '_:b')}\n"

    with pytest.raises(DataError) as error:
        read_fast((good + line + "\n").encode())

    assert (error.value.line, error.value.text) == (4, line)


@given(st.integers(1, 400))
@settings(deadline=None)
def test_chunks_may_end_anywhere(size: int):
    """Also within a line, and within a character."""
    text = f'{RULE} {LOWER} "Grüße" {GRAPH} .\n{RULE} {LOWER} "0.5"^^{DECIMAL} {GRAPH} .'.encode()
    reader = LineReader(format="nquads", source="x", default=BELIEFS)

    def read() -> Iterator[Statements]:
        for start in range(0, len(text), size):
            yield from reader.feed(text[start : start + size])
        yield from reader.finish()

    assert list(read_quads(read())) == read_plain(text)


def test_an_endless_line_is_refused():
    """Before it fills the memory."""
    endless = b"<urn:" + b"a" * (17 * 2**20)

    with pytest.raises(DataError, match="more than 16 MB"):
        read_fast(endless)


def test_other_encodings_are_refused():
    """Bytes that are no UTF-8."""
    with pytest.raises(DataError, match="expected UTF-8 text"):
        read_fast(f'{RULE} {LOWER} "Gr\\u00fc'.encode() + b'\xff" .\n')


def test_comment_does_not_divide_what_is_said_of_a_subject():
    """Nor does a line in another form; another graph does."""
    other = GOOD.replace(GRAPH, "<urn:g>")
    text = "\n".join([GOOD, "# half", GOOD.replace(" ", "\t"), "", GOOD, other]).encode()

    groups = read_groups(io.BytesIO(text), format="nquads", source="x", default=BELIEFS)

    assert [len(group.pairs) for group in groups if isinstance(group, StatementGroup)] == [3, 1]
