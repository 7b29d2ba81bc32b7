# SPDX-License-Identifier: Apache-2.0
"""Parsed lines of the notation are saved, and the next program gets them as they were parsed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hilt.nlu.grammar.categories import AtomicCategory
from hilt.nlu.grammar.notation_cache import NotationCache
from hilt.nlu.grammar.notation_parser import Start, parse
from hilt.ontology.yaml_reader import Field

LINES: list[tuple[Start, str]] = [
    ("entry", "(S\\^NP)/^(NP/N) : λx.λy.implies(x,y(x),high) @-1.5"),
    ("unary", "R => S : λr.r(high)"),
    ("rule", "INSTRUCT(A,B,X) => want(A,X)"),
    ("category", "NP"),
    ("term", "(λx.λf.f(x))(knife)"),
    ("type", "(e -> t) -> e -> t"),
]


def read(text: str, start: Start) -> object:
    """The value of a line, by the parser."""
    return parse(Field(text, "<test>", 1, 0), start)


def saved(path: Path) -> Path:
    """The file, once all lines were parsed and saved."""
    lines = NotationCache(path)
    for start, text in LINES:
        lines.add(text, start, parse(Field(text, "<test>", 1, 0), start))
    lines.save()
    return path


@pytest.mark.parametrize(("start", "text"), LINES)
def test_cached_value_equals_parsed_value(tmp_path: Path, start: Start, text: str) -> None:
    """The names of variables are the same too, which only show in print."""
    cached = NotationCache(saved(tmp_path / "lines.json")).get(text, start)

    assert cached == read(text, start)
    assert str(cached) == str(read(text, start))


@pytest.mark.parametrize(
    "damage",
    [
        lambda whole: whole[: len(whole) // 2],
        lambda whole: whole.replace(b"high", b"none"),
        lambda whole: b"0" + whole[1:],
        lambda _: b"",
        lambda _: b"\xff\xfe",
    ],
)
def test_damaged_file_is_ignored(tmp_path: Path, damage: object) -> None:
    """Half of it, a changed letter, another version, an empty file, and bytes that are no text."""
    path = saved(tmp_path / "lines.json")
    assert callable(damage)
    path.write_bytes(damage(path.read_bytes()))

    assert [NotationCache(path).get(text, start) for start, text in LINES] == [None] * len(LINES)


def test_unwritable_place_is_no_error(tmp_path: Path) -> None:
    """The lines are parsed again next time."""
    (tmp_path / "file").write_text("", encoding="utf-8")

    path = saved(tmp_path / "file" / "lines.json")

    assert not path.exists()


def test_unused_lines_are_dropped(tmp_path: Path) -> None:
    """They go when a new line is saved, so that the file does not grow for ever."""
    path = saved(tmp_path / "lines.json")
    lines = NotationCache(path)
    lines.get("NP", "category")
    lines.add("N", "category", AtomicCategory("N"))
    lines.save()

    again = NotationCache(path)

    assert again.get("NP", "category")
    assert again.get("N", "category")
    assert again.get("(λx.λf.f(x))(knife)", "term") is None


def test_a_language_loaded_before_needs_no_parser(tmp_path: Path) -> None:
    """The second program does not import it, and understands the same."""
    program = (
        "import sys; from hilt.nlu import Language;"
        "said = Language.load().understand('To pass a knife grab it by the blade');"
        "print('lark' in sys.modules, said.semantics)"
    )
    environment = os.environ | {"HILT_CACHE": str(tmp_path)}

    first, second = (
        subprocess.run(
            [sys.executable, "-c", program],
            env=environment, capture_output=True, text=True, check=True,
        ).stdout.split(maxsplit=1)
        for _ in range(2)
    )  # fmt: skip

    assert (first[0], second[0]) == ("True", "False")
    assert first[1] == second[1]
