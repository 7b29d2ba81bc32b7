"""The user's cache folder: files named by their content that are slow to compute.

It is `$HILT_CACHE`, or else `hilt` in the cache directory of the user. It may be deleted.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from uuid import uuid4

from .errors import SimulationError


def cache_folder() -> Path:
    """Return the folder of the cache."""
    given = os.environ.get("HILT_CACHE")
    if given:
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


def write_atomically(path: Path, text: str) -> None:
    """Write a text file under another name, then rename it: no reader sees half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.name}.{uuid4().hex}")
    beside.write_text(text, encoding="utf-8", newline="\n")
    beside.replace(path)
