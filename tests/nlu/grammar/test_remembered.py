# SPDX-License-Identifier: Apache-2.0
"""Lines of the notation are read once, and recalled by the next program as they were read."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hilt.nlu.grammar.reader import Start, read
from hilt.nlu.grammar.remembered import NotationCache

LINES: list[tuple[Start, str]] = [
    ("entry", "(S\\^NP)/^(NP/N) : λx.λy.implies(x,y(x),high) @-1.5"),
    ("unary", "R => S : λr.r(high)"),
    ("rule", "INSTRUCT(A,B,X) => want(A,X)"),
    ("category", "NP"),
    ("term", "(λx.λf.f(x))(knife)"),
    ("type", "(e -> t) -> e -> t"),
]


def kept(path: Path) -> Path:
    """The file, once all lines were read and kept."""
    lines = NotationCache(path)
    for start, text in LINES:
        lines.add(text, start, read(text, start))
    lines.keep()
    return path


@pytest.mark.parametrize(("start", "text"), LINES)
def test_what_is_recalled_is_what_was_read(tmp_path: Path, start: Start, text: str) -> None:
    """Also the names of variables, which only show in print."""
    recalled, made = (
        NotationCache(kept(tmp_path / "lines.json")).recall(text, start),
        read(text, start),
    )

    assert recalled == made
    assert str(recalled) == str(made)


@pytest.mark.parametrize(
    "spoilt",
    [
        lambda whole: whole[: len(whole) // 2],
        lambda whole: whole.replace(b"high", b"none"),
        lambda whole: b"0" + whole[1:],
        lambda _: b"",
        lambda _: b"\xff\xfe",
    ],
)
def test_a_file_that_is_not_whole_counts_for_nothing(tmp_path: Path, spoilt: object) -> None:
    """Half of it, another version, a changed letter, nothing, and no text."""
    path = kept(tmp_path / "lines.json")
    assert callable(spoilt)
    path.write_bytes(spoilt(path.read_bytes()))

    assert [NotationCache(path).recall(text, start) for start, text in LINES] == [None] * len(LINES)


def test_no_place_to_keep_lines_is_no_error(tmp_path: Path) -> None:
    """They are read again next time."""
    (tmp_path / "file").write_text("", encoding="utf-8")

    path = kept(tmp_path / "file" / "lines.json")

    assert not path.exists()


def test_lines_that_are_no_longer_used_are_dropped(tmp_path: Path) -> None:
    """When a new one comes, so that the file does not grow for ever."""
    path = kept(tmp_path / "lines.json")
    lines = NotationCache(path)
    lines.recall("NP", "category")
    lines.add("N", "category", read("N", "category"))
    lines.keep()

    again = NotationCache(path)

    assert again.recall("NP", "category")
    assert again.recall("N", "category")
    assert again.recall("(λx.λf.f(x))(knife)", "term") is None


def test_a_language_loaded_before_needs_no_parser(tmp_path: Path) -> None:
    """The second program does not even import it, and understands the same."""
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
