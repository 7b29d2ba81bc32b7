"""What the page on stores and questions shows is what happens."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hilt.kb.stores.http import parse_address

PAGE = (Path(__file__).parents[2] / "docs" / "knowledge-base.md").read_text(encoding="utf-8")


def test_program_runs():
    """The Python block finds the rule that it told."""
    (program,) = re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.DOTALL | re.MULTILINE)
    names: dict[str, object] = {}

    exec(compile(program, "knowledge-base.md", "exec"), names)  # noqa: S102 - our own page

    assert len(names["rows"]) == 1 and names["answer"].value  # type: ignore[arg-type, attr-defined]


@pytest.mark.parametrize("location", re.findall(r"\| `(https?://[^`]+)` ", PAGE))
def test_addresses_can_be_read(location: str):
    """Each one of the table is an address, with a place for updates."""
    found = parse_address(location, {})

    assert found.update.startswith("http") and "#" not in found.query + found.update
