"""Journals: a run that is stopped at any moment goes on, and ends as if nothing had happened.

The command is killed a few times; `HILT_KILLS=30` in the environment makes it thirty.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from random import Random

import pytest
from evaluation_faults import Squares, notes
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.agent.cli import main
from hilt.agent.evaluation.experiment import TimedResult
from hilt.agent.evaluation.runners.journal import JOURNAL, RESULTS, TIMES, RunJournal
from hilt.agent.evaluation.runners.runner import run_experiment
from hilt.ontology.errors import DataError, StoreError

KILLS = int(os.environ.get("HILT_KILLS", "6")) // 3
HILT = (sys.executable, "-c", "from hilt.agent.cli import main; main()")
COMMAND = (*HILT, "evaluate", "paper", "--json")


def journaled(
    folder: Path, experiment: Squares, *, resume: bool = False
) -> tuple[TimedResult, ...]:
    """Run an experiment, or go on with it, with its journal in a folder."""
    cases = experiment.cases()
    with RunJournal(folder, experiment, cases, resume=resume) as journal:
        return run_experiment(experiment, cases, journal=journal)


def test_run_leaves_its_results_in_the_order_of_the_cases(tmp_path: Path):
    """One line a case, and a table of times beside it."""
    journaled(tmp_path, Squares(count=3))

    lines = (tmp_path / RESULTS).read_text().splitlines()
    assert [json.loads(line)["key"] for line in lines] == ["0000", "0001", "0002"]
    assert (tmp_path / TIMES).read_text().splitlines()[0] == "key,cpu_s,attempts"


@settings(max_examples=40, deadline=None)
@given(share=st.floats(0, 1))
def test_run_cut_off_anywhere_goes_on(tmp_path_factory: pytest.TempPathFactory, share: float):
    """Whatever byte of the journal was the last: no case is missing, and none is run again."""
    folder, noted = tmp_path_factory.mktemp("run"), tmp_path_factory.mktemp("notes")
    experiment = Squares(count=6, folder=str(noted))
    journaled(folder, experiment)
    whole, results = (folder / JOURNAL).read_bytes(), (folder / RESULTS).read_bytes()
    left = round(share * len(whole))

    (folder / JOURNAL).write_bytes(whole[:left])
    journaled(folder, experiment, resume=True)

    kept = max(0, whole[:left].count(b"\n") - 1)  # the header is no case
    assert (folder / RESULTS).read_bytes() == results
    assert [len(each) for each in notes(noted)] == [1] * kept + [2] * (6 - kept)


def test_run_that_is_there_is_not_overwritten(tmp_path: Path):
    """Without --resume a folder that holds a run is refused."""
    journaled(tmp_path, Squares())

    with pytest.raises(DataError, match=r"contains a run already\. Continue it with --resume"):
        journaled(tmp_path, Squares())


def test_other_options_are_another_run(tmp_path: Path):
    """A run goes on with its own options and seed only."""
    journaled(tmp_path, Squares(seed=1))

    with pytest.raises(DataError, match=r'journal\.jsonl:1: .* its "options" is .*"seed": 1'):
        journaled(tmp_path, Squares(seed=2), resume=True)


def test_folder_is_written_by_one_process(tmp_path: Path):
    """Two drivers cannot share a journal."""
    experiment = Squares()
    cases = experiment.cases()

    with (
        RunJournal(tmp_path, experiment, cases, resume=False),
        pytest.raises(StoreError, match="Another process is writing the run"),
    ):
        journaled(tmp_path, experiment, resume=True)


def test_damaged_line_is_told(tmp_path: Path):
    """A line in the middle that is no result is an error with its number, not a lost case."""
    journaled(tmp_path, Squares(count=3))
    lines = (tmp_path / JOURNAL).read_bytes().splitlines(keepends=True)

    (tmp_path / JOURNAL).write_bytes(b"".join([*lines[:2], b"{}\n", *lines[3:]]))

    with pytest.raises(DataError, match=r"journal\.jsonl:3: is not a result\."):
        journaled(tmp_path, Squares(count=3), resume=True)


def test_resume_needs_a_folder(capfd: pytest.CaptureFixture[str]):
    """`--resume` without `--out` is wrong usage."""
    with pytest.raises(SystemExit) as ended:
        main(["evaluate", "paper", "--resume"])

    assert ended.value.code == 2
    assert "--resume needs --out" in capfd.readouterr().err


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The results of the command when nobody disturbs it."""
    folder = tmp_path_factory.mktemp("whole")
    subprocess.run([*COMMAND, "--out", folder], check=True, capture_output=True)
    return (folder / RESULTS).read_bytes()


@pytest.mark.parametrize("workers", ["1", "2"])
def test_killed_command_goes_on(tmp_path: Path, whole: bytes, workers: str):
    """Killed (-9) again and again at random moments and resumed, it ends with the same file."""
    folder, rng = tmp_path / "killed", Random(workers)  # noqa: S311 - moments, not secrets
    command = [*COMMAND, "--out", folder, "--workers", workers, "--resume"]

    for number in range(KILLS):
        kill(command, folder / JOURNAL, after=rng.randint(0, 290 * (number + 1) // KILLS), rng=rng)
    subprocess.run(command, check=True, capture_output=True)

    assert (folder / RESULTS).read_bytes() == whole
    lines = (folder / JOURNAL).read_text().splitlines()[1:]
    assert len({json.loads(line)["result"]["key"] for line in lines}) == len(lines) == 300


def kill(command: list[str | Path], journal: Path, *, after: int, rng: Random) -> None:
    """Start a command and kill it a moment after so many lines are in its journal."""
    driver = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not journal.exists() or journal.read_bytes().count(b"\n") < after:
        assert driver.poll() is None
        time.sleep(0.002)
    time.sleep(rng.uniform(0, 0.05))
    driver.send_signal(signal.SIGKILL)
    driver.wait()
