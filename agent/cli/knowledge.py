# SPDX-License-Identifier: Apache-2.0
"""Commands on the knowledge base: rules, export, import, trust."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import AsJson, Kb, app
from .terminal import open_base, show, terminal


@app.command()
def rules(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the rules that were told and hold."""
    with open_base(kb) as base:
        found = base.rules()
        if as_json:
            show([rule.as_json() for rule in found])
        else:
            from .. import console

            terminal().print(console.rules(found))


@app.command(name="export")
def export_(
    file: Annotated[str, typer.Argument(help='A .ttl or .trig file, or "-" for stdout.')],
    kb: Kb = None,
) -> None:
    """Write the rules (Turtle) or the whole base (TriG) to a file."""
    from ...kb.exchange import export_file

    with open_base(kb) as base:
        count = export_file(base, file)
    typer.echo(f"Wrote {count} triples to {file}.", err=True)


@app.command(name="import")
def import_(
    file: Annotated[str, typer.Argument(help='A .ttl or .trig file, or "-" for stdin.')],
    kb: Kb = None,
) -> None:
    """Read rules (Turtle) or a whole base (TriG): checked first, applied whole or not at all."""
    from ...kb.exchange import import_file

    with open_base(kb) as base:
        count = import_file(base, file)
    typer.echo(f"Read {count} triples from {file}.", err=True)


@app.command()
def trust(
    speaker: Annotated[str, typer.Argument(help="Who.")],
    degree: Annotated[float, typer.Argument(min=0.0, max=1.0, help="How far, in [0, 1].")],
    kb: Kb = None,
) -> None:
    """Say how far a speaker is to be trusted; 0 is not at all."""
    with open_base(kb) as base:
        base.set_trust(speaker, degree)
    typer.echo(f"{speaker} is trusted to {degree:g}.", err=True)
