"""The curves of the noise experiment, and confidence intervals for clustered samples.

A curve varies one kind of noise; its points have a 95 % confidence interval: Wilson's score
interval (1927) at the effective sample size. The commands of one trial are correlated, so that they
count as fewer independent ones (Kish, Survey Sampling, 1965: the design effect is the variance of
the trial means over that of independent samples).
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path

from ....ontology.yaml_reader import YamlNode, read_yaml
from ..experiment import CaseResult, Json

CURVES_FILE = Path(__file__).parents[1] / "noise_curves.yaml"
OUTCOMES = ("right", "wrong", "declined")


@dataclass(frozen=True)
class AccuracyCurve:
    """Accuracy as a function of one kind of noise.

    Attributes:
        label: the label of the axis.
        values: the noise levels; the first is no noise.
        lines: label of a line -> inference setting ("fusion=mean"), or another variant.
        sound: the lines that must be right in every case without noise.
        is_sensor_noise: whether the noise is in the sensors.
    """

    name: str
    label: str
    values: tuple[float, ...]
    lines: Mapping[str, str]
    sound: tuple[str, ...]
    is_sensor_noise: bool


def _curve(name: str, spec: YamlNode) -> AccuracyCurve:
    keys = spec.entries(required={"label", "values"}, optional={"lines", "sound", "sensor"})
    lines = {"default": ""}
    if "lines" in keys:
        lines = {line: variant.text() for line, variant in keys["lines"].entries().items()}
    sound = keys["sound"].texts(choices=lines) if "sound" in keys else tuple(lines)
    is_sensor_noise = "sensor" in keys and keys["sensor"].truth()
    label, values = keys["label"].text(), keys["values"].numbers()
    return AccuracyCurve(name, label, values, lines, sound, is_sensor_noise)


CURVES = {name: _curve(name, spec) for name, spec in read_yaml(CURVES_FILE).entries().items()}


def curve_points(results: Sequence[CaseResult]) -> list[Json]:
    """Return the curves of the results: a point for each line and value, with its interval."""
    trials: dict[tuple[str, str, float], list[Json]] = defaultdict(list)
    for result in results:
        if result.kind == "check":  # not an error
            curve, line, value, _ = result.key.split("/")
            trials[curve, line, float(value)].append(result.facts)
    found: dict[str, Json] = {}
    for (curve, line, value), facts in trials.items():
        drawn = {"curve": curve, "label": CURVES[curve].label, "lines": {}}
        lines = found.setdefault(curve, drawn)["lines"]
        lines.setdefault(line, []).append(_point(value, facts))
    return list(found.values())


def _point(value: float, trials: Sequence[Json]) -> Json:
    per_trial = trials[0]["commands"]
    interval = clustered_interval([trial["right"] for trial in trials], per_trial)
    return {
        "x": value,
        "decisions": len(trials) * per_trial,
        **{name: sum(trial[name] for trial in trials) for name in OUTCOMES},
        "accuracy": round(interval.share, 6),
        "lower": round(interval.lower, 6),
        "upper": round(interval.upper, 6),
    }


Z = 1.959964  # quantile for a confidence of 95 %


@dataclass(frozen=True)
class ConfidenceInterval:
    """A proportion in [0, 1] with its 95 % confidence interval [lower, upper]."""

    share: float
    lower: float
    upper: float


def wilson_interval(successes: float, count: float) -> ConfidenceInterval:
    """Return the proportion of successes, which need not be integers, with Wilson's interval.

    >>> wilson_interval(9, 10)
    ConfidenceInterval(share=0.9, lower=0.5958499..., upper=0.9821237...)
    """
    share = successes / count
    weight = 1 + Z * Z / count
    middle = (share + Z * Z / (2 * count)) / weight
    half = Z / weight * sqrt(share * (1 - share) / count + Z * Z / (4 * count * count))
    lower, upper = min(middle - half, share), max(middle + half, share)
    return ConfidenceInterval(share, max(0.0, lower), min(1.0, upper))


def clustered_interval(successes: Sequence[int], per_trial: int) -> ConfidenceInterval:
    """Return the proportion of successes over trials, with its interval at the effective size.

    `successes` are those of each trial (at least one), in [0, per_trial].
    """
    count = len(successes) * per_trial
    share = sum(successes) / count
    design_effect = 1.0
    if len(successes) > 1 and share not in {0.0, 1.0}:
        spread = sum((each / per_trial - share) ** 2 for each in successes) / (len(successes) - 1)
        ratio = spread * per_trial / (share * (1 - share))
        design_effect = min(max(ratio, 1.0), float(per_trial))
    effective = count / design_effect
    return wilson_interval(share * effective, effective)
