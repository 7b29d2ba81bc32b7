"""The garbage collector of Python, paused while many values are made that all stay in use."""

import gc
from collections.abc import Generator
from contextlib import contextmanager


@contextmanager
def paused_garbage_collection() -> Generator[None]:
    """Pause the cyclic garbage collector; also a decorator.

    It pays where thousands of values without reference cycles are made: the collector would look
    through all of them again and again and find nothing to free. Measured: a language loads in
    0.6 s instead of 0.8 s. A collector that is switched off already stays off.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
