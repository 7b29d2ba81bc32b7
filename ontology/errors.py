# SPDX-License-Identifier: Apache-2.0
"""Everything that Hilt raises on purpose.

    HiltError
    ├── DataError (ValueError)           a file or text that Hilt reads is wrong, and where
    ├── IntervalError (ValueError)       numbers that are no interval [lower, upper]
    ├── ConflictError (ValueError)       sources that contradict each other fully
    ├── UnknownNameError (LookupError)   a name that nothing answers to; lists those that do
    │   └── NotFoundError                what a knowledge base was asked for and does not have
    ├── StoreError (OSError)             the knowledge base cannot be opened, read or written
    │   └── InUseError                   another process has the folder of the knowledge base open
    ├── QueryError (ValueError)          a SPARQL text that is wrong or refused
    │   └── StoppedError                 one that took too long or too much memory
    ├── ValidationError (ValueError)     a graph that breaks the shapes; carries each finding
    ├── MissingExtraError (ImportError)  an optional part is not installed; says how to get it
    ├── SimulationError (RuntimeError)   the simulator cannot do what was asked
    └── WorkersError (RuntimeError)      processes or nodes cannot be started or reached

They live here because every other package imports `ontology` and nothing imports back.
Failures that a robot must expect (nothing seen, not sure, dropped) are outcomes, not errors.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence


class HiltError(Exception):
    """Base of all errors that Hilt raises on purpose; `str()` is one line for a person."""


class DataError(HiltError, ValueError):
    """A file or text that Hilt reads is wrong.

    Attributes:
        source: the file, or what the text was (`"<text>"`).
        line: 1-based line, or 0 when the whole source is meant.
        column: 1-based column, or 0 when the whole line is meant.
        text: the line itself, for the caret; empty when not known.
        problem: what was expected and what was found.
        mistakes: all that were found, each on its own, where there is more than this one.
    """

    mistakes: tuple[DataError, ...] = ()

    def __init__(
        self, problem: str, *, source: str, line: int = 0, column: int = 0, text: str = ""
    ) -> None:
        self.problem, self.source, self.line, self.column, self.text = (
            problem,
            source,
            line,
            column,
            text,
        )
        where = ":".join(str(part) for part in (source, line, column) if part)
        super().__init__(f"{where}: {problem}")

    @classmethod
    def together(cls, mistakes: Sequence[DataError]) -> DataError:
        """One error for several mistakes, at least one: the first, which knows of the others."""
        first = mistakes[0]
        whole = cls(
            first.problem,
            source=first.source,
            line=first.line,
            column=first.column,
            text=first.text,
        )
        whole.mistakes = tuple(mistakes) if len(mistakes) > 1 else ()
        return whole

    def __str__(self) -> str:
        others = len(self.mistakes) - 1
        return f"{super().__str__()} (and {others} more)" if others > 0 else super().__str__()

    def excerpt(self) -> str:
        """The line with a caret under the column, or an empty text when there is none."""
        if not self.text or not self.column:
            return ""
        return f"{self.text}\n{' ' * (self.column - 1)}^"


class IntervalError(HiltError, ValueError):
    """Two numbers that do not satisfy 0 <= lower <= upper <= 1."""

    def __init__(self, lower: object, upper: object) -> None:
        self.lower, self.upper = lower, upper
        super().__init__(
            f"[{lower}, {upper}] is not an interval: expected 0 <= lower <= upper <= 1."
        )


class ConflictError(HiltError, ValueError):
    """Sources that contradict each other fully, so that nothing can be concluded."""


class UnknownNameError(HiltError, LookupError):
    """A name that nothing answers to.

    Attributes:
        kind: what was looked for ("object", "part", "query", ...).
        name: what was asked.
        known: the names there are, sorted.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        from difflib import get_close_matches  # only where something is wrong already

        self.kind, self.name, self.known = kind, name, tuple(sorted(known))
        close = get_close_matches(name, self.known, n=1)
        hint = f' Did you mean "{close[0]}"?' if close else ""
        listed = ", ".join(self.known) or "none"
        super().__init__(f'There is no {kind} "{name}".{hint} Known: {listed}.')


class NotFoundError(UnknownNameError):
    """A name of something kept in a knowledge base, that it does not have."""


class StoreError(HiltError, OSError):
    """The knowledge base cannot be opened, read or written."""


class InUseError(StoreError):
    """Another process has the folder of a knowledge base open for writing.

    Attributes:
        location: the folder.
    """

    def __init__(self, location: str) -> None:
        self.location = location
        super().__init__(
            f'The knowledge base "{location}" is in use by another process. Close that one first, '
            "or name another folder."
        )


class QueryError(HiltError, ValueError):
    """A SPARQL text that is wrong, is refused, or was stopped."""


class StoppedError(QueryError):
    """A SPARQL text that took too long or too much memory, and was stopped."""


class ValidationError(HiltError, ValueError):
    """A graph or rule that breaks the shapes.

    Attributes:
        findings: one sentence for each thing that is wrong.
    """

    def __init__(self, findings: Sequence[str]) -> None:
        first, *others = self.findings = tuple(findings)
        more = f" (and {len(others)} more)" if others else ""
        super().__init__(f"{first}{more}")


class MissingExtraError(HiltError, ImportError):
    """An optional part of Hilt is not installed."""

    def __init__(self, extra: str, package: str) -> None:
        self.extra, self.package = extra, package
        super().__init__(f'"{package}" is not installed. Run: pip install "hilt[{extra}]"')


class SimulationError(HiltError, RuntimeError):
    """The simulator cannot do what was asked of it."""


class WorkersError(HiltError, RuntimeError):
    """The processes or nodes that were to work cannot be started or reached."""
