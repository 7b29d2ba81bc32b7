"""Commands on what options are when they are not given: config show, config path."""

from pathlib import Path

import typer

from ...ontology.logs import shown
from ..config import default_location
from ..config_files import configured, user_file
from .common import print_json
from .options import AsJson, app, example

config_app = typer.Typer(help="Show what options are by default.", invoke_without_command=True)
app.add_typer(config_app, name="config")


@config_app.callback()
def bare(context: typer.Context, *, as_json: AsJson = False) -> None:
    """Do as `config show` when no other command follows."""
    if context.invoked_subcommand is None:
        show(as_json=as_json)


@config_app.command(epilog=example("config show --json"))
def show(*, as_json: AsJson = False) -> None:
    """Show the value of each key, and where it comes from; "hilt config" alone does the same."""
    found = configured()
    plain = ((name, each.value) for name, each in found.items())
    values = {name: str(each) if isinstance(each, Path) else each for name, each in plain}
    values["base"] = shown(str(values["base"] or default_location()))
    if as_json:
        origins = {name: {"from": each.origin, "place": each.place} for name, each in found.items()}
        print_json({name: {"value": values[name], **origins[name]} for name in found})
        return
    for name, each in found.items():
        value = "-" if values[name] in {"", None, ()} else str(values[name])
        typer.echo(f"{name:<10} {value:<30} {each.place or each.origin}")


@config_app.command(epilog=example("config path"))
def path() -> None:
    """Print the path of your own file, which is written with an editor."""
    typer.echo(user_file())
