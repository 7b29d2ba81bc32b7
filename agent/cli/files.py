# SPDX-License-Identifier: Apache-2.0
"""Commands on files: export and import."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..presentation.wording import counted
from .common import open_base, open_for_reading, show, terminal
from .options import AsJson, Kb, app, example

if TYPE_CHECKING:
    from ...kb.merge import Summary

FORMATS = "turtle, turtle12, ntriples, rdfxml, trig, nquads, jsonld, sheet (YAML), csv, graphml"
FileFormat = Annotated[
    str | None,
    typer.Option("--format", help=f"{FORMATS}. Default: as the extension of the file says."),
]


@app.command(name="export", epilog=example("export rules.yaml"))
def export_(
    file: Annotated[str, typer.Argument(help='A file, packed if it ends in .gz, or "-".')],
    kb: Kb = None,
    file_format: FileFormat = None,
    only_rules: Annotated[
        bool, typer.Option("--rules", help="Only the rules, and what was said to teach them.")
    ] = False,
) -> None:
    """Write the rules or, in TriG, N-Quads and JSON-LD, the whole base to a file."""
    from ...kb.formats.registry import RULE_FORMATS, format_of
    from ...kb.formats.transfer import export_file

    chosen = format_of(file, file_format, "turtle")
    with open_for_reading(kb) as base, _progress("Writing", None) as advance:
        count = export_file(base, file, format=file_format, rules_only=only_rules, progress=advance)
    things = counted(count, "rule" if chosen.name in RULE_FORMATS else "triple")
    typer.echo(f"Wrote {things} to {file}.", err=True)
    if chosen.leaves_out and not only_rules:
        typer.echo(f"The format {chosen.name} leaves out {chosen.leaves_out}.", err=True)


@app.command(name="import", epilog=example("import rules.yaml --dry-run"))
def import_(
    file: Annotated[str, typer.Argument(help='A file, packed or not, or "-" for stdin.')],
    kb: Kb = None,
    file_format: FileFormat = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Check, and say what would come of it.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Read rules or a whole base: checked first, applied whole or not at all."""
    from ...kb.formats.transfer import import_file

    opened = open_for_reading if dry_run else open_base
    with opened(kb) as base, _progress("Reading", _size(file)) as advance:
        found = import_file(base, file, format=file_format, dry_run=dry_run, progress=advance)
    if as_json:
        show({"applied": not dry_run, **found.as_json()})
    else:
        _show(found, file, dry_run=dry_run)


def _show(found: Summary, file: str, *, dry_run: bool) -> None:
    read = "Would read" if dry_run else "Read"
    typer.echo(
        f"{read} {counted(found.new + found.known, 'rule')} from {file}: {found.new} new, "
        f"{found.known} already known, {found.conflicting} conflicting.",
        err=True,
    )
    for conflict in found.conflicts:
        typer.echo(f"  {conflict.new} contradicts {conflict.believed}", err=True)
    if found.conflicting > len(found.conflicts):
        typer.echo(f"  ... and {found.conflicting - len(found.conflicts)} more", err=True)
    if found.untrusted:
        typer.echo(
            f"Nobody trusts {', '.join(found.untrusted)}, so what they say weighs nothing. "
            "Run: hilt trust NAME DEGREE",
            err=True,
        )


def _size(file: str) -> int | None:
    try:
        return Path(file).stat().st_size
    except OSError:
        return None


@contextmanager
def _progress(doing: str, total: int | None) -> Generator[Callable[[int], None]]:
    """A bar on stderr while something long is done; nothing where nobody watches."""
    from rich import progress

    out = terminal(stderr=True)
    columns = (
        progress.TextColumn("{task.description}"),
        progress.BarColumn(),
        progress.TaskProgressColumn() if total else progress.MofNCompleteColumn(),
        progress.TimeElapsedColumn(),
    )
    with progress.Progress(
        *columns, console=out, transient=True, disable=not out.is_terminal
    ) as bar:
        task = bar.add_task(doing, total=total)
        yield lambda done: bar.update(task, completed=done)
