# SPDX-License-Identifier: Apache-2.0
"""Backups: a copy of a base while it is in use, checked, and put back whole or not at all.

A backup is a folder that can be opened like any base. On the same disk it shares the data files
of the base, which never change once written; to be safe from a broken disk, name another disk.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from ..ontology.errors import InUseError, StoreError
from .knowledge_base import KnowledgeBase
from .stores.base import MEMORY, Store
from .stores.directory import replaced_place
from .stores.opening import open_store
from .stores.oxigraph import open_folder

LOCK = "LOCK"  # the file of a folder that its owner has locked
ENDPOINT = ("http://", "https://")
_OCCUPIED = '"{}" holds a knowledge base. Say that it is to be replaced (--replace).'


def backup(base: KnowledgeBase, target: Path) -> int:
    """Write a copy of a base as it is now into a new folder.

    Args:
        base: any base, in use or not.
        target: the folder, which must not be there.

    Returns:
        The number of the last utterance in it.

    Raises:
        StoreError: it cannot be written, or cannot be read back.
    """
    if target.exists():
        raise StoreError(f'"{target}" is there already. Name a new folder for the backup.')
    with _beside(target) as place:
        base.store.save(place)
        number = check(place)
        _sync(place)
        place.rename(target)
        _sync_folder(target.parent)
    return number


def restore(source: Path, location: str, *, replace: bool = False) -> int:
    """Put a backup where a base is to be.

    Args:
        source: the backup, which stays as it is.
        location: a folder, or the address of an endpoint.
        replace: whether what is there may be lost.

    Returns:
        The number of the last utterance in it.

    Raises:
        StoreError: the backup cannot be read; or the place holds a base, or is in use.
    """
    number = check(source)
    if location == MEMORY:
        raise StoreError("The memory ends with the program; name a folder or an endpoint.")
    if location.startswith(ENDPOINT):
        _restore_endpoint(source, location, replace=replace)
    else:
        _restore_folder(source, Path(location).expanduser(), replace=replace)
    return number


def check(folder: Path) -> int:
    """Open a backup and read it; the number of its last utterance.

    Raises:
        StoreError: it is no base that can be read.
    """
    with KnowledgeBase.open(folder, read_only=True) as base:
        list(base.history(since=max(0, base.sequence - 1)))
        return base.sequence


def _restore_folder(source: Path, target: Path, *, replace: bool) -> None:
    with _beside(target) as place:
        shutil.copytree(source, place)
        check(place)
        _sync(place)
        _check_free(target, replace=replace)
        with _locked(target):
            _exchange(place, target)


def _check_free(target: Path, *, replace: bool) -> None:
    """Whether the place may be taken; it is there, and a base, afterwards."""
    owner = open_folder(target)
    holds_base = any(owner.quads())
    owner.close()  # it would go on tidying up under this name
    if holds_base and not replace:
        raise StoreError(_OCCUPIED.format(target))


@contextmanager
def _locked(folder: Path) -> Generator[None]:
    """Hold the lock of the engine, so that no process opens the folder."""
    if os.name == "nt":  # a folder in use cannot be renamed there anyway
        yield
        return
    import fcntl

    with (folder / LOCK).open("r+b") as lock:
        try:
            fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise InUseError(str(folder)) from error
        yield


def _exchange(place: Path, target: Path) -> None:
    """Put one folder in the place of another; after a crash between, the old one comes back."""
    old = replaced_place(target)
    target.rename(old)
    place.rename(target)
    _sync_folder(target.parent)
    shutil.rmtree(old)


def _restore_endpoint(source: Path, location: str, *, replace: bool) -> None:
    backup_store, store = open_store(source, read_only=True), open_store(location)
    try:
        before = list(store.quads())
        if before and not replace:
            raise StoreError(_OCCUPIED.format(store.location))
        with store.writing():
            store.apply(delete=before, insert=list(backup_store.quads()))
    finally:
        _close(backup_store, store)


def _close(*stores: Store) -> None:
    for store in stores:
        store.close()


@contextmanager
def _beside(target: Path) -> Generator[Path]:
    """A place on the same disk, for what is not yet complete."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{target.name}.", dir=target.parent) as folder:
            yield Path(folder) / "base"
    except StoreError:
        raise
    except OSError as error:
        raise StoreError(f'"{target}" cannot be written: {error.strerror}.') from error


def _sync(folder: Path) -> None:
    """Have the disk write down all files of a folder."""
    for file in folder.rglob("*"):
        if file.is_file():
            with file.open("rb") as opened:
                os.fsync(opened.fileno())
    _sync_folder(folder)


def _sync_folder(folder: Path) -> None:
    if os.name == "nt":  # folders cannot be opened there
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
