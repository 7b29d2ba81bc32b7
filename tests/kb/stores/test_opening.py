"""Claims about how a location selects a store."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.kb.stores.opening import open_store
from hilt.ontology.errors import StoreError


@pytest.mark.parametrize("location", ["http:/h/x", "mem:", "memory:x", "sqlite:rules"])
@pytest.mark.parametrize("read_only", [True, False])
def test_mistyped_address_is_no_folder(
    location: str, read_only: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """None of that name is made."""
    monkeypatch.chdir(tmp_path)

    with pytest.raises(StoreError, match="expected memory:, a folder, or http"):
        open_store(location, read_only=read_only)

    assert not [*tmp_path.iterdir()]
