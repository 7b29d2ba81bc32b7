"""Backup and restore: a checked copy of a base in use, and its restoration as one unit.

A backup is a folder that can be opened like any base. On the same disk it shares the data files
of the base, which never change once written; a backup against disk failure goes to another disk.
"""

import os
import shutil
import tempfile
from collections.abc import Generator
from contextlib import closing, contextmanager
from pathlib import Path

from ..ontology.errors import InUseError, StoreError
from .knowledge_base import KnowledgeBase
from .stores.base import MEMORY
from .stores.directory import replaced_place, unfinished_name
from .stores.mark import sync
from .stores.opening import open_store
from .stores.oxigraph import open_folder

LOCK = "LOCK"  # the file of a folder that its owner has locked
ENDPOINT = ("http://", "https://")
_OCCUPIED = '"{}" holds a knowledge base. Say that it is to be replaced (--replace).'


def backup(base: KnowledgeBase, target: Path) -> int:
    """Write a copy of a base into a new folder, and return the number of its last utterance.

    It may be in use; `target` must not exist. StoreError if that cannot be written or read back.
    """
    if target.exists():
        raise StoreError(f'"{target}" is there already. Name a new folder for the backup.')
    with _beside(target) as place:
        base.store.save(place)
        number = check(place)
        _sync(place)
        place.rename(target)
        sync(target.parent)
    return number


def restore(source: Path, location: str, *, replace: bool = False) -> int:
    """Restore a base from a backup, and return the number of its last utterance.

    The location is a folder, or the address of an endpoint; `replace` allows that what is there is
    lost. StoreError if the backup cannot be read; or the place holds a base, or is in use.
    """
    number = check(source)
    if location == MEMORY:
        raise StoreError("The memory ends with the program; name a folder or an endpoint.")
    if not location.startswith(ENDPOINT):
        _restore_folder(source, Path(location).expanduser(), replace=replace)
        return number
    from .stores.remote import open_remote  # with a library that folders do not need

    with (
        closing(open_store(source, read_only=True)) as backup_store,
        closing(open_remote(location)) as store,
        store.writing(),
    ):
        if not replace and any(store.select("SELECT ?s WHERE { ?s ?p ?o } LIMIT 1")):
            raise StoreError(_OCCUPIED.format(store.location))
        store.replace(backup_store.quads())
    return number


def check(folder: Path) -> int:
    """Read a backup, and return the number of its last utterance; StoreError if it is no base."""
    with KnowledgeBase.open(folder, read_only=True) as base:
        list(base.history(since=max(0, base.sequence - 1)))
        return base.sequence


def _restore_folder(source: Path, target: Path, *, replace: bool) -> None:
    with _beside(target) as place:
        shutil.copytree(source, place)
        check(place)
        _sync(place)
        with closing(open_folder(target)) as owner:  # then closed: it goes on compacting files
            if any(owner.quads()) and not replace:
                raise StoreError(_OCCUPIED.format(target))
        with _locked(target):
            old = replaced_place(target)
            target.rename(old)
            place.rename(target)
            sync(target.parent)
            shutil.rmtree(old)


@contextmanager
def _locked(folder: Path) -> Generator[None]:
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


@contextmanager
def _beside(target: Path) -> Generator[Path]:
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=unfinished_name(target), dir=target.parent) as made:
            yield Path(made) / "base"
    except StoreError:
        raise
    except OSError as error:
        raise StoreError(f'"{target}" cannot be written: {error.strerror}.') from error


def _sync(folder: Path) -> None:
    for file in filter(Path.is_file, folder.rglob("*")):
        sync(file)
    sync(folder)
