# SPDX-License-Identifier: Apache-2.0
"""Degrees of confidence."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.ontology.confidence import load_degrees
from hilt.ontology.errors import DataError


def test_the_papers_degrees_are_there() -> None:
    """Section 4.1: generally, often, sometimes, occasionally."""
    intervals = load_degrees().intervals

    assert [intervals[name][0] for name in ("high", "mediumHigh", "mediumLow", "low")] == [
        0.95, 0.75, 0.5, 0.25,
    ]  # fmt: skip


def test_a_rule_without_a_word_is_high() -> None:
    """Section 3.2: the placeholder "high" is preset."""
    assert load_degrees().default == "high"


@pytest.mark.parametrize("degree", load_degrees().intervals)
def test_a_degree_is_nearest_to_itself(degree: str) -> None:
    """Every interval of the table has its own degree."""
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
def test_a_wrong_file_is_told(tmp_path: Path, text: str, message: str) -> None:
    """Where, and what was expected."""
    path = tmp_path / "qualifiers.yaml"
    path.write_text(text, encoding="utf-8")

    with pytest.raises(DataError, match=message):
        load_degrees(path)
