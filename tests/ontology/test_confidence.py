"""Degrees of confidence."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.ontology.confidence import load_degrees
from hilt.ontology.errors import DataError


def test_degrees_of_the_paper_are_defined() -> None:
    """Generally, often, sometimes and occasionally have the values of section 4.1."""
    intervals = load_degrees().intervals

    assert [intervals[name][0] for name in ("high", "mediumHigh", "mediumLow", "low")] == [
        0.95, 0.75, 0.5, 0.25,
    ]  # fmt: skip


def test_rule_without_a_qualifier_is_high() -> None:
    """The default degree is "high" (section 3.2)."""
    assert load_degrees().default == "high"


@pytest.mark.parametrize("degree", load_degrees().intervals)
def test_nearest_degree_of_an_interval_of_the_table_is_its_own(degree: str) -> None:
    """Each interval of the table is named by its own degree."""
    degrees = load_degrees()

    assert degrees.nearest(degrees.intervals[degree]) == degree


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("default: low\ndegrees: {high: {interval: [0, 1]}}", "expected one of high"),
        ("default: high\ndegrees: {high: {interval: [0.9, 0.1]}}", "expected lower <= upper"),
        ("default: high\ndegrees: {high: {interval: [0.9]}}", "expected 2 numbers"),
        ("default: high", '"degrees" is missing'),
    ],
)
def test_wrong_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """The message has the position and what was expected."""
    path = tmp_path / "qualifiers.yaml"
    path.write_text(text, encoding="utf-8")

    with pytest.raises(DataError, match=message):
        load_degrees(path)
