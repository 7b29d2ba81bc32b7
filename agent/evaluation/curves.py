# SPDX-License-Identifier: Apache-2.0
"""The curves of the noise experiment: what is varied, how far, and what is compared on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..outcome import Json
from .bands import band_of
from .case import Result

FUSIONS = ("yager", "dempster", "cautious", "mean")
THRESHOLDS = ("0", "0.005", "0.01", "0.02")
GARBLINGS = ("misheard", "dropped", "swapped")
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
    groups: dict[tuple[str, str, float], list[Json]] = {}
    for result in results:
        if result.kind == "check":
            curve, line, value, _ = result.key.split("/")
            groups.setdefault((curve, line, float(value)), []).append(result.facts)
    return [
        {
            "curve": name,
            "label": CURVES[name].label,
            "lines": {
                line: [_point(v, groups[name, line, v]) for n, at, v in groups if (n, at) == key]
                for key in dict.fromkeys((n, at) for n, at, _ in groups if n == name)
                for line in key[1:]
            },
        }
        for name in dict.fromkeys(name for name, _, _ in groups)
    ]


def _point(value: float, trials: Sequence[Json]) -> Json:
    rights = [int(str(trial["right"])) for trial in trials]
    per_trial = int(str(trials[0]["commands"]))
    band = band_of(rights, per_trial)
    wrong, declined = (sum(int(str(t[name])) for t in trials) for name in ("wrong", "declined"))
    return {
        "x": value,
        "decisions": len(trials) * per_trial,
        "right": sum(rights),
        "wrong": wrong,
        "declined": declined,
        "accuracy": round(band.share, 6),
        "lower": round(band.lower, 6),
        "upper": round(band.upper, 6),
    }
