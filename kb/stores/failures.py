# SPDX-License-Identifier: Apache-2.0
"""What the engine says when something fails, told as ours."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import BinaryIO

from ...ontology.errors import DataError, HiltError, InUseError, QueryError, StoreError
from ..sparql.text import syntax_problem
from .directory import MARK

_MAX_LINE = 2**20  # bytes of a line that are looked at
_REMOTE_CONTEXT = "LoadDocumentCallback"  # what the engine says of one
_NO_SPACE = "No space left"
_REFUSALS = ("Read-only file system", "Permission denied", "Operation not permitted")


@contextmanager
def reported(location: str, text: str = "") -> Generator[None]:
    """Turn the engine's errors into ours; `text` is the SPARQL that it was given."""
    try:
        yield
    except HiltError:
        raise
    except (OSError, RuntimeError) as error:
        if _NO_SPACE in str(error):
            raise StoreError(
                f'The disk of the knowledge base "{location}" is full. This was not written; all '
                "that was acknowledged is safe. Make room, and open the base again."
            ) from error
        raise StoreError(f'The knowledge base "{location}" failed: {_short(error)}') from error
    except (SyntaxError, ValueError) as error:
        raise QueryError(syntax_problem(str(error), text)) from error


@contextmanager
def reading_text(source: str) -> Generator[None]:
    """What goes wrong while a text is read, told as ours."""
    try:
        yield
    except MemoryError as error:
        raise DataError("has a text or name of more than 16 MB.", source=source) from error
    except UnicodeDecodeError as error:
        raise DataError("expected UTF-8 text.", source=source) from error
    except (ValueError, OSError) as error:
        if isinstance(error, HiltError):
            raise
        raise DataError(_short(error), source=source) from error


def open_error(folder: Path, error: Exception) -> StoreError:
    """Why a folder cannot be opened, and what to do."""
    if isinstance(error, StoreError):
        return error
    if _NO_SPACE in str(error):
        return StoreError(
            f'The disk of the knowledge base "{folder}" is full, so it cannot be opened. All that '
            "was acknowledged is safe. Make room, and open it again."
        )
    refused = next((each for each in _REFUSALS if each in str(error)), None)
    if refused:
        is_there = (folder / MARK).exists()
        hope = "It can be read, exported and backed up." if is_there else "Name another folder."
        return StoreError(
            f'The knowledge base "{folder}" may not be written: {refused.lower()}. {hope}'
        )
    if "lock" in str(error).replace(str(folder), "").lower():
        return InUseError(str(folder))
    if (folder / MARK).exists():
        return StoreError(
            f'The knowledge base "{folder}" is damaged or cannot be read: {_short(error)} '
            "Restore it from a backup or an export."
        )
    return StoreError(f'The knowledge base "{folder}" cannot be created: {_short(error)}')


def syntax_error(error: SyntaxError, source: str, text: str, line: int = 0) -> DataError:
    """What is wrong with a text; `line` where the engine was given that one only."""
    problem = error.msg.partition(": ")[2] or error.msg  # the position stands before it
    if _REMOTE_CONTEXT in problem:
        problem = "a context from elsewhere is refused; write it into the file"
    return DataError(
        problem.rstrip(".") + ".",
        source=source,
        line=line or error.lineno or 0,
        column=error.offset or 0,
        text=text.rstrip()[:500],
    )


def line_of(stream: BinaryIO, number: int) -> str:
    """A line of what was read, where the stream can go back to it."""
    if not number or not stream.seekable():
        return ""
    stream.seek(0)
    text = next(islice(iter(lambda: stream.readline(_MAX_LINE), b""), number - 1, None), b"")
    return text.decode("utf-8", "replace")


def _short(error: Exception) -> str:
    text = getattr(error, "strerror", None) or str(error)
    return next(iter(text.strip().rstrip(".").splitlines()), type(error).__name__) + "."
