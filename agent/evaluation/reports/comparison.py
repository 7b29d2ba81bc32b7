"""Comparison of two evaluations, from the output of `--json` or `--report FILE.json`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar, cast

from ....ontology.errors import DataError
from ....ontology.yaml_reader import read_text
from ...execution.outcome import Json

if TYPE_CHECKING:
    from rich.table import Table

T = TypeVar("T")
NOT_COMPARED = ("results", "wrong", "cpu_s")  # results are compared by case; times always differ


@dataclass(frozen=True)
class EvaluationComparison:
    """The differences between two evaluations.

    Attributes:
        counts: name of a count or option -> its values in both; None if missing.
        cases: key of a case -> its results in both, such as "right: knife"; None if missing.
    """

    counts: Mapping[str, tuple[object, object]]
    cases: Mapping[str, tuple[str | None, str | None]]

    @property
    def is_empty(self) -> bool:
        """Whether the evaluations agree in everything but times."""
        return not self.counts and not self.cases

    def as_json(self) -> Json:
        """Return the JSON object that `hilt evaluate --compare --json` prints."""
        return {
            "equal": self.is_empty,
            "counts": {name: list(pair) for name, pair in self.counts.items()},
            "cases": {key: list(pair) for key, pair in self.cases.items()},
        }

    def table(self) -> Table:
        """Return a table of the differences."""
        from rich.markup import escape
        from rich.table import Table

        table = Table("", "A", "B")
        for name, pair in (*self.counts.items(), *self.cases.items()):
            table.add_row(escape(name), *(escape(_shown(each)) for each in pair))
        return table


def compare(first: Path, second: Path) -> EvaluationComparison:
    """Compare two files, by case if both contain results.

    Raises:
        DataError: a file cannot be read, or is not an evaluation.
    """
    a, b = _read(first), _read(second)
    counts_a, counts_b = dict(_leaves(a)), dict(_leaves(b))
    both = "results" in a and "results" in b
    cases = _differing(_cases(a), _cases(b)) if both else {}
    return EvaluationComparison(_differing(counts_a, counts_b), cases)


def _read(path: Path) -> Json:
    text = read_text(path)
    try:
        document: object = json.loads(text)
    except ValueError as error:
        raise DataError(f"is not JSON: {error}.", source=str(path)) from error
    if not isinstance(document, dict) or "runs" not in document:
        raise DataError('expected the output of "hilt evaluate --json".', source=str(path))
    return cast("Json", document)


def _leaves(document: Json, prefix: str = "") -> Iterator[tuple[str, object]]:
    for name, value in document.items():
        if not prefix and name in NOT_COMPARED:
            continue
        if isinstance(value, dict):
            yield from _leaves(cast("Json", value), f"{prefix}{name}.")
        elif isinstance(value, list) and prefix + name == "curves":
            for curve in cast("list[Json]", value):
                yield from _leaves(_points(curve), f"{curve['curve']}.")
        else:
            yield prefix + name, value


def _points(curve: Json) -> Json:
    lines = cast("dict[str, list[Json]]", curve["lines"])
    measure = str(curve.get("measure", "accuracy"))
    return {f"{line} at {p['x']}": p[measure] for line, each in lines.items() for p in each}


def _cases(document: Json) -> dict[str, str]:
    results = cast("list[Json]", document.get("results", []))
    return {
        str(each["key"]): f"{'right' if each['right'] else 'wrong'}: {each['found']}"
        for each in results
    }


def _differing(a: Mapping[str, T], b: Mapping[str, T]) -> dict[str, tuple[T | None, T | None]]:
    names = dict.fromkeys((*a, *b))
    return {name: (a.get(name), b.get(name)) for name in names if a.get(name) != b.get(name)}


def _shown(value: object) -> str:
    return "" if value is None else value if isinstance(value, str) else json.dumps(value)
