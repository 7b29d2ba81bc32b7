"""Grammar and lexicon files: every wrong line is reported with its position."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.nlu import Language
from hilt.nlu.grammar.grammar import load_grammar
from hilt.ontology.errors import DataError

GRAMMAR = """\
categories:
  S: {type: t, means: "a statement"}
  NP: {type: e, means: "a thing"}
unary:
  - '%s'
roots: {%s: STATEMENT}
topic: NP
general: NP
answer: S
speaker: [S]
"""


def grammar_error(tmp_path: Path, unary: str, root: str = "S") -> str:
    """The error message for a grammar with this unary rule and this root."""
    path = tmp_path / "grammar.yaml"
    path.write_text(GRAMMAR % (unary, root), encoding="utf-8")
    predicates = tmp_path / "predicates.yaml"
    predicates.write_text("types: {sleeps: [e -> t]}", encoding="utf-8")
    with pytest.raises(DataError) as caught:
        load_grammar(path, degrees={}, predicates=predicates)
    return str(caught.value).replace(str(path), "grammar.yaml")


@pytest.mark.parametrize(
    ("unary", "message"),
    [
        ("NP => S : λx.x", "does not turn NP into S: expected t, but a variable gives e"),
        ("NP => VP : λx.x", 'the category "VP" is not declared; expected one of NP, S'),
        ("NP => S : λx.snores(x)", '"snores" is neither bound nor declared'),
        ("NP => NP : λx.x", "comes back to itself"),
        ("NP S : λx.x", 'found "S : λx.x"'),
    ],
)
def test_a_wrong_unary_rule_is_an_error(tmp_path: Path, unary: str, message: str) -> None:
    """File, line, column, and what was expected."""
    said = grammar_error(tmp_path, unary)

    assert said.startswith("grammar.yaml:5:")
    assert message in said


def test_a_root_category_has_type_t(tmp_path: Path) -> None:
    """A root has the type t."""
    said = grammar_error(tmp_path, "NP => S : λx.sleeps(x)", "NP")

    assert 'expected a category of type t, found "NP"' in said


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("words: [{says: [zap], is: ['C/NP : λx.x']}]", "C/NP : λx.x does not fit its category"),
        ("words: [{says: [zap], is: ['C/XX : λx.x']}]", 'the category "XX" is not declared'),
        ("words: [{says: ['(zap'], is: ['C : okay']}]", 'expected ")"'),
        ("classes: {XX: zap}", 'the category "XX" is not declared'),
        ("words: [{says: [zap]}]", 'expected the key "is" or "like"'),
        ("verbs: [{verb: zap, templates: [zapping]}]", 'use, found "zapping"'),
        ("nouns: {vegetable: [leek]}", 'unknown key "vegetable"; expected'),
        ("qualifiers: {huge: [hugely]}", '"huge" is no degree of confidence'),
        ("wurds: []", 'unknown key "wurds" (did you mean "words"?)'),
        (
            "templates: {t: {constants: {A: [e]}, forms: {dual: ['N : A']}}}",
            'unknown key "dual" (did you mean "plural"?)',
        ),
    ],
)
def test_a_wrong_line_of_a_lexicon_is_an_error(tmp_path: Path, line: str, message: str) -> None:
    """An additional lexicon is checked like the one of the language."""
    path = tmp_path / "own.yaml"
    path.write_text(line, encoding="utf-8")

    with pytest.raises(DataError) as caught:
        Language.load(extra_lexicon=path)

    assert message in str(caught.value)
    assert (caught.value.source, caught.value.line) == (str(path), 1)


def test_a_further_lexicon_adds_words(tmp_path: Path) -> None:
    """One line gives a verb all its frames and inflections."""
    path = tmp_path / "own.yaml"
    path.write_text(
        "verbs: [{verb: clutch, templates: [grasp], means: grasp}]\nnouns: {object: [whisk]}\n",
        encoding="utf-8",
    )

    language = Language.load(extra_lexicon=path)

    understood = language.understand("When passing whisks, clutch them by the handle")
    assert understood.meaning.as_json()["object"] == "whisk"
