"""The bar of a run: how far it is, how fast, and for how long."""

import io

import pytest
from rich.console import Console
from rich.progress import Progress
from rich.text import Text

from hilt.agent.evaluation.runners.experiment_run import SpeedColumn, progress_bar


def shown(*, terminal: bool, begun: int) -> str:
    """What a run of four cases shows."""
    file = io.StringIO()
    console = Console(file=file, force_terminal=terminal, width=100)
    with progress_bar(console) as bar:
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


@pytest.mark.parametrize(
    ("speed", "expected"), [(None, ""), (12.34, "12.3 a second"), (0.25, "4.0 s each")]
)
def test_rate_is_told_as_people_would(speed: float | None, expected: str):
    """Fast cases by the second, slow ones by how long each takes."""
    bar = Progress(console=Console(file=io.StringIO()))
    bar.add_task("paper", total=4)
    bar.tasks[0].finished_speed = speed

    assert SpeedColumn().render(bar.tasks[0]) == Text(expected)
