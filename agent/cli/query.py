"""Commands that run SPARQL: query and update."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from ...ontology.errors import QueryError
from .. import presentation
from . import common
from .options import AsJson, DryRun, Kb, Speaker, app, example

if TYPE_CHECKING:
    from ...kb.sparql.named_queries import NamedQuery
    from ...kb.sparql.results import QueryResult

TABLE = "table"
Timeout = Annotated[float, typer.Option("--timeout", min=0.001, help="Time limit in seconds.")]
Memory = Annotated[int, typer.Option("--memory", min=1, help="Memory limit in megabytes.")]


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
            "--arg",
            help="The value of a variable of the query; may be repeated.",
            metavar="NAME=VALUE",
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
        _list(as_json=as_json)
        return
    if question is None:
        raise QueryError(
            "No query was given. Give the name of a named query, or SPARQL; --list shows the names."
        )
    from ...kb.sparql.results import QueryLimits

    asked = _asked(question)
    bindings = asked.bindings(_arguments(arg or ()))
    with common.open_for_reading(kb) as base, common.spinner("Searching"):
        found = base.query(asked.text, bindings, limits=QueryLimits(timeout, memory))
    _print(found, "json" if as_json else format_)


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


def _asked(question: str) -> NamedQuery:
    from ...kb.sparql.named_queries import named_query, read_query

    text = common.read_sparql(question)
    is_name = text == question and all(sign.isalnum() or sign == "-" for sign in text)
    return named_query(text) if is_name else read_query(text)


def _arguments(given: Sequence[str]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for one in given:
        name, _, value = one.partition("=")
        if not (name and value):
            raise QueryError(f'"{one}" gives no value: expected NAME=VALUE.')
        found.setdefault(name, []).append(value)
    return found


def _print(found: QueryResult, format_: str) -> None:
    from ...kb.stores.result_serialization import write_result

    if format_ == TABLE:
        common.terminal().print(presentation.console.results(found))
    else:
        typer.echo(write_result(found, format_), nl=False)


def _list(*, as_json: bool) -> None:
    from ...kb.sparql.named_queries import named_query, query_names
    from ..documents import question_as_json

    named = [named_query(name) for name in query_names()]
    if as_json:
        common.print_json([question_as_json(one) for one in named])
        return
    common.terminal().print(presentation.console.questions(named))
