# SPDX-License-Identifier: Apache-2.0
"""A folder's content at one moment, for those who read while its owner goes on writing.

The engine's data files never change once they are written, so a snapshot links them and copies
only its journals: milliseconds, whatever the size of the base. Snapshots live inside the folder
(or, where that cannot be written or its disk is full, among the temporary files) until their
reader is done; what a killed reader left is removed when the owner opens the folder the next time.
"""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
import time
from pathlib import Path

from ...ontology.errors import StoreError

INSIDE = "snapshots"
_TRIES, _PAUSE_S = 100, 0.02
_LINKED = {".sst"}  # written once, then never changed
_LEFT_OUT = {"LOCK", "LOG", INSIDE}
_PASSING = ("LOG.", "bulk-")  # earlier reports, and what is being loaded


def place(folder: Path) -> Path:
    """A new, empty folder for a snapshot of a folder."""
    mark = f"{os.getpid()}-"
    try:
        (folder / INSIDE).mkdir(exist_ok=True)
        return Path(tempfile.mkdtemp(prefix=mark, dir=folder / INSIDE))
    except OSError:
        return Path(tempfile.mkdtemp(prefix="hilt-"))


def take(folder: Path) -> Path:
    """A snapshot of a folder that another process may be writing to.

    Raises:
        StoreError: the folder cannot be read, or is written to without a pause.
    """
    try:
        return _taken(folder, place(folder))
    except OSError as error:
        if error.errno != errno.ENOSPC:
            raise
    return _taken(folder, Path(tempfile.mkdtemp(prefix="hilt-")))


def _taken(folder: Path, target: Path) -> Path:
    try:
        for _ in range(_TRIES):
            if _copy(folder, target):
                return target
            time.sleep(_PAUSE_S)
        raise StoreError(f'The knowledge base "{folder}" is too busy to be read. Try again.')
    except BaseException:
        remove(target)
        raise


def remove(snapshot: Path) -> None:
    """Remove a snapshot; and the place where they stand, when it was the last."""
    shutil.rmtree(snapshot, ignore_errors=True)
    if snapshot.parent.name == INSIDE:
        _remove_when_empty(snapshot.parent)


def remove_stale(folder: Path) -> None:
    """Remove what readers that are no more have left."""
    kept = list((folder / INSIDE).glob("*"))
    for snapshot in kept:
        if not _is_alive(snapshot.name.partition("-")[0]):
            remove(snapshot)


def _copy(folder: Path, target: Path) -> bool:
    """Copy what there is now; False when it changed meanwhile in a way that matters."""
    before = _state(folder)
    try:
        for name in before:
            _take_file(folder / name, target / name)
    except FileNotFoundError:  # the engine has merged files meanwhile
        pass
    else:
        if _state(folder) == before:
            return True
    for file in target.iterdir():
        file.unlink()
    return False


def _state(folder: Path) -> dict[str, int]:
    """The files, with the size of those that say which of the others count.

    A journal may grow: the part that was copied holds whole what was acknowledged before. But
    none may come or go, or what it held would be looked for in the wrong place.
    """
    return {
        entry.name: entry.stat().st_size if entry.name.startswith("MANIFEST") else 0
        for entry in os.scandir(folder)
        if entry.name not in _LEFT_OUT and not entry.name.startswith(_PASSING) and entry.is_file()
    }


def _take_file(source: Path, target: Path) -> None:
    if source.suffix in _LINKED:
        try:
            os.link(source, target)
        except FileNotFoundError:
            raise
        except OSError:  # another file system, or one without links
            pass
        else:
            return
    shutil.copyfile(source, target)


def _remove_when_empty(folder: Path) -> None:
    try:
        folder.rmdir()
    except OSError:
        return


def _is_alive(process: str) -> bool:
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return False
    except (ValueError, OverflowError, PermissionError):
        return True
    return True
