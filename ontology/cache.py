# SPDX-License-Identifier: Apache-2.0
"""The folder where what is slow to make is kept, named by its content. It may be deleted.

It is `$HILT_CACHE`, else `hilt` in the user's cache directory. A file is written beside its place
and then renamed, so that two processes never see half of one another's.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path


def cache_folder() -> Path:
    """Where Hilt keeps what it can make again."""
    given = os.environ.get("HILT_CACHE")
    if given:
        return Path(given).expanduser()
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "hilt"


def content_key(*contents: bytes) -> str:
    """A short name for these contents, the same whenever they are the same."""
    digest = hashlib.sha256()
    for content in contents:
        digest.update(len(content).to_bytes(8, "big") + content)
    return digest.hexdigest()[:20]


def write_whole(path: Path, text: str) -> None:
    """Write a file of the cache, so that nobody ever sees half of it.

    Raises:
        OSError: it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(
        "w", dir=path.parent, delete=False, encoding="utf-8"
    ) as beside:
        beside.write(text)
    Path(beside.name).replace(path)
