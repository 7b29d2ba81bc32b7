# SPDX-License-Identifier: Apache-2.0
"""The folder where what is slow to make is kept: meshes and robot files, named by their content.

It is `$HILT_CACHE`, else `hilt` in the user's cache directory. An entry is written beside its place
and then renamed, so that two processes never see half of one another's file. It may be deleted.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

from ..ontology.errors import SimulationError


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


def keep_file(name: str, make: Callable[[], str]) -> Path:
    """The file of this name in the cache; `make` gives its text when it is not there yet.

    Raises:
        SimulationError: the cache cannot be written.
    """
    path = cache_folder() / name
    if path.is_file():
        return path
    text = make()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=path.parent, delete=False) as beside:
            beside.write(text)
        Path(beside.name).replace(path)
    except OSError as error:
        raise SimulationError(
            f"The cache {path.parent} cannot be written: {error.strerror}. "
            "Set HILT_CACHE to a folder that can."
        ) from error
    return path
