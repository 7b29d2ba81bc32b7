# SPDX-License-Identifier: Apache-2.0
"""The curves of the noise experiment: what is varied, how far, and what is compared on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import cast

from ...execution.outcome import Json
from ..case import Result
from .bands import band_of

FUSIONS = ("yager", "dempster", "cautious", "mean")
THRESHOLDS = ("0", "0.005", "0.01", "0.02")
GARBLINGS = ("misheard", "dropped", "swapped")
OUTCOMES = ("right", "wrong", "declined")
SENSORS = ("missed", "confused", "confidence")


@dataclass(frozen=True)
class Curve:
    """Accuracy against one kind of trouble.

    Attributes:
        name: "missed", ...
        label: of the axis.
        values: where it is measured; the first is no trouble at all.
        lines: label of a line -> choices of the inference ("fusion=mean"), or other variants.
        sound: the lines that must be right in every case where there is no trouble.
    """

    name: str
    label: str
    values: tuple[float, ...]
    lines: Mapping[str, str] = field(default_factory=lambda: {"default": ""})
    sound: frozenset[str] = frozenset({"default"})

    @property
    def is_of_sensors(self) -> bool:
        """Whether the trouble is in the robot's eyes."""
        return self.name in SENSORS


SHARES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.5)
_BY_THRESHOLD = {f"Λ = {value}": f"threshold={value}" for value in THRESHOLDS}
_BY_FUSION = {name: f"fusion={name}" for name in FUSIONS}

CURVES: Mapping[str, Curve] = {
    curve.name: curve
    for curve in (
        Curve("missed", "share of things that are not seen", SHARES),
        Curve("confused", "share of things taken for another type", SHARES),
        Curve(
            "confidence",
            "largest loss of detection confidence",
            (0.0, 0.2, 0.4, 0.6, 0.8, 0.95),
            _BY_THRESHOLD,
            frozenset(list(_BY_THRESHOLD)[:3]),  # above .0148 what is "occasionally" so is lost
        ),
        Curve(
            "speech",
            "share of words that are heard wrongly",
            (0.0, 0.02, 0.05, 0.1, 0.2),
            {name: name for name in GARBLINGS},
            frozenset(GARBLINGS),
        ),
        Curve(
            "trust",
            "trust in a second teacher, who says the opposite",
            (0.0, 0.25, 0.5, 0.75, 0.9, 1.0),
            _BY_FUSION,
            frozenset(FUSIONS),
        ),
        Curve(
            "wrong",
            "share of rules that a second, fully trusted teacher contradicts",
            (0.0, 0.1, 0.25, 0.5, 1.0),
            _BY_FUSION,
            frozenset(FUSIONS),
        ),
    )
}


def drawn(results: Sequence[Result]) -> list[Json]:
    """The curves of some results: a point for each line and value, with its band."""
    found: dict[str, dict[str, dict[float, list[Json]]]] = {}
    for result in results:
        if result.kind == "check":  # not an error
            curve, line, value, _ = result.key.split("/")
            lines = found.setdefault(curve, {})
            lines.setdefault(line, {}).setdefault(float(value), []).append(result.facts)
    return [
        {
            "curve": name,
            "label": CURVES[name].label,
            "lines": {
                line: [_point(value, trials) for value, trials in points.items()]
                for line, points in lines.items()
            },
        }
        for name, lines in found.items()
    ]


def _point(value: float, trials: Sequence[Json]) -> Json:
    counts = cast("Sequence[dict[str, int]]", trials)
    per_trial = counts[0]["commands"]
    band = band_of([trial["right"] for trial in counts], per_trial)
    return {
        "x": value,
        "decisions": len(trials) * per_trial,
        **{name: sum(trial[name] for trial in counts) for name in OUTCOMES},
        "accuracy": round(band.share, 6),
        "lower": round(band.lower, 6),
        "upper": round(band.upper, 6),
    }
