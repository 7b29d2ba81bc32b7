# SPDX-License-Identifier: Apache-2.0
"""Silence: what libraries print from C is kept out of the user's terminal."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Generator
from contextlib import ExitStack, contextmanager


@contextmanager
def quiet() -> Generator[None]:
    """Inside this block nothing is printed, not from C either."""
    with ExitStack() as stack, open(os.devnull, "wb") as nothing:
        for number in (1, 2):
            stack.enter_context(_redirected(number, nothing.fileno()))
        yield


@contextmanager
def _redirected(number: int, target: int) -> Generator[None]:
    try:
        saved = os.dup(number)
    except OSError:  # the stream is closed: there is nothing to hide
        yield
        return
    os.dup2(target, number)
    try:
        yield
    finally:
        # What C has printed waits in its own buffer; let it out while nobody reads it.
        ctypes.CDLL(None).fflush(None)
        os.dup2(saved, number)
        os.close(saved)
