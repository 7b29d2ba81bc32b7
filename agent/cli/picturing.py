# SPDX-License-Identifier: Apache-2.0
"""The command that draws the rules: graph."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...ontology.errors import DataError
from ..presentation.wording import counted
from .common import open_for_reading, show
from .options import AsJson, Kb, app, example

if TYPE_CHECKING:
    from ...kb.formats.drawing import Picture

MOST_RULES = 500  # in one picture; nobody finds anything in more
STREAM = "-"


@app.command(epilog=example("graph knife.svg --object knife"))
def graph(
    file: Annotated[
        str, typer.Argument(help='An .svg or .png file, or "-" for SVG on stdout.')
    ] = "rules.svg",
    *,
    name: Annotated[str | None, typer.Option("--object", help="About this object.")] = None,
    affordance: Annotated[str | None, typer.Option("--affordance", help="Used for this.")] = None,
    context: Annotated[str | None, typer.Option("--context", help="For this action.")] = None,
    part: Annotated[str | None, typer.Option("--part", help="Grasped by this part.")] = None,
    speaker: Annotated[str | None, typer.Option("--speaker", help="Told by this one.")] = None,
    at: Annotated[str | None, typer.Option("--at", help="As they were at some time.")] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Draw the rules as a graph, coloured by context; --json prints it and draws nothing."""
    from ...kb.formats.graphml import graph_of
    from ...kb.views import parse_moment, view

    moment = None if at is None else parse_moment(at)
    with open_for_reading(kb) as base:
        source = base if moment is None else view(base.reader, at=moment)
        rules = source.rules(
            object=name, affordance=affordance, context=context, part=part, speaker=speaker
        )
    found = graph_of(rules)
    if as_json:
        nodes = [{"id": node, **data} for node, data in found.nodes(data=True)]
        edges = [{"from": a, "to": b, **data} for a, b, data in found.edges(data=True)]
        show({"nodes": nodes, "edges": edges})
        return
    if len(rules) > MOST_RULES:
        raise DataError(
            f"{len(rules)} rules are too many for a picture (at most {MOST_RULES}). Choose some "
            'with --object, --affordance, --context or --speaker, or run "hilt export" for '
            "GraphML.",
            source=file,
        )
    from ...kb.formats.drawing import picture_of

    _write(picture_of(found), file)
    typer.echo(f"Drew {counted(len(rules), 'rule')} into {file}.", err=True)


def _write(picture: Picture, file: str) -> None:
    from ...kb.formats import painting

    if file == STREAM:
        sys.stdout.write(painting.svg(picture))
        return
    suffix = Path(file).suffix.lower()
    if suffix not in {".svg", ".png"}:
        raise DataError(f'the extension "{suffix}" is no picture; use .svg or .png.', source=file)
    is_svg = suffix == ".svg"
    data = painting.svg(picture).encode() if is_svg else painting.png(picture)
    try:
        Path(file).write_bytes(data)
    except OSError as error:
        raise DataError(f"cannot be written: {error.strerror}.", source=file) from error
