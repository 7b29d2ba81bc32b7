"""The exceptions that Hilt raises, and the checks that optional packages are installed.

They are defined here because every other package imports `ontology`, which imports none of them.
Failures that a robot must expect (nothing seen, not sure, dropped) are results, not exceptions.
"""

from collections.abc import Generator, Iterable, Sequence
from contextlib import contextmanager

_SIMULATOR = ("pybullet", "pybullet_data", "PIL", "imageio", "scipy", "shapely", "trimesh", "coacd")
_PACKAGES = {"pybullet_data": "pybullet", "PIL": "pillow"}  # others are named as their modules
SIMULATOR_PACKAGES = {module: _PACKAGES.get(module, module) for module in _SIMULATOR}


class HiltError(Exception):
    """Base class of all exceptions of Hilt; `str()` is a one-line message for the user."""


class DataError(HiltError, ValueError):
    """A file or text (`source`) has invalid content; `problem` is what was expected and found.

    Line and column are 1-based, or 0 when the whole source or line is meant; `text` is the line
    itself, for the caret, empty when not known. `mistakes` are all errors, if several.
    """

    mistakes: "tuple[DataError, ...]" = ()

    def __init__(
        self, problem: str, *, source: str, line: int = 0, column: int = 0, text: str = ""
    ) -> None:
        self.problem, self.source, self.text = problem, source, text
        self.line, self.column = line, column
        where = ":".join(str(part) for part in (source, line, column) if part)
        super().__init__(f"{where}: {problem}")

    @classmethod
    def together(cls, mistakes: "Sequence[DataError]") -> "DataError":
        """Combine several errors (at least one) into one: the first, with all as `mistakes`."""
        first = mistakes[0]
        place = {"line": first.line, "column": first.column}
        whole = cls(first.problem, source=first.source, text=first.text, **place)
        whole.mistakes = tuple(mistakes) if len(mistakes) > 1 else ()
        return whole

    def __str__(self) -> str:
        others = len(self.mistakes) - 1
        return f"{super().__str__()} (and {others} more)" if others > 0 else super().__str__()

    def excerpt(self) -> str:
        """Return the line with a caret under the column, or an empty text if unknown."""
        if not self.text or not self.column:
            return ""
        return f"{self.text}\n{' ' * (self.column - 1)}^"


class IntervalError(HiltError, ValueError):
    """Two numbers do not satisfy 0 <= lower <= upper <= 1."""

    def __init__(self, lower: object, upper: object) -> None:
        self.lower, self.upper = lower, upper
        super().__init__(
            f"[{lower}, {upper}] is not an interval: expected 0 <= lower <= upper <= 1."
        )


class ConflictError(HiltError, ValueError):
    """Sources contradict each other completely, so that nothing can be concluded."""


class UnknownNameError(HiltError, LookupError):
    """A name does not exist; `kind` is that of the thing, `known` are existing names, sorted."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        from difflib import get_close_matches  # imported only when an error is reported

        self.kind, self.name, self.known = kind, name, tuple(sorted(known))
        close = get_close_matches(name, self.known, n=1)
        hint = f' Did you mean "{close[0]}"?' if close else ""
        listed = ", ".join(self.known) or "none"
        super().__init__(f'There is no {kind} "{name}".{hint} Known: {listed}.')


class NotFoundError(UnknownNameError):
    """A knowledge base does not contain the requested name."""


class PluginError(HiltError, RuntimeError):
    """A plug-in cannot be used; the message names the distribution that it comes from."""

    def __init__(self, group: str, name: str, distribution: str, problem: str) -> None:
        self.group, self.name, self.distribution = group, name, distribution
        super().__init__(f'The plug-in "{name}" ({group}) of {distribution} failed: {problem}.')


class StoreError(HiltError, OSError):
    """A knowledge base cannot be opened, read or written."""


class InUseError(StoreError):
    """Another process has opened the folder (`location`) of a knowledge base for writing."""

    def __init__(self, location: str) -> None:
        self.location = location
        super().__init__(
            f'The knowledge base "{location}" is in use by another process. Close that one first, '
            "or name another folder."
        )


class QueryError(HiltError, ValueError):
    """A SPARQL text is invalid, is not allowed, or was stopped."""


class QueryLimitError(QueryError):
    """A SPARQL query or update exceeded its limit of time or memory and was stopped."""


class BusyError(QueryLimitError):
    """Too many other queries are running; the same one may be asked again later."""


class ValidationError(HiltError, ValueError):
    """A graph or rule violates the SHACL shapes; `findings` has a sentence for each violation."""

    def __init__(self, findings: Sequence[str]) -> None:
        first, *others = self.findings = tuple(findings)
        super().__init__(first + (f" (and {len(others)} more)" if others else ""))


class MissingExtraError(HiltError, ImportError):
    """A package of one of Hilt's optional extras is not installed."""

    def __init__(self, extra: str, package: str, without: str = "") -> None:
        self.extra, self.package = extra, package
        super().__init__(f'"{package}" is not installed. Run: pip install "hilt[{extra}]"{without}')


class SimulationError(HiltError, RuntimeError):
    """The simulator cannot do what was requested."""


class MotionInterruptedError(HiltError, RuntimeError):
    """A motion was ended from another thread; a robot's body reports it and does not raise it."""

    def __init__(self) -> None:
        super().__init__("The motion was interrupted.")


class WorkersUnavailableError(HiltError, RuntimeError):
    """Worker processes or cluster nodes cannot be started or reached."""


@contextmanager
def extra_required(extra: str, package: str) -> Generator[None]:
    """Wrap imports of an optional package; MissingExtraError names the extra that has it."""
    try:
        yield
    except ImportError as error:
        raise MissingExtraError(extra, package) from error


def check_simulator() -> None:
    """Check that the extra "sim" is installed, importing none of it; `MissingExtraError` if not."""
    from importlib.util import find_spec

    for module, package in SIMULATOR_PACKAGES.items():
        if find_spec(module) is None:
            raise MissingExtraError("sim", package, ", or decide without a robot: --no-sim")
