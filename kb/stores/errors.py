"""Translation of the errors of pyoxigraph and of the file system into Hilt's own."""

import re
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from ...ontology.errors import DataError, HiltError, InUseError, QueryError, StoreError
from ..sparql.query_text import syntax_message
from .mark import MARKER_FILE

_REMOTE_CONTEXT = "LoadDocumentCallback"  # what pyoxigraph says of a JSON-LD context elsewhere
_NO_SPACE = "No space left"
_LOCK = re.compile(r"\block\b", re.IGNORECASE)  # but not a damaged block
_REFUSALS = ("Read-only file system", "Permission denied", "Operation not permitted")


@contextmanager
def translated_errors(location: str, text: str = "") -> Generator[None]:
    """Raise pyoxigraph's errors as StoreError or QueryError; `text` is the SPARQL it was given."""
    try:
        yield
    except HiltError:
        raise
    except (OSError, RuntimeError) as error:
        if _NO_SPACE in str(error):
            raise StoreError(
                f'The disk of the knowledge base "{location}" is full. The change was not '
                "written; all that was acknowledged is safe. Make room, and open the base again."
            ) from error
        raise StoreError(f'The knowledge base "{location}" failed: {_short(error)}') from error
    except (SyntaxError, ValueError) as error:
        raise QueryError(syntax_message(str(error), text)) from error


def open_error(folder: Path, error: Exception) -> StoreError:
    """The error that says why a folder cannot be opened, and what to do."""
    if isinstance(error, StoreError):
        return error
    if _NO_SPACE in str(error):
        return StoreError(
            f'The disk of the knowledge base "{folder}" is full, so it cannot be opened. All that '
            "was acknowledged is safe. Make room, and open it again."
        )
    is_there = (folder / MARKER_FILE).exists()
    if refused := next((each for each in _REFUSALS if each in str(error)), None):
        advice = "It can be read, exported and backed up." if is_there else "Name another folder."
        return StoreError(f'The base "{folder}" may not be written: {refused.lower()}. {advice}')
    if _LOCK.search(str(error).replace(str(folder), "")):
        return InUseError(str(folder))
    if is_there:
        return StoreError(
            f'The knowledge base "{folder}" is damaged or cannot be read: {_short(error)} '
            "Restore it from a backup or an export."
        )
    return StoreError(f'The knowledge base "{folder}" cannot be created: {_short(error)}')


def text_error(error: Exception, source: str, text: str = "") -> DataError:
    """The error that says what is wrong with an RDF text; `text` is the line with it."""
    if isinstance(error, MemoryError):
        return DataError("has a text or name of more than 16 MB.", source=source)
    if not isinstance(error, SyntaxError):
        return DataError(_short(error), source=source)
    problem = error.msg.partition(": ")[2] or error.msg  # the position stands before it
    if _REMOTE_CONTEXT in problem:
        problem = "a context from elsewhere is refused; write it into the file"
    if problem.startswith("Invalid UTF-8"):
        problem = "expected UTF-8 text"
    return DataError(
        problem.rstrip(".") + ".",
        source=source,
        line=error.lineno or 0,
        column=error.offset or 0,
        text=text.rstrip()[:500],
    )


def _short(error: Exception) -> str:
    text = getattr(error, "strerror", None) or str(error)
    return next(iter(text.strip().rstrip(".").splitlines()), type(error).__name__) + "."
