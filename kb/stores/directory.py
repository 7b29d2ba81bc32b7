# SPDX-License-Identifier: Apache-2.0
"""The folder of a base on disk: whether it is one, and what a crash may have left beside it."""

from __future__ import annotations

from pathlib import Path

from ...ontology.errors import StoreError

# A folder that has this file is one the engine made.
MARK = "CURRENT"


def is_base(folder: Path) -> bool:
    """Whether a folder holds a base; not, where it is empty or not there.

    Raises:
        StoreError: it is a file, or holds something else.
    """
    if not folder.exists():
        return False
    if not folder.is_dir():
        raise StoreError(f'"{folder}" is a file. A knowledge base is a folder.')
    if (folder / MARK).exists():
        return True
    if any(folder.iterdir()):
        raise StoreError(
            f'"{folder}" holds other files and no knowledge base. Name another folder.'
        )
    return False


def undo_replacement(folder: Path) -> None:
    """Take back the old folder, when a crash came before the new one was in its place."""
    if not folder.exists() and replaced_place(folder).exists():
        replaced_place(folder).rename(folder)


def replaced_place(folder: Path) -> Path:
    """Where a folder stands while another one takes its place."""
    return folder.with_name(f".{folder.name}.replaced")


def remove_leftovers(folder: Path) -> None:
    """Remove what nobody needs: reports of earlier openings, parts of a load that was not ended.

    Only who owns the folder may do so, and not while something is loaded.
    """
    for pattern in ("LOG.old.*", "bulk-*.sst"):
        for file in folder.glob(pattern):
            file.unlink(missing_ok=True)
