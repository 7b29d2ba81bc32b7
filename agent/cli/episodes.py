# SPDX-License-Identifier: Apache-2.0
"""Commands on what was done: episodes, replay."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from .common import exit_with, open_for_reading, print_json, spinner, terminal
from .options import AsJson, Gui, Kb, Record, app, example


@app.command(epilog=example("episodes --last 5"))
def episodes(
    *,
    last: Annotated[int | None, typer.Option("--last", min=1, help="Only so many.")] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """List what was done about commands: when, what came of it, with which object and part."""
    from ..presentation import history

    with open_for_reading(kb) as base:
        found = list(base.episodes())
    shown = found[-last:] if last else found
    if as_json:
        print_json([
            {"id": one.id, "time": one.time and one.time.isoformat(), "speaker": one.speaker,
             **json.loads(one.document)}
            for one in shown
        ])  # fmt: skip
    else:
        terminal().print(history.episodes(shown))


@app.command(epilog=example("replay last --record again.gif"))
def replay(
    which: Annotated[
        str, typer.Argument(metavar="ID|last", help="An episode's id or the start of it.")
    ],
    *,
    kb: Kb = None,
    record: Record = None,
    gui: Gui = False,
    as_json: AsJson = False,
) -> None:
    """Run an episode again from its seed and its rules; exit code 1 when it comes out otherwise."""
    from ..presentation import history
    from ..replay import replay as run

    with open_for_reading(kb) as base:
        with spinner(f"Running {which} again"):
            came = run(base, which, gui=gui, film=record)
        if as_json:
            print_json(came.as_json())
        else:
            terminal().print(history.replay_result(came, lambda said: base.utterance(said).text))
    exit_with(not came.differences)
