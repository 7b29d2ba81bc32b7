# SPDX-License-Identifier: Apache-2.0
"""One PyBullet simulator: opened, called and closed here; the only module that imports PyBullet.

What is built on it speaks to it by `_call`, which hands the simulator its number (two of them in a
process would else be one) and tells what PyBullet refuses as an error of ours.
"""

from __future__ import annotations

from typing import Any

from ...ontology.errors import MissingExtraError, SimulationError
from .display import refuse_no_display
from .silence import quiet


class Simulator:
    """One simulator; `close` it.

    Args:
        gui: whether to show a window.

    Raises:
        SimulationError: no window can be opened.
        MissingExtraError: PyBullet is not installed.
    """

    def __init__(self, *, gui: bool = False) -> None:
        self._p: Any = _import_pybullet()
        if gui:
            refuse_no_display()
        with quiet():
            self._client: int = self._p.connect(self._p.GUI if gui else self._p.DIRECT)
        if self._client < 0:
            raise SimulationError("PyBullet cannot open a window. Run without --gui.")
        self.gui = gui

    def _call(self, function: str, *args: Any, **options: Any) -> Any:
        if self._client < 0:
            raise SimulationError("The simulator is closed.")
        try:
            return getattr(self._p, function)(*args, **options, physicsClientId=self._client)
        except self._p.error as error:
            raise SimulationError(f"PyBullet refuses {function}: {error}") from error

    def close(self) -> None:
        """Stop the simulator; closing twice is allowed."""
        if self._client >= 0:
            self._call("disconnect")
            self._client = -1


def _import_pybullet() -> Any:
    try:
        with quiet():
            import pybullet
    except ImportError as error:
        raise MissingExtraError("sim", "pybullet") from error
    return pybullet
