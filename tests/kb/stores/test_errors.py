"""Claims about what is told when a folder cannot be opened."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.kb.stores.errors import open_error
from hilt.ontology.errors import InUseError

APPENDING = "IO error: While open a file for appending: {}/LOG: {}"


@pytest.mark.parametrize("refusal", ["Read-only file system", "Permission denied"])
def test_folder_that_may_not_be_written_is_called_neither_damaged_nor_in_use(
    tmp_path: Path, refusal: str
):
    """Also where it is called like a lock."""
    folder = tmp_path / "blocks"

    told = open_error(folder, RuntimeError(APPENDING.format(folder, refusal)))

    assert not isinstance(told, InUseError)
    assert str(told).endswith(f"may not be written: {refusal.lower()}. Name another folder.")


def test_folder_that_another_process_has_is_in_use(tmp_path: Path):
    """The engine speaks of its lock."""
    said = f"IO error: While lock file: {tmp_path}/LOCK: Resource temporarily unavailable"

    assert isinstance(open_error(tmp_path, RuntimeError(said)), InUseError)
