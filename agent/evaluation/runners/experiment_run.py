"""Running an experiment: choice of the runner, the journal, and a progress bar."""

from collections.abc import Sequence

from rich import progress
from rich.console import Console
from rich.text import Text

from ..experiment import Case, Experiment, TimedResult
from .base import TIMEOUT_S, ProcessRunner, Runner, run_serially
from .journal import RunJournal
from .ray import RayRunner


def make_runner(
    workers: int | None = None, ray: str | None = None, *, timeout_s: float = TIMEOUT_S
) -> Runner:
    """Return the runner for the options of a command.

    Args:
        workers: how many cases run at the same time; None is one, or all processors of a cluster.
        ray: the address of a Ray cluster, "auto" for the one of this machine, or "local" for a new
            one.
        timeout_s: how long a case may take before its worker is killed [s].

    Raises:
        MissingExtraError: Ray is not installed.
    """
    if ray:
        return RayRunner(ray, workers, timeout_s=timeout_s)
    if workers is None or workers == 1:
        return run_serially
    return ProcessRunner(workers, timeout_s)


def run_experiment(
    experiment: Experiment,
    cases: Sequence[Case] | None = None,
    *,
    runner: Runner | None = None,
    journal: RunJournal | None = None,
    console: Console | None = None,
) -> tuple[TimedResult, ...]:
    """Run an experiment, or resume it, and return the results of all cases in their order.

    `cases` are its cases, if they are listed already; without a runner they run in this process.
    The journal gets the results as they come, and the cases that it contains are not run again. The
    progress is shown on the console, if there is one.
    """
    cases = experiment.cases() if cases is None else cases
    runs = dict(journal.runs) if journal else {}
    left = [case for case in cases if case.key not in runs]
    with progress_bar(console) as bar:
        task = bar.add_task(experiment.name, total=len(cases), completed=len(runs))
        for run in (runner or run_serially)(experiment, left):
            runs[run.result.key] = run
            if journal:
                journal.add(run)
            bar.advance(task)
    ordered = tuple(runs[case.key] for case in cases)
    if journal:
        journal.finish(cases, experiment.files([run.result for run in ordered]))
    return ordered


class SpeedColumn(progress.ProgressColumn):
    """The rate in cases per second, or in seconds per case where they are slow."""

    def render(self, task: progress.Task) -> Text:
        """Return the rate as a text."""
        speed = task.finished_speed or task.speed
        if not speed:
            return Text("")
        return Text(f"{speed:.1f} a second" if speed >= 1 else f"{1 / speed:.1f} s each")


def progress_bar(console: Console | None) -> progress.Progress:
    """Return a bar of cases; it shows nothing if the console is None or not a terminal."""
    columns = (
        progress.TextColumn("{task.description}"),
        progress.BarColumn(),
        progress.MofNCompleteColumn(),
        SpeedColumn(),
        progress.TimeRemainingColumn(compact=True),
        progress.TextColumn("left"),
    )
    quiet = console is None or not console.is_terminal
    # Few refreshes: more take time that the cases need.
    return progress.Progress(
        *columns, console=console, transient=True, refresh_per_second=4, disable=quiet
    )
