"""What is slow to make is kept in a file of the user's cache."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from hilt.ontology.disk_cache import kept, stamp_of

VALUE = {"a": [1, 2], "b": "text"}


def again() -> dict[str, object]:
    """Stands for what must not be made a second time."""
    raise AssertionError("made again")


def test_a_value_is_made_once(tmp_path: Path):
    """The next program reads it from the file."""
    path = tmp_path / "cache" / "value.pickle"

    assert kept(path, "1", VALUE.copy) == VALUE
    assert kept(path, "1", again) == VALUE


def test_another_stamp_makes_it_again(tmp_path: Path):
    """What it was made of has changed."""
    path = tmp_path / "value.pickle"
    kept(path, "1", VALUE.copy)

    assert kept(path, "2", lambda: {}) == {}
    assert kept(path, "2", again) == {}


@pytest.mark.parametrize(
    "damage",
    [
        lambda whole: whole[: len(whole) // 2],
        lambda whole: whole.replace(b"text", b"next"),
        lambda whole: b"-" + whole[1:],
        lambda _: b"",
        lambda _: b"\xff\xfe",
    ],
)
def test_a_damaged_file_is_ignored(tmp_path: Path, damage: Callable[[bytes], bytes]):
    """Half of it, a changed letter, another stamp, an empty file, and bytes that are no text."""
    path = tmp_path / "value.pickle"
    kept(path, "1", VALUE.copy)
    path.write_bytes(damage(path.read_bytes()))

    assert kept(path, "1", lambda: {}) == {}


def test_an_unwritable_place_is_no_error(tmp_path: Path):
    """The value is made again next time."""
    (tmp_path / "file").write_text("", encoding="utf-8")

    assert kept(tmp_path / "file" / "value.pickle", "1", VALUE.copy) == VALUE


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give")
def test_a_file_of_somebody_else_is_ignored(tmp_path: Path):
    """A pickle can run code."""
    path = tmp_path / "value.pickle"
    kept(path, "1", VALUE.copy)
    os.chown(path, 12345, -1)

    assert kept(path, "1", lambda: {}) == {}


def test_a_stamp_follows_the_files(tmp_path: Path):
    """Another size or time of a file, or another file, is another stamp."""
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_text("1", encoding="utf-8")
    other.write_text("1", encoding="utf-8")
    stamps = {stamp_of([one]), stamp_of([other]), stamp_of([one, other])}

    one.write_text("12", encoding="utf-8")

    assert len(stamps | {stamp_of([one])}) == 4
