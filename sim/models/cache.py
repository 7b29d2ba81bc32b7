# SPDX-License-Identifier: Apache-2.0
"""Meshes and robot files in the cache, named by their content."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ...ontology.cache import cache_folder, content_key, write_atomically
from ...ontology.errors import SimulationError

__all__ = ["cache_folder", "content_key", "keep_file"]


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
        write_atomically(path, text)
    except OSError as error:
        raise SimulationError(
            f"The cache {path.parent} cannot be written: {error.strerror}. "
            "Set HILT_CACHE to a folder that can."
        ) from error
    return path
