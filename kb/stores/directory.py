"""The folder of a base on disk: its files, and snapshots of it.

A snapshot is the folder's content at one moment, for a reader in another process. The engine's
table files never change, so a snapshot links them and copies only the rest: milliseconds. Snapshots
live inside the folder (or, where that cannot be written or its disk is full, among the temporary
files) until their reader is done; what a killed reader left is removed by the next owner.
"""

import contextlib
import errno
import glob
import os
import shutil
import tempfile
import time
import weakref
from pathlib import Path

from ...ontology.errors import StoreError
from .mark import MARK, MARKER_FILE, read_mark

SNAPSHOTS = "snapshots"
_TRIES, _PAUSE_S = 100, 0.02
_TABLE = ".sst"  # the suffix of the files that never change
_NOT_COPIED = {"LOCK", "LOG", SNAPSHOTS, MARK}  # the mark is copied first
_TRANSIENT = ("LOG.", "bulk-")  # earlier engine reports, and what is being loaded


def is_base(folder: Path) -> bool:
    """Whether a folder, which may not exist, holds a base; StoreError if it holds other files."""
    if (folder / MARKER_FILE).exists():
        return True
    if folder.exists() and not folder.is_dir():
        raise StoreError(f'"{folder}" is a file. A knowledge base is a folder.')
    if folder.exists() and any(folder.iterdir()):
        raise StoreError(f'"{folder}" holds other files and no knowledge base. Name another one.')
    return False


def undo_replacement(folder: Path) -> None:
    """Bring the old folder back if a crash happened before the new one was in its place."""
    if not folder.exists() and replaced_place(folder).exists():
        replaced_place(folder).rename(folder)


def replaced_place(folder: Path) -> Path:
    """Where a folder is kept while another one takes its place."""
    return folder.with_name(f".{folder.name}.replaced")


def remove_leftovers(folder: Path) -> None:
    """Remove earlier engine reports and parts of an unfinished bulk load, as the folder's owner."""
    for pattern in ("LOG.old.*", "bulk-*.sst"):
        for file in folder.glob(pattern):
            file.unlink(missing_ok=True)


class Snapshot:
    """A new, empty folder for a snapshot, removed when nobody refers to it any more."""

    number = 0  # of the last utterance in it, where it is known

    def __init__(self, folder: Path | None) -> None:
        """Make it inside the folder of a base, or among the temporary files."""
        try:
            place = folder / SNAPSHOTS if folder else None
            if place:
                place.mkdir(exist_ok=True)
            name = tempfile.mkdtemp(prefix=f"{os.getpid()}-" if place else "hilt-", dir=place)
        except OSError:
            name = tempfile.mkdtemp(prefix="hilt-")
        self.path = Path(name)
        weakref.finalize(self, _remove, self.path, os.getpid())


def take_snapshot(folder: Path) -> Snapshot:
    """A snapshot of a folder that another process writes to; StoreError if it never pauses."""
    try:
        return _filled(Snapshot(folder), folder)
    except OSError as error:
        if error.errno != errno.ENOSPC:
            raise
    return _filled(Snapshot(None), folder)


def _remove(path: Path, owner: int | None = None) -> None:
    if owner not in {None, os.getpid()}:  # after a fork it is still that of the other process
        return
    shutil.rmtree(path, ignore_errors=True)
    if path.parent.name == SNAPSHOTS:
        with contextlib.suppress(OSError):  # others are in it
            path.parent.rmdir()


def unfinished_name(folder: Path) -> str:
    """How the name of a folder begins in which this process prepares another one."""
    return f".{folder.name}.unfinished-{os.getpid()}-"


def remove_what_dead_processes_left(folder: Path) -> None:
    """Remove the snapshots and unfinished folders of processes that do not exist any more."""
    begin = unfinished_name(folder).removesuffix(f"{os.getpid()}-")
    for left in [*(folder / SNAPSHOTS).glob("*"), *folder.parent.glob(f"{glob.escape(begin)}*")]:
        try:
            os.kill(int(left.name.removeprefix(begin).partition("-")[0]), 0)
        except ProcessLookupError:
            _remove(left)
        except (ValueError, OverflowError, PermissionError):  # it is of a living process, or none
            pass


def _filled(snapshot: Snapshot, folder: Path) -> Snapshot:
    for _ in range(_TRIES):
        before = _state(folder)
        if marked := read_mark(folder):
            (snapshot.path / MARK).write_bytes(marked)
        with contextlib.suppress(FileNotFoundError):  # the engine has merged files meanwhile
            for name in before:
                _copy_file(folder / name, snapshot.path / name)
            if _state(folder) == before:
                return snapshot
        for file in snapshot.path.iterdir():
            file.unlink()
        time.sleep(_PAUSE_S)
    raise StoreError(f'The knowledge base "{folder}" is too busy to be read. Try again.')


def _state(folder: Path) -> dict[str, int]:
    """The files, with the size of those that say which of the others count.

    A log may grow: the part that was copied holds all that was acknowledged before. But no file
    may come or go, or what it held would be looked for in the wrong place.
    """
    return {
        entry.name: entry.stat().st_size if entry.name.startswith("MANIFEST") else 0
        for entry in os.scandir(folder)
        if entry.name not in _NOT_COPIED
        and not entry.name.startswith(_TRANSIENT)
        and entry.is_file()
    }


def _copy_file(source: Path, target: Path) -> None:
    if source.suffix == _TABLE:
        with contextlib.suppress(OSError):  # another file system, or one without links
            os.link(source, target)
            return
    shutil.copyfile(source, target)
