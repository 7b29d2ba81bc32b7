# SPDX-License-Identifier: Apache-2.0
"""Commands on the knowledge base: rules, export, import, trust."""

from __future__ import annotations

from typing import Annotated

import typer

from .common import open_base, open_for_reading, show, terminal
from .options import AsJson, Kb, app, example


@app.command(epilog=example("rules --object knife --at 2026-11-21"))
def rules(
    *,
    at: Annotated[
        str | None, typer.Option("--at", help="As they were: a date, a time, an utterance number.")
    ] = None,
    according_to: Annotated[
        str | None, typer.Option("--according-to", metavar="SPEAKER", help="As one sees it.")
    ] = None,
    name: Annotated[str | None, typer.Option("--object", help="About this object.")] = None,
    affordance: Annotated[str | None, typer.Option("--affordance", help="Used for this.")] = None,
    context: Annotated[str | None, typer.Option("--context", help="For this action.")] = None,
    part: Annotated[str | None, typer.Option("--part", help="Grasped by this part.")] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """List the rules that were told and hold, or held at some time, or that one person holds."""
    from ...kb.views import parse_moment, view

    moment = None if at is None else parse_moment(at)
    with open_for_reading(kb) as base:
        is_now = moment is None and according_to is None
        according_to = according_to and base.match_speaker(according_to)
        source = base if is_now else view(base.reader, at=moment, according_to=according_to)
        found = source.rules(object=name, affordance=affordance, context=context, part=part)
    if as_json:
        show([rule.as_json() for rule in found])
    else:
        from ..presentation import console

        terminal().print(console.rules(found))


@app.command(epilog=example("trust anna 0.9"))
def trust(
    speaker: Annotated[str | None, typer.Argument(help="Who; by default all are listed.")] = None,
    degree: Annotated[
        float | None, typer.Argument(min=0.0, max=1.0, help="How far, in [0, 1].")
    ] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Say how far a speaker is to be trusted, 0 is not at all; or show how far each one is."""
    from ...ontology.errors import NotFoundError

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
        show({name: {"lower": t.lower, "upper": t.upper} for name, t in shown.items()})
        return
    for name, interval in shown.items():
        typer.echo(f"{name} is trusted to {interval.lower:g}.", err=degree is not None)
