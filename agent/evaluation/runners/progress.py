# SPDX-License-Identifier: Apache-2.0
"""The bar that shows how far a run is, how fast it goes, and how long it will still take."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeRemainingColumn,
)
from rich.text import Text

REFRESHES = 4  # a second; more costs time that the cases need


class RateColumn(ProgressColumn):
    """Cases a second, or seconds a case where they are slow."""

    def render(self, task: Task) -> Text:
        """The rate as a text."""
        speed = task.finished_speed or task.speed
        if not speed:
            return Text("")
        return Text(f"{speed:.1f} a second" if speed >= 1 else f"{1 / speed:.1f} s each")


@contextmanager
def progress(
    name: str, total: int, begun: int, console: Console | None
) -> Generator[Callable[[], None]]:
    """A bar for the block; what it gives is called after each case.

    Args:
        name: what is run.
        total: how many cases there are.
        begun: how many of them are done before.
        console: where it is shown; None shows nothing, nor does a file.
    """
    if console is None or not console.is_terminal:
        yield lambda: None
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        RateColumn(),
        TimeRemainingColumn(compact=True),
        TextColumn("left"),
    )
    with Progress(*columns, console=console, transient=True, refresh_per_second=REFRESHES) as bar:
        task = bar.add_task(name, total=total, completed=begun)
        yield lambda: bar.advance(task)
