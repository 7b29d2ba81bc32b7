"""Speed of the pose functions, with scipy's `Rotation` beside them.

    pytest benchmarks/test_sim_speed.py -s

The pose functions run thousands of times in an episode, on one rotation or a few. `docs/why.md`
cites the ratios that are printed here.
"""

from __future__ import annotations

from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from hilt.sim import poses

ROTATIONS = Rotation.random(64, random_state=np.random.default_rng(7)).as_matrix()
ONE, OTHER = ROTATIONS[:2]
POSE, OTHER_POSE = (poses.pose(rotation, (0, 0, 0)) for rotation in (ONE, OTHER))
FRACTIONS = np.linspace(0, 1, 20)


def slerp_by_scipy() -> Any:
    """Twenty rotations between two."""
    return Slerp([0, 1], Rotation.from_matrix([ONE, OTHER]))(FRACTIONS).as_matrix()


CASES: dict[str, tuple[Callable[[], Any], Callable[[], Any]]] = {
    "quaternion": (
        lambda: poses.quaternion(ONE),
        lambda: Rotation.from_matrix(ONE).as_quat(canonical=True),
    ),
    "rotation_vector": (
        lambda: poses.rotation_vector(ROTATIONS),
        lambda: Rotation.from_matrix(ROTATIONS).as_rotvec(),
    ),
    "interpolate": (
        lambda: poses.interpolate(POSE, OTHER_POSE, FRACTIONS)[:, :3, :3],
        slerp_by_scipy,
    ),
}


def seconds(act: Callable[[], Any], rounds: int = 2_000) -> float:
    """Processor time of one call [s], the least of five series."""
    series: list[float] = []
    for _ in range(5):
        started = process_time()
        for _ in range(rounds):
            act()
        series.append((process_time() - started) / rounds)
    return min(series)


@pytest.mark.peer
@pytest.mark.parametrize("name", CASES)
def test_pose_functions_are_faster_than_scipys_rotation(name: str):
    """Both give the same numbers; the ratio is printed."""
    ours, theirs = CASES[name]
    np.testing.assert_allclose(np.abs(ours()), np.abs(theirs()), atol=1e-9)

    fast, slow = seconds(ours), seconds(theirs)

    print(f"\n{name}: {fast * 1e6:.0f} µs; scipy takes {slow / fast:.1f} times as long")
    assert fast < slow
