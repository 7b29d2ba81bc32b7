# SPDX-License-Identifier: Apache-2.0
"""The paper's running example (section 3): three sentences, and a knife is passed by the blade."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.panel import Panel
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from . import console as shown
from .agent import Agent
from .reply import Reply

LESSONS = (
    "A knife is used for cutting",
    "To pickup a knife grab the knife by the handle",
    "To pass a knife grab the knife by the blade",
)
COMMAND = "pass me something used for cutting"
AFTERWARDS = ("pick up the knife", "pass me something used for rolling")


def run(agent: Agent, out: Console, folder: Path) -> bool:
    """Run the example, show it, and write its pictures.

    Args:
        agent: with an empty or any other knowledge base.
        out: where it is shown.
        folder: where pictures and the animation are written, when there is a simulator.

    Returns:
        Whether everything came out as the paper says.
    """
    with _progress(out) as step:
        lessons = [step(text, agent) for text in LESSONS]
        passed = step(COMMAND, agent, folder)
        picked, nothing = (step(text, agent) for text in AFTERWARDS)
    out.print(Panel("Teaching", style="cyan", expand=False))
    for reply in lessons:
        out.print(shown.turn(reply))
    out.print(shown.rules(rule for reply in lessons for rule in reply.rules))
    for reply in (passed, picked, nothing):
        _show_command(out, reply, agent)
    return _is_as_told(passed, picked, nothing, agent)


def _show_command(out: Console, reply: Reply, agent: Agent) -> None:
    out.print(Panel(reply.text, style="cyan", expand=False))
    out.print(shown.turn(reply))
    if reply.achievement:
        out.print(shown.achievement(reply.achievement, agent.quote))
        for picture in reply.achievement.world.pictures:
            out.print(f"wrote {picture}", markup=False)


def _is_as_told(passed: Reply, picked: Reply, nothing: Reply, agent: Agent) -> bool:
    parts = [
        reply.achievement.decision.chosen_part
        for reply in (passed, picked)
        if reply.achievement and reply.achievement.decision
    ]
    touched = [reply.achievement.world.touched for reply in (passed, picked) if reply.achievement]
    as_decided = not agent.simulate or touched == [("blade",), ("handle",)]
    ended = (passed.ending, picked.ending, nothing.ending) == ("done", "done", "failed")
    return parts == ["blade", "handle"] and as_decided and ended


@contextmanager
def _progress(out: Console) -> Generator[_Step]:
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=out, transient=True) as bar:
        task = bar.add_task("", total=len(LESSONS) + 1 + len(AFTERWARDS))
        yield _Step(bar, task)


class _Step:
    """Says one utterance, and moves the progress bar on."""

    def __init__(self, bar: Progress, task: TaskID) -> None:
        self._bar, self._task = bar, task

    def __call__(self, text: str, agent: Agent, folder: Path | None = None) -> Reply:
        self._bar.update(self._task, description=text)
        recording: AbstractContextManager[list[str]] = nullcontext([])
        if folder and agent.simulate:
            recording = agent.recorded(folder)
        with recording as pictures:
            reply = agent.hear(text)
        self._bar.advance(self._task)
        came = reply.achievement
        if came is None or not pictures:
            return reply
        world = replace(came.world, pictures=tuple(pictures))
        return replace(reply, achievement=replace(came, world=world))
