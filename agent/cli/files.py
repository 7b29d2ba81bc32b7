"""Commands on files: export, import, validate, backup, restore."""

import os
from collections.abc import Callable, Generator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...ontology.errors import DataError
from .. import presentation
from ..presentation.plain_text import counted
from . import common
from .options import AsJson, DryRun, Kb, app, example

if TYPE_CHECKING:
    from ...kb.validation import ValidationFinding

FORMATS = "turtle, turtle12, ntriples, rdfxml, trig, nquads, jsonld, sheet (YAML), csv, graphml"
FileFormat = Annotated[
    str | None,
    typer.Option("--format", help=f"{FORMATS}. Default: as the extension of the file says."),
]
MOST_TEXT = 64 * 2**20  # bytes of a file in which lines are looked up
WITH_LINES = {".ttl", ".trig", ".nt", ".nq"}


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
    from ...kb.formats.import_export import export_file
    from ...kb.formats.registry import RULE_FORMATS, format_of

    chosen = format_of(file, file_format, "turtle")
    with common.open_for_reading(kb) as base, _progress("Writing") as advance:
        count = export_file(base, file, format=file_format, rules_only=only_rules, progress=advance)
    things = counted(count, "rule" if chosen.name in RULE_FORMATS else "triple")
    typer.echo(f"Wrote {things} to {file}.", err=True)
    if chosen.leaves_out and not only_rules:
        typer.echo(f"The format {chosen.name} leaves out {chosen.leaves_out}.", err=True)


@app.command(name="import", epilog=example("import rules.yaml --dry-run"))
def import_(
    file: Annotated[str, typer.Argument(help='A file, packed or not, or "-" for stdin.')],
    *,
    kb: Kb = None,
    file_format: FileFormat = None,
    as_: Annotated[
        str, typer.Option("--as", help='"rules", or "ontology": any RDF, beside the rules.')
    ] = "rules",
    name: Annotated[
        str | None, typer.Option(help="The name of the ontology; by default the file's.")
    ] = None,
    dry_run: DryRun = False,
    as_json: AsJson = False,
) -> None:
    """Read rules, a whole base or an ontology: checked first, applied whole or not at all."""
    if as_ == "ontology":
        from ...kb.formats.ontology import import_ontology

        with common.open_to_change(kb, dry_run=dry_run) as base:
            read = import_ontology(base, file, name=name, format=file_format, dry_run=dry_run)
        summary = {"applied": not dry_run, **read.as_json()}
        text = (
            f"{'Would read' if dry_run else 'Read'} {counted(read.statements, 'statement')} into "
            f"{summary['graph']}: {read.added} new, {read.removed} gone."
        )
        common.announce(summary, text, as_json=as_json, err=True)
        return
    if as_ != "rules":
        raise DataError(f'expected "rules" or "ontology", found "{as_}".', source="--as")
    from ...kb.formats.import_export import import_file

    size = Path(file).stat().st_size if os.access(file, os.R_OK) else None
    with common.open_to_change(kb, dry_run=dry_run) as base, _progress("Reading", size) as advance:
        found = import_file(base, file, format=file_format, dry_run=dry_run, progress=advance)
    common.show_import(found, file, dry_run=dry_run, as_json=as_json)


@contextmanager
def _progress(doing: str, total: int | None = None) -> Generator[Callable[..., None]]:
    from rich import progress

    done = progress.TaskProgressColumn() if total else progress.MofNCompleteColumn()
    bars, out = presentation.console, common.terminal(stderr=True)
    with bars.progress_bar(out, done, progress.TimeElapsedColumn()) as bar:
        task = bar.add_task(doing, total=total)

        def advance(done: int, whole: int | None = total) -> None:
            bar.update(task, completed=done, total=whole)

        yield advance


@app.command(epilog=example("validate rules.ttl"))
def validate(
    file: Annotated[
        str | None, typer.Argument(help="What import reads; by default the base itself.")
    ] = None,
    *,
    file_format: FileFormat = None,
    deep: Annotated[
        bool, typer.Option("--deep", help="First read every table of a base that is a folder.")
    ] = False,
    repair: Annotated[
        bool, typer.Option("--repair", help="First make anew what follows from the rules.")
    ] = False,
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Check a file, or the base, against the shapes and the laws of rules; change nothing else."""
    if repair:
        with common.open_to_change(kb, dry_run=False) as base:
            base.derive()
    try:
        found = _findings(file, file_format, kb, deep=deep)
    except DataError as error:
        if as_json:  # what cannot be read is told there, too
            common.print_json([_as_json(one) for one in error.mistakes or (error,)])
        raise
    if as_json:
        common.print_json([finding.as_json() for finding in found])
    else:
        for finding in found:
            where = ":".join(str(part) for part in (file, finding.line) if part)
            typer.echo(f"{where}: {finding}" if where else str(finding))
        typer.echo(f"{counted(len(found), 'finding')}." if found else "Valid.", err=True)
    common.exit_with(not found)


def _as_json(error: DataError) -> dict[str, object]:
    where = {"line": error.line or None, "column": error.column or None}
    return {"node": None, "property": None, **where, "problem": error.problem}


def _findings(
    file: str | None, file_format: str | None, kb: str | None, *, deep: bool
) -> "list[ValidationFinding]":
    from ...kb.formats.import_export import read_file
    from ...kb.stores.base import EmbeddedStore
    from ...kb.validation import findings, locate_findings

    if file is None:
        with common.open_for_reading(kb) as base, _progress("Checking") as progress:
            if deep and isinstance(base.store, EmbeddedStore):
                base.store.check_tables()
            return findings(base.store, whole=True, progress=progress)
    with closing(read_file(file, format=file_format)) as staged, _progress("Checking") as progress:
        found = findings(staged, progress=progress)
    path = Path(file)
    has_lines = path.suffix.lower() in WITH_LINES and path.stat().st_size <= MOST_TEXT
    text = path.read_text(encoding="utf-8", errors="replace") if found and has_lines else ""
    return locate_findings(found, text)


@app.command(epilog=example("backup saved/"))
def backup(
    folder: Annotated[Path, typer.Argument(help="A new folder.")],
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Copy the knowledge base into a folder, while it is in use; the copy is read back."""
    from ...kb.backup import backup as save

    with common.open_for_reading(kb) as base:
        number = save(base, folder)
    text = f"Saved up to utterance {number} in {folder}."
    common.announce({"backup": str(folder), "sequence": number}, text, as_json=as_json, err=True)


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

    number = put_back(folder, kb or str(default_location()), replace=replace)
    text = f"Restored up to utterance {number} from {folder}."
    common.announce({"restored": str(folder), "sequence": number}, text, as_json=as_json, err=True)
