"""What the reports of motions leave as evidence."""

from __future__ import annotations

import pytest

from hilt.agent.execution.primitives import GraspLog
from hilt.sim.manipulation.motion_report import MotionReport

OK = MotionReport("grasp", ok=True, touched=("handle",))


def failed(reason: str, *failures: str) -> MotionReport:
    """The report of a motion that failed, with the failures so far."""
    return MotionReport("lift", ok=False, reason=reason, failures=failures)


def outcomes(*reports: MotionReport, part: str | None = "handle") -> list[str]:
    """What a grasp came to that was begun, lifted and handed over with these reports."""
    log = GraspLog()
    log.begin("mug", part, "pass", reports[0])
    for index, report in enumerate(reports[1:], start=1):
        log.follow(report, is_offered=index == 2)
    assert all(each.object == "mug" and each.context == "pass" for each in log.trials)
    assert {each.part for each in log.trials} <= {"handle"}
    return [each.outcome for each in log.trials]


@pytest.mark.parametrize(
    ("reports", "expected"),
    [
        ([OK], ["held"]),
        ([OK, OK, OK], ["held"]),
        ([failed("wrong_part")], ["wrong_part"]),
        ([failed("missed", "wrong_part", "missed")], ["wrong_part", "missed"]),
        ([OK, failed("slipped")], ["slipped"]),
        ([OK, failed("slipped", "missed", "slipped")], ["missed", "slipped"]),
        ([OK, OK, failed("nothing_held")], ["dropped"]),
        ([OK, OK, failed("unreachable")], ["refused"]),
        ([OK, OK, failed("refused_by_person")], ["refused"]),
        ([MotionReport("grasp", ok=True, failures=("slipped",)), OK], ["slipped", "held"]),
        ([OK, failed("unreachable")], ["held"]),
    ],
)
def test_each_closing_of_the_gripper_is_evidence(reports: list[MotionReport], expected: list[str]):
    """Attempts that failed count each, and the last one by how it ended."""
    assert outcomes(*reports) == expected


@pytest.mark.parametrize("reason", ["unreachable", "no_grasp", "too_wide", "nothing_seen"])
def test_what_never_closed_is_no_evidence(reason: str):
    """The part is not to blame for what was not tried."""
    assert outcomes(failed(reason)) == []


def test_what_was_interrupted_is_no_evidence():
    """Nobody knows how it would have ended."""
    assert outcomes(OK, failed("interrupted")) == []


def test_part_is_the_one_that_was_touched_where_none_was_asked():
    """A grasp anywhere is evidence of the only part that was touched."""
    assert outcomes(OK, part=None) == ["held"]
    assert outcomes(MotionReport("grasp", ok=True, touched=("handle", "barrel")), part=None) == []


def test_motion_without_a_grasp_leaves_nothing():
    """Pointing at something is no trial."""
    log = GraspLog()

    log.follow(OK)

    assert log.trials == ()
