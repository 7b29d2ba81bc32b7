"""What the grasps of one execution came to, from the reports of the motions."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ...kb.episodes import HELD, GraspTrial
from ...sim.manipulation.motion_report import MotionReport
from .outcome_answer import INTERRUPTED

_OUTCOMES = {"nothing_held": "dropped"} | {
    reason: reason for reason in ("slipped", "dropped", "wrong_part", "missed")
}


@dataclass
class _LastGrasp:
    """The grasp that the hand is at: its trial, earlier attempts, and how it stands."""

    trial: GraspTrial
    failures: tuple[str, ...] = ()
    ended: str | None = None

    def trials(self) -> list[GraspTrial]:
        """The attempts that failed, then the last one if it is known how that ended."""
        outcomes = [_OUTCOMES[each] for each in self.failures if each in _OUTCOMES]
        if self.ended and self.ended not in outcomes:
            outcomes.append(self.ended)
        return [replace(self.trial, outcome=each) for each in outcomes]


class GraspLog:
    """Collects the trials of grasps: each grasp is begun, and followed until the next."""

    def __init__(self) -> None:
        self._grasps: list[_LastGrasp] = []

    def begin(self, of: str, part: str | None, context: str, report: MotionReport) -> None:
        """Note a grasp of an object; without a part it is by the only one that was touched."""
        touched = report.touched[0] if len(report.touched) == 1 else ""
        self._grasps.append(_LastGrasp(GraspTrial(of, part or touched, context, HELD)))
        self.follow(report)

    def follow(self, report: MotionReport, *, is_offered: bool = False) -> None:
        """Note a motion with the object in the hand, which may be offered to somebody."""
        if not self._grasps:
            return
        grasp = self._grasps[-1]
        grasp.failures = report.failures or grasp.failures
        if report.ok:
            grasp.ended = HELD
        elif report.reason in _OUTCOMES:
            grasp.ended = _OUTCOMES[report.reason]
        elif report.reason == INTERRUPTED:
            grasp.ended = None
        elif is_offered:
            grasp.ended = "refused"

    @property
    def trials(self) -> tuple[GraspTrial, ...]:
        """All trials so far, in order, of which the part is known."""
        return tuple(trial for each in self._grasps for trial in each.trials() if trial.part)
