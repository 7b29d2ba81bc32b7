"""What is slow to make is kept in the user's cache for the next program."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hilt.ontology.disk_cache import kept

VALUE: dict[str, Any] = {"a": [1, 2], "b": "text"}
OTHER: dict[str, Any] = {}


@pytest.fixture(autouse=True)
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file that the value is made of, beside a cache of its own for each test."""
    monkeypatch.setenv("HILT_CACHE", str(tmp_path / "cache"))
    path = tmp_path / "source.yaml"
    path.write_text("1", encoding="utf-8")
    return path


def keep(source: Path, make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """The value, made of the source."""
    return kept("value", [source], make)


def file_of(source: Path) -> Path:
    """The file of the cache with the value."""
    assert keep(source, VALUE.copy) == VALUE
    (path,) = (source.parent / "cache").glob("value-*.pickle")
    return path


def again() -> dict[str, Any]:
    """Stands for what must not be made a second time."""
    raise AssertionError("made again")


def test_a_value_is_made_once(source: Path):
    """The next program reads it from the file."""
    keep(source, VALUE.copy)

    assert keep(source, again) == VALUE


def test_a_changed_file_makes_it_again(source: Path):
    """The value of before is not kept."""
    path = file_of(source)
    source.write_text("12", encoding="utf-8")

    assert keep(source, OTHER.copy) == OTHER
    assert keep(source, again) == OTHER
    assert [*path.parent.iterdir()] == [path]


def _half(whole: bytes) -> bytes:
    return whole[: len(whole) // 2]


def _changed(whole: bytes) -> bytes:
    return whole.replace(b"text", b"next")


def _other_head(whole: bytes) -> bytes:
    return b"-" + whole[1:]


@pytest.mark.parametrize("damage", [_half, _changed, _other_head, lambda _: b"", lambda _: b"\xff"])
def test_a_damaged_file_is_ignored(source: Path, damage: Callable[[bytes], bytes]):
    """Half of it, a changed letter, another head, an empty file, and bytes that are no text."""
    path = file_of(source)
    path.write_bytes(damage(path.read_bytes()))

    assert keep(source, OTHER.copy) == OTHER


def test_an_unwritable_cache_is_no_error(source: Path, monkeypatch: pytest.MonkeyPatch):
    """The value is made again next time."""
    monkeypatch.setenv("HILT_CACHE", str(source / "cache"))

    assert keep(source, VALUE.copy) == VALUE


@pytest.mark.skipif(os.name == "nt", reason="files have no owner of this kind")
def test_only_the_user_may_read_and_write_it(source: Path):
    """A pickle can run code."""
    assert not file_of(source).stat().st_mode & 0o077


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give")
def test_a_file_of_somebody_else_is_ignored(source: Path):
    """It could run any code of theirs."""
    os.chown(file_of(source), 12345, -1)

    assert keep(source, OTHER.copy) == OTHER
