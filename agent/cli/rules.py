"""Commands on the rules: rules, graph, trust."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...ontology.errors import DataError
from .. import presentation
from ..presentation.plain_text import counted
from .common import STDIN, open_base, open_for_reading, print_json, show, write_bytes
from .options import AsJson, Kb, app, example

if TYPE_CHECKING:
    from networkx import MultiDiGraph

MOST_RULES = 500  # in one picture; nobody finds anything in more
Object = Annotated[str | None, typer.Option("--object", help="About this object.")]
Affordance = Annotated[str | None, typer.Option("--affordance", help="Used for this.")]
Context = Annotated[str | None, typer.Option("--context", help="For this action.")]
Part = Annotated[str | None, typer.Option("--part", help="Grasped by this part.")]


@app.command(epilog=example("rules --object knife --at 2026-11-21"))
def rules(
    *,
    at: Annotated[
        str | None, typer.Option("--at", help="As they were: a date, a time, an utterance number.")
    ] = None,
    according_to: Annotated[
        str | None, typer.Option("--according-to", metavar="SPEAKER", help="As this one sees it.")
    ] = None,
    name: Object = None,
    affordance: Affordance = None,
    context: Context = None,
    part: Part = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """List the rules that hold now, that held at some time, or that one speaker holds."""
    from ...kb.views import parse_moment, view

    moment = None if at is None else parse_moment(at)
    with open_for_reading(kb) as base:
        is_now = moment is None and according_to is None
        according_to = according_to and base.match_speaker(according_to)
        source = base if is_now else view(base, at=moment, according_to=according_to)
        found = source.rules(object=name, affordance=affordance, context=context, part=part)
    show(found, presentation.console.rules, as_json=as_json)


@app.command(epilog=example("trust anna 0.9"))
def trust(
    speaker: Annotated[str | None, typer.Argument(help="Who; by default all are listed.")] = None,
    degree: Annotated[
        float | None, typer.Argument(min=0.0, max=1.0, help="The trust, in [0, 1].")
    ] = None,
    *,
    suggest: Annotated[
        bool, typer.Option("--suggest", help="Show what experience says; nothing is changed.")
    ] = False,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Set the trust in a speaker, 0 for none; or show the trust in each speaker."""
    from ...ontology.errors import NotFoundError

    if suggest:
        if degree is not None:
            raise typer.BadParameter("--suggest changes no trust; leave out DEGREE.")
        _suggest_trust(speaker, kb, as_json=as_json)
        return
    if degree is None:
        with open_for_reading(kb) as base:
            known = base.trust_by_speaker()
            speaker = speaker and base.match_speaker(speaker)
        if speaker is not None and speaker not in known:
            raise NotFoundError("trusted speaker", speaker, known)
        shown = {name: known[name] for name in known if speaker in (None, name)}
    else:
        with open_base(kb) as base:
            name = base.match_speaker(str(speaker))
            shown = {name: base.set_trust(name, degree)}
    if as_json:
        print_json({name: {"lower": t.lower, "upper": t.upper} for name, t in shown.items()})
        return
    for name, interval in shown.items():
        typer.echo(f"{name} is trusted to {interval.lower:g}.", err=degree is not None)


def _suggest_trust(speaker: str | None, kb: str | None, *, as_json: bool) -> None:
    from ...inference.experience import read_records, teacher_records

    with open_for_reading(kb) as base:
        name = speaker and base.match_speaker(speaker)
        found = teacher_records(base.rules(), base.trust_by_speaker(), read_records(base))
    shown = [one for one in found if name in {None, one.speaker}]
    show(shown, presentation.console.teachers, as_json=as_json)


@app.command(epilog=example("graph knife.svg --object knife"))
def graph(
    file: Annotated[
        str, typer.Argument(help='An .svg or .png file, or "-" for SVG on stdout.')
    ] = "rules.svg",
    *,
    name: Object = None,
    affordance: Affordance = None,
    context: Context = None,
    part: Part = None,
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
        source = base if moment is None else view(base, at=moment)
        rules = source.rules(
            object=name, affordance=affordance, context=context, part=part, speaker=speaker
        )
    found = graph_of(rules)
    if as_json:
        nodes = [{"id": node, **data} for node, data in found.nodes(data=True)]
        edges = [{"from": a, "to": b, **data} for a, b, data in found.edges(data=True)]
        print_json({"nodes": nodes, "edges": edges})
        return
    if len(rules) > MOST_RULES:
        raise DataError(
            f"{len(rules)} rules are too many for a picture (at most {MOST_RULES}). Choose some "
            'with --object, --affordance, --context or --speaker, or run "hilt export" for '
            "GraphML.",
            source=file,
        )
    _write(found, file)
    typer.echo(f"Drew {counted(len(rules), 'rule')} into {file}.", err=True)


def _write(graph: MultiDiGraph[str], file: str) -> None:
    from ...kb.formats.graphml import draw_graph

    suffix = ".svg" if file == STDIN else Path(file).suffix.lower()
    if suffix not in {".svg", ".png"}:
        raise DataError(f'the extension "{suffix}" is no picture; use .svg or .png.', source=file)
    write_bytes(file, draw_graph(graph, suffix[1:]))
