"""The garbage collector of Python, paused while many values are made that all stay in use."""

import gc
from collections.abc import Generator
from contextlib import contextmanager


@contextmanager
def paused_garbage_collection() -> Generator[None]:
    """Pause the cyclic garbage collector; also a decorator.

    It pays where thousands of values without cycles are made, which the collector would look
    through again and again. A collector that is switched off already stays off.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
