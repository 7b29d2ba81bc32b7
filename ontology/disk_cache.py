"""The user's cache folder: files named by their content that are slow to compute.

It is `$HILT_CACHE`, or else `hilt` in the cache directory of the user. It may be deleted.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path


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


def write_atomically(path: Path, text: str) -> None:
    """Write a text file under another name, then rename it: no reader sees half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(
        "w", dir=path.parent, delete=False, encoding="utf-8"
    ) as temporary:
        temporary.write(text)
    Path(temporary.name).replace(path)
