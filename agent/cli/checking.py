# SPDX-License-Identifier: Apache-2.0
"""The command that checks files and bases: validate."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...ontology.errors import DataError
from ..presentation.wording import counted
from .common import finish, open_for_reading, show, terminal
from .options import AsJson, Kb, app, example

if TYPE_CHECKING:
    from ...kb.validation import Finding

MOST_TEXT = 64 * 2**20  # bytes of a file in which lines are looked up
WITH_LINES = {".ttl", ".trig", ".nt", ".nq"}


@app.command(epilog=example("validate rules.ttl"))
def validate(
    file: Annotated[
        str | None, typer.Argument(help="What import reads; by default the base itself.")
    ] = None,
    *,
    file_format: Annotated[
        str | None, typer.Option("--format", help="The format; by default that of the extension.")
    ] = None,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Check a file, or the base, against the shapes and the laws of rules; change nothing."""
    try:
        found = _of_base(kb) if file is None else _of_file(file, file_format)
    except DataError as error:
        if as_json:  # what cannot be read is told there, too
            show([_as_json(one) for one in error.mistakes or (error,)])
        raise
    if as_json:
        show([finding.as_json() for finding in found])
    else:
        for finding in found:
            where = ":".join(str(part) for part in (file, finding.line) if part)
            typer.echo(f"{where}: {finding}" if where else str(finding))
        typer.echo(f"{counted(len(found), 'finding')}." if found else "Valid.", err=True)
    finish(not found)


def _as_json(error: DataError) -> dict[str, object]:
    """A mistake in a file that cannot be read, as findings are printed."""
    where = {"line": error.line or None, "column": error.column or None}
    return {"node": None, "property": None, **where, "problem": error.problem}


def _of_file(file: str, file_format: str | None) -> list[Finding]:
    from ...kb.formats.transfer import read_file
    from ...kb.staging import findings
    from ...kb.validation import locate_findings

    staged = read_file(file, format=file_format)
    try:
        with _progress() as progress:
            found = findings(staged, progress=progress)
    finally:
        staged.close()
    return locate_findings(found, _text(file) if found else "")


def _of_base(kb: str | None) -> list[Finding]:
    from ...kb.staging import findings

    with open_for_reading(kb) as base, _progress() as progress:
        return sorted(set(findings(base.store, progress=progress)))


def _text(file: str) -> str:
    """The text of a file whose lines begin with what they are about; of others nothing."""
    path = Path(file)
    if path.suffix.lower() not in WITH_LINES or path.stat().st_size > MOST_TEXT:
        return ""
    return path.read_text(encoding="utf-8", errors="replace")


@contextmanager
def _progress() -> Generator[Callable[[int, int], None]]:
    """A bar on a terminal, and nothing elsewhere."""
    from rich.progress import Progress

    with Progress(
        console=terminal(stderr=True), transient=True, disable=not sys.stderr.isatty()
    ) as bar:
        task = bar.add_task("Checking", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
