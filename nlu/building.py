# SPDX-License-Identifier: Apache-2.0
"""How a language is built in less time."""

from __future__ import annotations

import gc
from collections.abc import Generator
from contextlib import contextmanager


@contextmanager
def nothing_to_collect() -> Generator[None]:
    """No garbage is looked for within.

    All of a grammar is kept, so the collector would walk its terms again and again in vain: that
    is a third of the time it takes to load one.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if not gc.get_freeze_count():
            # All that is young becomes old at once, without being looked at.
            gc.freeze()
            gc.unfreeze()
        if was_enabled:
            gc.enable()
