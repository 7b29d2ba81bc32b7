"""The garbage collector of Python, paused while many values are made that all stay in use.

It would look through thousands of values without cycles again and again.
"""

import gc
from collections.abc import Generator
from contextlib import contextmanager


@contextmanager
def paused_garbage_collection() -> Generator[None]:
    """Pause the cyclic garbage collector, if it is on; also a decorator."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
