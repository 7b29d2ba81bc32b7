"""A connection to one PyBullet simulator; the only module that imports PyBullet.

Several connections can live in one process: each call carries the number of its own. What PyBullet
refuses is raised as an error of Hilt, and what it prints is kept out of the user's terminal.
"""

import ctypes
import os
import sys
from collections.abc import Generator
from contextlib import contextmanager
from ctypes.util import find_library
from typing import Any, BinaryIO

from ...ontology.errors import SimulationError, extra_required


class PhysicsClient:
    """A connection to one simulator; `SimulationError` where `gui` can open no window."""

    def __init__(self, *, gui: bool = False) -> None:
        with extra_required("sim", "pybullet"), quiet():
            import pybullet
        self._pybullet: Any = pybullet
        # Where it cannot open a window PyBullet ends the whole process without a word.
        if gui and sys.platform.startswith("linux") and not _has_display():
            raise SimulationError("There is no display to open a window on. Run without --gui.")
        with quiet():
            self._number: int = self._pybullet.connect(self.constant("GUI" if gui else "DIRECT"))
        if self._number < 0:
            raise SimulationError("PyBullet cannot open a window. Run without --gui.")
        self.gui = gui

    def call(self, function: str, *args: Any, **options: Any) -> Any:
        """Call a function of PyBullet; `SimulationError` if it refuses, or after `close`."""
        if self._number < 0:
            raise SimulationError("The simulator is closed.")
        try:
            return getattr(self._pybullet, function)(*args, **options, physicsClientId=self._number)
        except self._pybullet.error as error:
            raise SimulationError(f"PyBullet refuses {function}: {error}") from error

    def constant(self, name: str) -> int:
        """Return a constant of PyBullet's API."""
        return getattr(self._pybullet, name)

    def close(self) -> None:
        """Stop the simulator; closing twice is allowed."""
        if self._number >= 0:
            self.call("disconnect")
            self._number = -1


@contextmanager
def quiet() -> Generator[None]:
    """Suppress all output inside this block, that of C libraries included."""
    with open(os.devnull, "wb") as none, _redirected(1, none), _redirected(2, none):
        yield


@contextmanager
def _redirected(number: int, target: BinaryIO) -> Generator[None]:
    try:
        saved = os.dup(number)
    except OSError:  # the stream is closed: there is nothing to hide
        yield
        return
    os.dup2(target.fileno(), number)
    try:
        yield
    finally:
        # What C has printed waits in its own buffer: flush it before the stream is restored.
        ctypes.CDLL(None).fflush(None)
        os.dup2(saved, number)
        os.close(saved)


def _has_display() -> bool:
    if (library := find_library("X11")) is None:
        return True
    x11 = ctypes.CDLL(library)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    if display := x11.XOpenDisplay(None):
        x11.XCloseDisplay(ctypes.c_void_p(display))
    return bool(display)
