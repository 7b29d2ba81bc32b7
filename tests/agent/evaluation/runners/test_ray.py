"""Runs on a Ray cluster. Ray is an extra, and these tests say so where it is missing."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from evaluation_faults import Squares, notes

from hilt.agent.evaluation.runners.runner import make_runner
from hilt.ontology.errors import MissingExtraError, WorkersUnavailableError

NODES = Path(__file__).parents[1] / "evaluation_nodes.py"
COUNT = 80


def in_namespace(*command: str | Path) -> subprocess.CompletedProcess[str]:
    """Run a command that has a network of its own, with nothing but itself in it."""
    wrapped = ["unshare", "--net", *command]
    # Ray's workers import the experiment from the folder of the tests.
    env = {**os.environ, "PYTHONPATH": str(NODES.parent), "RAY_USAGE_STATS_ENABLED": "0"}
    return subprocess.run(
        wrapped, capture_output=True, text=True, check=False, timeout=300, env=env
    )


@pytest.fixture
def ray() -> None:
    """Skip where there is no Ray, or no network namespace can be made."""
    if importlib.util.find_spec("ray") is None:
        pytest.skip('Ray is not installed (pip install "hilt[cluster]")')
    if not shutil.which("unshare") or in_namespace("true").returncode:
        pytest.skip("no network namespace can be made here (it takes Linux and its root)")


@pytest.mark.usefixtures("ray")
def test_node_that_is_killed_loses_no_case(tmp_path: Path):
    """Of two nodes one is killed in the middle: all results come, some cases were begun twice."""
    ended = in_namespace(sys.executable, NODES, tmp_path, str(COUNT))

    assert ended.returncode == 0, ended.stderr
    assert json.loads(ended.stdout.splitlines()[-1]) == [str(n**2) for n in range(COUNT)]
    assert COUNT < sum(len(processes) for processes in notes(tmp_path)) <= 2 * COUNT


def test_missing_ray_is_told(monkeypatch: pytest.MonkeyPatch):
    """Without the extra the error says how to install it."""
    monkeypatch.setitem(sys.modules, "ray", None)

    with pytest.raises(MissingExtraError, match=r'"ray" is not installed\. Run: pip install "hilt'):
        make_runner(2, "local")


def test_cluster_that_does_not_answer_is_told():
    """An address where nobody listens is an error at once."""
    pytest.importorskip("ray", reason="Ray is not installed")
    runner = make_runner(ray="127.0.0.1:1")

    with pytest.raises(
        WorkersUnavailableError, match=r'No Ray cluster at "127\.0\.0\.1:1": .*refused'
    ):
        list(runner(Squares(), Squares().cases()))
