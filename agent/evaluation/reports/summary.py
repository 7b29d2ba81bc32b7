# SPDX-License-Identifier: Apache-2.0
"""The results of a run, counted, as JSON or as a table for the console."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

from ...execution.outcome import Json
from ..case import CaseResult, TimedResult
from ..experiment import Experiment

if TYPE_CHECKING:
    from rich.table import Table


@dataclass(frozen=True)
class EvaluationReport:
    """The results of an experiment with its options; `runs` are in the order of the cases."""

    name: str
    options: Mapping[str, object]
    runs: tuple[TimedResult, ...]
    summary: Mapping[str, object] = field(default_factory=dict[str, object])

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
        """Return a table of the cases, or of the points of the curves if there are any."""
        from rich.table import Table

        from ...presentation import console

        if "curves" in self.summary:
            return self._points(cast("list[Json]", self.summary["curves"]))
        right = sum(result.right for result in self.results)
        table = Table(
            "case", "chosen", "expected", "right",
            title=f"{self.name}: {right} of {len(self.results)} right "
            f"(seed {self.options.get('seed', 0)})",
            title_justify="left",
        )  # fmt: skip
        for result in self.results:
            mark = "[green]yes" if result.right else "[red]no"
            table.add_row(result.key, result.found, result.expected, mark)
        return console.wrap_cells(table)

    def _points(self, curves: Sequence[Json]) -> Table:
        from rich.table import Table

        table = Table("curve", "line", "at", "mean", "95 % interval", "decisions")
        for curve in curves:
            measure = str(curve.get("measure", "accuracy"))
            form = ".1%" if measure == "accuracy" else ".2f"
            for line, points in cast("dict[str, list[dict[str, float]]]", curve["lines"]).items():
                for at in points:
                    band = f"{at['lower']:{form}} to {at['upper']:{form}}"
                    shown = (f"{at['x']:g}", f"{at[measure]:{form}}", band, str(at["decisions"]))
                    table.add_row(str(curve["curve"]), line, *shown)
        return table
