"""The results of a run, counted, as JSON or as a table for the console."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

from ..experiment import CaseResult, Experiment, Json, TimedResult

if TYPE_CHECKING:
    from rich.table import Table


@dataclass(frozen=True)
class EvaluationReport:
    """The results of an experiment with its options; `runs` are in the order of the cases."""

    name: str
    options: Mapping[str, object]
    runs: tuple[TimedResult, ...]
    summary: Json = field(default_factory=dict[str, Any])

    @classmethod
    def from_runs(cls, experiment: Experiment, runs: Sequence[TimedResult]) -> EvaluationReport:
        """Return the report of a run of an experiment."""
        summary = experiment.summary([run.result for run in runs])
        return cls(experiment.name, experiment.options, tuple(runs), summary)

    @property
    def results(self) -> tuple[CaseResult, ...]:
        """The results without processor times."""
        return tuple(run.result for run in self.runs)

    @property
    def is_right(self) -> bool:
        """Whether every case is right."""
        return all(result.right for result in self.results)

    def as_json(self) -> Json:
        """Return the JSON object that `hilt evaluate --json` prints."""
        return self.counts() | {"cpu_s": round(sum(run.cpu_s for run in self.runs), 3)}

    def counts(self) -> Json:
        """Return the values that are equal in every run of the experiment."""
        kinds = Counter(result.kind for result in self.results)
        wrong = [result for result in self.results if not result.right]
        grasps = [r.facts["right_part"] for r in self.results if "right_part" in r.facts]
        executed = [r.facts["success"] for r in self.results if "success" in r.facts]
        return {
            "name": self.name,
            "runs": len(self.results),
            "right": len(self.results) - len(wrong),
            "by_principle": self._by_principle(),
            "unique": kinds["unique"],
            "ties": kinds["tie"],
            "none": kinds["none"],
            "errors": kinds["error"] + kinds["lost"],
            "executed": len(executed),
            "succeeded": sum(bool(each) for each in executed),
            "grasps": len(grasps),
            "right_part": sum(bool(each) for each in grasps),
            "wrong": [f"{r.key}: {r.found}; expected {r.expected}" for r in wrong],
            "seed": self.options.get("seed", 0),
            "options": dict(self.options),
            **self.summary,
        }

    def _by_principle(self) -> dict[str, dict[str, int]]:
        numbers = sorted({result.principle for result in self.results} - {0})
        # The principles are about decisions, not about their execution.
        groups = {
            n: [bool(r.facts.get("decided", r.right)) for r in self.results if r.principle == n]
            for n in numbers
        }
        return {str(n): {"runs": len(g), "right": sum(g)} for n, g in groups.items()}

    def table(self) -> Table:
        """Return a table of the cases."""
        from ...presentation.console import table, yes_or_no

        rows = ((r.key, r.found, r.expected, yes_or_no(r.right)) for r in self.results)
        return table(("case", "chosen", "expected", "right"), rows)

    def lines(self) -> list[str]:
        """Return the summary as lines of text: wrong cases, quantities, and last the count."""
        counts = self.counts()
        right, runs = counts["right"], counts["runs"]
        principles = counts["by_principle"].items()
        summary = {name: value for name, value in self.summary.items() if name != "curves"}
        return [
            *(f"wrong: {each}" for each in counts["wrong"]),
            *(f"principle {n}: {each['right']} of {each['runs']} right" for n, each in principles),
            *(f"{name.replace('_', ' ')}: {as_text(value)}" for name, value in summary.items()),
            f"{self.name}: {right} of {runs} right (seed {counts['seed']})",
        ]

    def points(self) -> Table | None:
        """Return a table of the points of the curves; None if there are none."""
        from ...presentation.console import table

        curves = self.summary.get("curves")
        columns = ("curve", "line", "at", "mean", "95 % interval", "decisions")
        return table(columns, _points(curves)) if curves else None


def _points(curves: Sequence[Json]) -> Iterator[Sequence[object]]:
    for curve in curves:
        measure = str(curve.get("measure", "accuracy"))
        form = ".1%" if measure == "accuracy" else ".2f"
        for line, points in curve["lines"].items():
            for at in points:
                band = f"{at['lower']:{form}} to {at['upper']:{form}}"
                shown = (f"{at['x']:g}", f"{at[measure]:{form}}", band, at["decisions"])
                yield (curve["curve"], line, *shown)


def as_text(value: object) -> str:
    """Return a JSON value as readable text."""
    if isinstance(value, dict):
        pairs = cast("Json", value).items()
        return "; ".join(f"{name.replace('_', ' ')}: {as_text(each)}" for name, each in pairs)
    if isinstance(value, list):
        return ", ".join(map(as_text, cast("list[object]", value))) or "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:,}" if isinstance(value, int) else str(value)
