# SPDX-License-Identifier: Apache-2.0
"""Having the disk keep what was written, at the price of one write to it.

The engine puts every change into a journal (`*.log` in the folder) before it returns, and reads
it again when the folder is opened; so what the disk has of the journal is safe from power loss.
The engine's own way to get there, `flush`, rewrites its tables and takes some twenty waits for
the disk. Here the journal alone is waited for; the tables follow from time to time, so that the
journal stays short and a folder opens fast.
"""

from __future__ import annotations

import contextlib
import os
import sys
from pathlib import Path

CHANGES = 1_000  # after which the tables are written and the journal begins anew
_SUFFIX = ".log"
# Elsewhere this call does not promise what it does on Linux, so the engine's own way is taken.
_IS_ENOUGH = sys.platform == "linux"


class WriteAheadLog:
    """The journal of one folder, as its owner sees it."""

    def __init__(self, folder: Path | None) -> None:
        """Watch the journal of a folder; None where nothing outlives the process."""
        self._folder = folder
        self._kept: dict[str, int] = {}  # file -> how much of it the disk has [bytes]
        self._changes = 0

    @property
    def has_changes(self) -> bool:
        """Whether the tables do not have everything yet."""
        return self._changes > 0

    def keep(self) -> bool:
        """Wait until the disk has the journal; False when the tables must be written instead.

        Raises:
            OSError: the disk is full or broken.
        """
        if self._folder is None:
            return True
        self._changes += 1
        sizes = _sizes(self._folder) if _IS_ENOUGH else {}
        if not sizes or self._changes >= CHANGES:
            return False
        for name, size in sizes.items():
            if self._kept.get(name) != size:
                with contextlib.suppress(FileNotFoundError):  # it is in the tables by now
                    _wait_for(self._folder / name)
        if not sizes.keys() <= self._kept.keys():
            _wait_for(self._folder)  # a new file is safe only when the disk has its name, too
        self._kept = sizes
        return True

    def tables_written(self) -> None:
        """Note that the tables have everything."""
        self._changes = 0


def _sizes(folder: Path) -> dict[str, int]:
    """The files of the journal, and how long they are."""
    with os.scandir(folder) as entries:
        return {one.name: one.stat().st_size for one in entries if one.name.endswith(_SUFFIX)}


def _wait_for(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle) if path.is_dir() else os.fdatasync(handle)
    finally:
        os.close(handle)
