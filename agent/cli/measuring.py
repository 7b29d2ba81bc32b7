# SPDX-License-Identifier: Apache-2.0
"""Commands that measure: evaluate."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import AsJson, Seed, app
from .terminal import finish, show, terminal


@app.command()
def evaluate(
    what: Annotated[str, typer.Argument(help="paper (Table 2) or grasps (16 combinations).")],
    poses: Annotated[int, typer.Option(min=1, help="Random poses for each combination.")] = 3,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Repeat the paper's evaluation: Table 2's decisions, or the running example's grasps."""
    from .. import evaluation

    report = evaluation.run(what, poses=poses, seed=seed, console=terminal(stderr=True))
    show(report.as_json()) if as_json else terminal().print(report.table())
    finish(report.is_right)
