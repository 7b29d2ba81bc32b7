"""Degrees of confidence, such as `high` or `mediumLow`, and their intervals.

The words that express a degree ("often", "sometimes") belong to a language; the degrees are named
as in the predicate forms of the paper (sections 3.2 and 4.1).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from .yaml_reader import YamlNode, read_yaml

QUALIFIERS_FILE = Path(__file__).parent / "qualifiers.yaml"


@dataclass(frozen=True)
class Degrees:
    """Degrees of confidence, as (lower, upper) in [0, 1]; the default is of unqualified rules."""

    default: str
    intervals: Mapping[str, tuple[float, float]]

    def nearest(self, interval: tuple[float, float]) -> str:
        """Return the degree whose interval is closest to the given one."""
        return min(self.intervals, key=lambda each: distance(self.intervals[each], interval))


def distance(one: Iterable[float], other: Iterable[float]) -> float:
    """Return how far the bounds of two intervals are apart in all."""
    return sum(abs(a - b) for a, b in zip(one, other, strict=True))


def load_degrees(path: Path = QUALIFIERS_FILE) -> Degrees:
    """Return the degrees of a YAML file; `DataError` with the position where it is invalid."""
    entries = read_yaml(path).entries(required=("default", "degrees"), optional=())
    intervals = {
        name: read_interval(field.entries(required=("interval",), optional=())["interval"])
        for name, field in entries["degrees"].entries().items()
    }
    return Degrees(entries["default"].text(choices=intervals), intervals)


def read_interval(field: YamlNode) -> tuple[float, float]:
    """Return (lower, upper) in [0, 1]; `DataError` unless lower <= upper."""
    lower, upper = field.numbers(count=2, low=0, high=1)
    if lower > upper:
        raise field.fail(f"expected lower <= upper, found [{lower:g}, {upper:g}].")
    return lower, upper
