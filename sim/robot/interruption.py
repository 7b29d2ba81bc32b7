"""Interruption of motions from any thread: a motion that runs can be paused, resumed or ended.

The robot checks it before every simulated step, so the arm comes to rest at once.
"""

from threading import Event

from ...ontology.errors import MotionInterruptedError


class Interruption:
    """A request to pause or to end what a robot does; every method may be called by any thread."""

    def __init__(self) -> None:
        self._ended, self._free = Event(), Event()
        self._free.set()

    def stop(self) -> None:
        """End the present motion and all that follow, until `clear`."""
        self._ended.set()
        self._free.set()

    def pause(self) -> None:
        """Pause the present motion until `resume`, `stop` or `clear`."""
        if not self.is_stopped:
            self._free.clear()

    def resume(self) -> None:
        """Go on with the motion that is paused."""
        self._free.set()

    def clear(self) -> None:
        """Withdraw every request."""
        self._ended.clear()
        self._free.set()

    @property
    def is_stopped(self) -> bool:
        """Whether the motion is to end."""
        return self._ended.is_set()

    @property
    def is_paused(self) -> bool:
        """Whether the motion is to pause."""
        return not self._free.is_set()

    @property
    def is_requested(self) -> bool:
        """Whether the motion is to pause or to end."""
        return self.is_stopped or self.is_paused

    def wait(self) -> None:
        """Block while the motion is paused; `MotionInterruptedError` where it is to end."""
        self._free.wait()
        if self.is_stopped:
            raise MotionInterruptedError
