# SPDX-License-Identifier: Apache-2.0
"""Commands that keep a knowledge base safe: backup and restore."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .common import open_for_reading, show
from .options import AsJson, Kb, app, example


@app.command(epilog=example("backup saved/"))
def backup(
    folder: Annotated[Path, typer.Argument(help="A new folder.")],
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Copy the knowledge base into a folder, while it is in use; the copy is read back."""
    from ...kb.backup import backup as save

    with open_for_reading(kb, must_exist=True) as base:
        number = save(base, folder)
    if as_json:
        show({"backup": str(folder), "sequence": number})
    else:
        typer.echo(f"Saved up to utterance {number} in {folder}.", err=True)


@app.command(epilog=example("restore saved/ --replace"))
def restore(
    folder: Annotated[Path, typer.Argument(help="A backup.")],
    replace: Annotated[
        bool, typer.Option("--replace", help="Put it in the place of the base that is there.")
    ] = False,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Make a backup the knowledge base: whole or not at all."""
    from ...kb.backup import restore as put_back
    from ..config import default_location

    location = kb or str(default_location())
    number = put_back(folder, location, replace=replace)
    if as_json:
        show({"restored": str(folder), "sequence": number})
    else:
        typer.echo(f"Restored up to utterance {number} from {folder}.", err=True)
