"""Commands on the rules: rules, trust, graph; and in SPARQL: query, update."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from ...ontology.errors import DataError, NotFoundError, QueryError
from .. import presentation
from ..presentation.plain_text import counted
from . import common
from .options import AsJson, DryRun, Kb, Speaker, app, example

MOST_RULES = 500  # in one picture; nobody finds anything in more
Object = Annotated[str | None, typer.Option("--object", help="About this object.")]
Affordance = Annotated[str | None, typer.Option(help="Used for this.")]
Context = Annotated[str | None, typer.Option(help="For this action.")]
Part = Annotated[str | None, typer.Option(help="Grasped by this part.")]
TABLE = "table"
Timeout = Annotated[float, typer.Option(min=0.001, help="Time limit in seconds.")]
Memory = Annotated[int, typer.Option(min=1, help="Memory limit in megabytes.")]


@app.command(epilog=example("rules --object knife --at 2026-11-21"))
def rules(
    *,
    at: Annotated[
        str | None, typer.Option(help="As they were: a date, a time, an utterance number.")
    ] = None,
    according_to: Annotated[
        str | None, typer.Option(metavar="SPEAKER", help="As this one sees it.")
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
    with common.open_for_reading(kb) as base:
        is_now = moment is None and according_to is None
        according_to = according_to and base.match_speaker(according_to)
        source = base if is_now else view(base, at=moment, according_to=according_to)
        found = source.rules(object=name, affordance=affordance, context=context, part=part)
    common.show(found, presentation.console.rules, as_json=as_json)


@app.command(epilog=example("trust anna 0.9"))
def trust(
    speaker: Annotated[str | None, typer.Argument(help="Who; by default all are listed.")] = None,
    degree: Annotated[float | None, typer.Argument(min=0.0, max=1.0, help="The trust.")] = None,
    *,
    suggest: Annotated[
        bool, typer.Option("--suggest", help="Show what experience says; nothing is changed.")
    ] = False,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Set the trust in a speaker, 0 for none; or show the trust in each speaker."""
    from ..documents import trust_as_json

    if suggest:
        if degree is not None:
            raise typer.BadParameter("--suggest changes no trust; leave out DEGREE.")
        _suggest_trust(speaker, kb, as_json=as_json)
        return
    if degree is None:
        with common.open_for_reading(kb) as base:
            known = base.trust_by_speaker()
            speaker = speaker and base.match_speaker(speaker)
        if speaker is not None and speaker not in known:
            raise NotFoundError("trusted speaker", speaker, known)
        shown = {name: known[name] for name in known if speaker in (None, name)}
    else:
        with common.open_base(kb) as base:
            name = base.match_speaker(str(speaker))
            shown = {name: base.set_trust(name, degree)}
    if as_json:
        common.print_json(trust_as_json(shown))
        return
    for name, interval in shown.items():
        typer.echo(f"{name} is trusted to {interval.lower:g}.", err=degree is not None)


def _suggest_trust(speaker: str | None, kb: str | None, *, as_json: bool) -> None:
    from ...inference.experience import read_records, teacher_records

    with common.open_for_reading(kb) as base:
        name = speaker and base.match_speaker(speaker)
        found = teacher_records(base.rules(), base.trust_by_speaker(), read_records(base))
    shown = [one for one in found if name in {None, one.speaker}]
    common.show(shown, presentation.console.teachers, as_json=as_json)


@app.command(epilog=example("graph knife.svg --object knife"))
def graph(
    file: Annotated[str, typer.Argument(help='An .svg or .png file; "-": print SVG')] = "rules.svg",
    *,
    name: Object = None,
    affordance: Affordance = None,
    context: Context = None,
    part: Part = None,
    speaker: Annotated[str | None, typer.Option(help="Told by this one.")] = None,
    at: Annotated[str | None, typer.Option(help="As they were at some time.")] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Draw the rules as a graph, coloured by context; --json prints it and draws nothing."""
    from ...kb.formats.graphml import draw_graph, graph_of
    from ...kb.views import parse_moment, view
    from ..documents import graph_as_json

    moment = None if at is None else parse_moment(at)
    with common.open_for_reading(kb) as base:
        source = base if moment is None else view(base, at=moment)
        rules = source.rules(
            object=name, affordance=affordance, context=context, part=part, speaker=speaker
        )
    if as_json:
        common.print_json(graph_as_json(rules))
        return
    if len(rules) > MOST_RULES:
        problem = f"{len(rules)} rules are too many for a picture (at most {MOST_RULES})."
        choice = "Choose some with --object, --affordance, --context or --speaker,"
        raise DataError(f'{problem} {choice} or run "hilt export" for GraphML.', source=file)
    suffix = ".svg" if file == common.STDIN else Path(file).suffix.lower()
    if suffix not in {".svg", ".png"}:
        raise DataError(f'the extension "{suffix}" is no picture; use .svg or .png.', source=file)
    common.write_bytes(file, draw_graph(graph_of(rules), suffix[1:]))
    typer.echo(f"Drew {counted(len(rules), 'rule')} into {file}.", err=True)


@app.command(epilog=example("query best-for --arg affordance=cutting"))
def query(
    question: Annotated[
        str | None,
        typer.Argument(help='The name of a named query, SPARQL, a .rq file, or "-" for stdin.'),
    ] = None,
    *,
    arg: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE", help="The value of a variable of the query; may be repeated."
        ),
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List the named queries.")] = False,
    format_: Annotated[
        str,
        typer.Option("--format", help="The output format: table, json, csv, tsv, xml or turtle."),
    ] = TABLE,
    timeout: Timeout = 30.0,
    memory: Memory = 2048,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Run a named query or a SPARQL query. The prefixes of the vocabulary need no declaration."""
    if list_:
        _list_queries(as_json=as_json)
        return
    if question is None:
        raise QueryError(
            "No query was given. Give the name of a named query, or SPARQL; --list shows the names."
        )
    from ...kb.sparql.named_queries import named_query, read_query
    from ...kb.sparql.results import QueryLimits
    from ...kb.stores.rdf_text import write_result

    text = common.read_sparql(question)
    is_name = text == question and all(sign.isalnum() or sign == "-" for sign in text)
    asked = named_query(text) if is_name else read_query(text)
    bindings = asked.bindings(_arguments(arg or ()))
    with common.open_for_reading(kb) as base, common.spinner("Searching"):
        found = base.query(asked.text, bindings, limits=QueryLimits(timeout, memory))
    if format_ == TABLE and not as_json:
        common.terminal().print(presentation.console.results(found))
    else:
        typer.echo(write_result(found, "json" if as_json else format_), nl=False)


@app.command(epilog=example("update change.ru --dry-run"))
def update(
    sparql: Annotated[str, typer.Argument(help='A SPARQL update, a .ru file, or "-" for stdin.')],
    *,
    dry_run: DryRun = False,
    speaker: Speaker = "sam",
    timeout: Timeout = 30.0,
    memory: Memory = 2048,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Run a SPARQL update, after checking everything that it would change."""
    from ...kb.sparql.results import QueryLimits
    from ...kb.sparql_update import update as apply

    with common.open_to_change(kb, dry_run=dry_run) as base:
        text, limits = common.read_sparql(sparql), QueryLimits(timeout, memory)
        said = apply(base, text, speaker=speaker, limits=limits, dry_run=dry_run)
    number = said.sequence if said else None
    updated = f"Updated; number {number} in history." if said else "That changes nothing."
    done = "The update is valid." if dry_run and said else updated
    found = {"updated": bool(said) and not dry_run, "sequence": number}
    common.announce(found, done, as_json=as_json, err=True)


def _arguments(given: Sequence[str]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for one in given:
        name, _, value = one.partition("=")
        if not (name and value):
            raise QueryError(f'"{one}" gives no value: expected NAME=VALUE.')
        found.setdefault(name, []).append(value)
    return found


def _list_queries(*, as_json: bool) -> None:
    from ...kb.sparql.named_queries import named_query, query_names
    from ..documents import question_as_json

    named = [named_query(name) for name in query_names()]
    if as_json:
        common.print_json([question_as_json(one) for one in named])
        return
    common.terminal().print(presentation.console.questions(named))
