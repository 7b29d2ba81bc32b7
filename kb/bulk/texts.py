# SPDX-License-Identifier: Apache-2.0
"""Text that comes in chunks, cut into lines."""

from __future__ import annotations


def whole_lines(rest: bytes, chunk: bytes) -> tuple[list[str], bytes]:
    """The lines that are complete with a chunk of a text, and what is left of the last one.

    Args:
        rest: what was left before.
        chunk: what comes after it.

    Raises:
        UnicodeDecodeError: it is no UTF-8.
    """
    whole, end, left = chunk.rpartition(b"\n")
    if not end:
        return [], rest + chunk
    return (rest + whole).decode().split("\n"), left
