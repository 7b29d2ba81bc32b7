"""The user's cache folder: files named by their content that are slow to compute.

It is `$HILT_CACHE`, or else `hilt` in the cache directory of the user. It may be deleted.
"""

import hashlib
import os
import pickle
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TypeVar
from uuid import uuid4

from .errors import SimulationError

T = TypeVar("T")


def cache_folder() -> Path:
    """Return the folder of the cache."""
    if given := os.environ.get("HILT_CACHE"):
        return Path(given).expanduser()
    from platformdirs import user_cache_path

    return user_cache_path("hilt", appauthor=False)


def content_key(*contents: bytes) -> str:
    """Return a short name for these contents: a digest that is equal for equal contents."""
    digest = hashlib.sha256()
    for content in contents:
        digest.update(len(content).to_bytes(8, "big") + content)
    return digest.hexdigest()[:20]


def cached(path: Path, make: Callable[[Path], object]) -> Path:
    """Return a file or folder of the cache, which `make` writes where it is told if it is missing.

    It is written beside, and renamed when complete, so that processes that make the same at the
    same time cannot spoil it. `SimulationError` where the cache cannot be written.
    """
    from tempfile import TemporaryDirectory  # here: most of what is looked for is there

    try:
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            with TemporaryDirectory(prefix=".draft-", dir=path.parent) as beside:
                make(draft := Path(beside) / path.name)
                draft.rename(path)
    except OSError as error:
        if not path.exists():  # else another process was first: what it made is the same
            raise SimulationError(
                f"The cache {path.parent} cannot be written: {error.strerror}. "
                "Set HILT_CACHE to a folder that can."
            ) from error
    return path


def kept(name: str, files: Iterable[Path], make: Callable[[], T]) -> T:
    """Return what `make` returns, which is kept in the cache for the next program.

    It counts until a file that it is made of changes, or Python does, if its own file is whole and
    the user's: a pickle can run any code. It is no error if it cannot be written.
    """
    states = sorted((str(path), (s := path.stat()).st_size, s.st_mtime_ns) for path in files)
    stamp = content_key(repr(states).encode(), sys.version.encode())
    places = repr([path for path, *_ in states])
    path = cache_folder() / f"{name}-{content_key(places.encode())}.pickle"
    with suppress(OSError):
        is_own = not hasattr(os, "getuid") or path.stat().st_uid == os.getuid()
        head, _, body = path.read_bytes().partition(b"\n")
        if is_own and head == f"{stamp} {content_key(body)}".encode():
            return pickle.loads(body)  # noqa: S301 - written below
    value = make()
    body = pickle.dumps(value)
    with suppress(OSError):
        head = f"{stamp} {content_key(body)}\n".encode()
        write_atomically(path, head + body, mode=0o600)
    return value


def write_atomically(path: Path, content: str | bytes, *, mode: int = 0o666) -> None:
    """Write a file under another name, then rename it: no reader sees half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.name}.{uuid4().hex}")
    with open(beside, "xb", opener=partial(os.open, mode=mode)) as file:
        file.write(content.encode() if isinstance(content, str) else content)
    beside.replace(path)
