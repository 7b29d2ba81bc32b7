# SPDX-License-Identifier: Apache-2.0
"""Commands that measure: evaluate."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import AsJson, Seed, app
from .terminal import finish, show, terminal


@app.command()
def evaluate(  # noqa: PLR0917 - every option is one parameter of a command
    what: Annotated[str, typer.Argument(help="paper, situations or grasps.")],
    sim: Annotated[bool, typer.Option("--sim", help="Carry out what is decided.")] = False,
    scenes: Annotated[
        int | None, typer.Option(min=1, max=255, help="Scenes of the paper's run.")
    ] = None,
    poses: Annotated[int | None, typer.Option(min=1, help="Poses of each grasp.")] = None,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Repeat the paper's evaluation: Table 2's decisions, or the running example's grasps."""
    from ..evaluation.engine import run
    from ..evaluation.experiment import make_experiment
    from ..evaluation.report import Report

    given = {"sim": sim or None, "scenes": scenes, "poses": poses, "seed": seed}
    options = {name: value for name, value in given.items() if value is not None}
    experiment = make_experiment(what, options)
    done = tuple(run(experiment, console=terminal(stderr=True)))
    report = Report(what, experiment.options, done)
    show(report.as_json()) if as_json else terminal().print(report.table())
    finish(report.is_right)
