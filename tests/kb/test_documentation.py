"""What the page on SPARQL endpoints shows is what happens."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hilt.kb.stores.http import parse_address

PAGE = (Path(__file__).parents[2] / "docs" / "endpoint.md").read_text(encoding="utf-8")
ADDRESSES = re.findall(r"\| `(https?://[^`]+)` ", PAGE)


def test_there_are_addresses():
    """Otherwise the test below would be skipped."""
    assert len(ADDRESSES) >= 6


@pytest.mark.parametrize("location", ADDRESSES)
def test_addresses_can_be_read(location: str):
    """Each one of the table is an address, with a place for updates."""
    found = parse_address(location, {})

    assert found.update.startswith("http") and "#" not in found.query + found.update
