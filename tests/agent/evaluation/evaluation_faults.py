"""An experiment whose cases go wrong on purpose, the first few times that they are begun."""

import os
import signal
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, cast

from hilt.agent.evaluation.experiment import Case, CaseResult, Experiment


def notes(folder: Path) -> list[list[str]]:
    """For each case that was begun, the processes in which it was."""
    return [path.read_text().splitlines() for path in sorted(folder.iterdir())]


@dataclass(frozen=True)
class Squares(Experiment):
    """Squares of numbers.

    Attributes:
        folder: where each case notes in which process it is begun, whenever it is.
        count: how many cases.
        deadly: cases that kill their worker.
        endless: cases that never end.
        times: how often they do that.
        each_s: how long the others take [s].
    """

    name: ClassVar[str] = "evaluation_faults:Squares"
    folder: str = ""
    count: int = 12
    deadly: Sequence[int] = ()
    endless: Sequence[int] = ()
    times: int = 1
    each_s: float = 0.0

    def cases(self) -> list[Case]:
        """A case for each number."""
        return [Case(self.name, f"{n:04}", {"number": n}) for n in range(self.count)]

    def run(self, case: Case) -> CaseResult:
        """The square of one number, unless something happens."""
        number = cast(int, case.spec["number"])
        if self.begun(number) <= self.times:
            self._go_wrong(number)
        time.sleep(self.each_s)
        return CaseResult(case.key, True, "check", 0, str(number**2), str(number**2))

    def begun(self, number: int) -> int:
        """How often a case was begun, with this time."""
        if not self.folder:
            return self.times + 1
        notes = Path(self.folder, f"{number:04}")
        with notes.open("a", encoding="utf-8") as file:
            file.write(f"{os.getpid()}\n")
        return len(notes.read_text().splitlines())

    def _go_wrong(self, number: int) -> None:
        if number in self.deadly:
            time.sleep(0.3)  # the pool notes first which case it is
            os.kill(os.getpid(), signal.SIGKILL)
        if number in self.endless:
            time.sleep(3600)


@dataclass(frozen=True)
class Broken(Squares):
    """Cases that raise an error, always."""

    name: ClassVar[str] = "evaluation_faults:Broken"

    def run(self, case: Case) -> CaseResult:
        """Raise it."""
        raise ValueError("never right")
