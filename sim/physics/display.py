# SPDX-License-Identifier: Apache-2.0
"""Whether there is a display to open a window on.

PyBullet ends the whole process, without a word, where it cannot open one; so it is asked before.
"""

from __future__ import annotations

import ctypes
import sys
from ctypes.util import find_library

from ...ontology.errors import SimulationError


def refuse_no_display() -> None:
    """Tell that no window can be opened.

    Raises:
        SimulationError: the X server, where windows need one, does not answer.
    """
    if sys.platform.startswith("linux") and not _answers():
        raise SimulationError("There is no display to open a window on. Run without --gui.")


def _answers() -> bool:
    """Whether the X server does; where its library is not found nobody knows."""
    library = find_library("X11")
    if library is None:
        return True
    x11 = ctypes.CDLL(library)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = x11.XOpenDisplay(None)
    if display:
        x11.XCloseDisplay(ctypes.c_void_p(display))
    return bool(display)
