"""Runners give the same results whatever happens to the workers, and their bar shows how far."""

import io
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import pytest
from evaluation_faults import Squares
from pebble.pool.process import PoolManager
from rich.console import Console

from hilt.agent.evaluation.experiment import CaseResult, Experiment, make_experiment
from hilt.agent.evaluation.runners.runner import (
    Runner,
    case_progress,
    make_runner,
    run_experiment,
    run_serially,
)
from hilt.ontology.errors import DataError, UnknownNameError, WorkersUnavailableError


def results(experiment: Experiment, runner: Runner) -> list[CaseResult]:
    """What comes of an experiment."""
    return [each.result for each in run_experiment(experiment, runner=runner)]


def test_processes_give_what_one_process_gives():
    """The decisions of a run are the same in two processes, fact by fact and in order."""
    experiment = make_experiment("paper", {"scenes": 2})

    assert results(experiment, make_runner(2)) == results(experiment, run_serially)


def test_case_whose_worker_dies_is_begun_again(tmp_path: Path):
    """A dead worker costs no result, its own case's neither; no other case is begun twice."""
    experiment = Squares(folder=str(tmp_path), deadly=[3, 4])

    done = run_experiment(experiment, runner=make_runner(2))

    assert [each.result.found for each in done] == [str(n**2) for n in range(12)]
    assert {each.result.key: each.attempts for each in done if each.attempts > 1} == {
        "0003": 2,
        "0004": 2,
    }


def test_broken_pool_is_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A pool that cannot say whose worker died is given up, and its cases run in a new one."""
    find, breaks = PoolManager.find_expired_task, [BrokenProcessPool("All workers expired")]

    def find_expired_task(manager: PoolManager, worker: int) -> object:
        if breaks:
            raise breaks.pop()
        return find(manager, worker)

    monkeypatch.setattr(PoolManager, "find_expired_task", find_expired_task)
    experiment = Squares(folder=str(tmp_path), deadly=[3, 4])

    found = results(experiment, make_runner(2))

    assert [result.found for result in found] == [str(n**2) for n in range(12)]
    assert not breaks


def test_case_that_hangs_is_killed_and_begun_again(tmp_path: Path):
    """A case that takes too long loses its worker, and is done by the next one."""
    experiment = Squares(folder=str(tmp_path), endless=[5], count=8)

    done = run_experiment(experiment, runner=make_runner(2, timeout_s=1.0))

    assert [each.attempts for each in done] == [1, 1, 1, 1, 1, 2, 1, 1]
    assert all(each.result.right for each in done)


def test_case_that_always_kills_is_given_up(tmp_path: Path):
    """After a few workers a case is told as lost; all others are done."""
    experiment = Squares(folder=str(tmp_path), deadly=[2], times=99, count=5)

    found = results(experiment, make_runner(2))

    assert [result.kind for result in found] == ["check", "check", "lost", "check", "check"]
    assert found[2].found == "its worker process died or timed out 3 times"


@pytest.mark.parametrize("runner", [run_serially, make_runner(2)], ids=["serial", "processes"])
def test_error_of_a_case_is_its_result(runner: Runner):
    """A case that raises is wrong, says how, and stops nothing."""
    found = results(make_experiment("evaluation_faults:Broken", {"count": 3}), runner)

    assert [(r.right, r.kind, r.found) for r in found] == 3 * [
        (False, "error", "ValueError: never right")
    ]


def test_workers_that_cannot_start_are_told(monkeypatch: pytest.MonkeyPatch):
    """An experiment that no worker can make ends the run with one error."""
    experiment = Squares(count=3)
    monkeypatch.setattr(Squares, "name", "evaluation_faults:Nothing")

    with pytest.raises(WorkersUnavailableError, match="A worker process could not be started"):
        run_experiment(experiment, runner=make_runner(2))


def test_run_without_cases_is_empty():
    """Nothing to do is done at once."""
    assert run_experiment(Squares(count=0), runner=make_runner(2)) == ()


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("papers", 'There is no experiment "papers". Did you mean "paper"?'),
        ("no_module:Run", "no_module:Run: cannot be imported: No module named 'no_module'."),
        ("evaluation_faults:Cubes", 'evaluation_faults:Cubes: it contains no class "Cubes".'),
    ],
)
def test_unknown_experiment_is_told(name: str, problem: str):
    """A name that leads nowhere says where it ends."""
    with pytest.raises((UnknownNameError, DataError), match="^" + problem.replace("?", r"\?")):
        make_experiment(name, {})


def test_unknown_option_is_told():
    """An option that the experiment does not have lists those it has."""
    with pytest.raises(UnknownNameError, match="Known: gap, scenes, seed, sim"):
        make_experiment("paper", {"sceness": 3})


def test_one_worker_needs_no_process():
    """By default cases run where the command runs."""
    assert make_runner() is run_serially
    assert make_runner(2) is not run_serially


def shown(*, terminal: bool, begun: int) -> str:
    """What a run of four cases shows."""
    file = io.StringIO()
    console = Console(file=file, force_terminal=terminal, width=100)
    with case_progress(console) as bar:
        task = bar.add_task("paper", total=4, completed=begun)
        for _ in range(4 - begun):
            bar.advance(task)
    return file.getvalue()


@pytest.mark.parametrize("begun", [0, 3])
def test_bar_counts_what_was_done_before(begun: int):
    """A run that goes on begins where it was."""
    assert "4/4" in shown(terminal=True, begun=begun)


def test_nothing_is_shown_in_a_file():
    """What is redirected holds no bar, not even an empty line."""
    assert shown(terminal=False, begun=0) == ""
