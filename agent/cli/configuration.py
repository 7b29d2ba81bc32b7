"""Commands on what options are when they are not given: config show, config set, config path."""

import os
from pathlib import Path
from typing import Annotated

import typer

from ...ontology.errors import UnknownNameError
from ...ontology.logs import shown
from ...ontology.yaml_reader import read_text
from ..config import (
    OPTIONS,
    AgentConfig,
    actions_with,
    default_location,
    household,
    load_language,
    read_value,
)
from ..config_files import FILE, KEYS, configured, parse_value, project_file, user_file
from .common import announce, print_json
from .options import AsJson, app, example

config_app = typer.Typer(
    help="Show and set what options are when they are not given.",
    invoke_without_command=True,
    rich_markup_mode=None,
)
app.add_typer(config_app, name="config")
Project = Annotated[
    bool, typer.Option("--project", help="The file of the project instead of your own.")
]


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


@config_app.command("set", epilog=example("config set speaker anna"))
def set_value(
    key: Annotated[str, typer.Argument(help="speaker, base, or the name of an option: robot.")],
    value: Annotated[
        str | None, typer.Argument(help="The value; without one the key is removed.")
    ] = None,
    *,
    project: Project = False,
    as_json: AsJson = False,
) -> None:
    """Keep a value for all commands to come."""
    from ...ontology.disk_cache import write_atomically
    from ...ontology.toml_reader import with_value

    if key not in KEYS:
        raise UnknownNameError("key", key, KEYS)
    path = _file(project=project)
    kept = None if value is None else _checked(key, value, beside=path.parent if project else None)
    text = read_text(path) if path.exists() else ""
    write_atomically(path, with_value(text, str(path), key, kept))
    value_shown = shown(kept) if isinstance(kept, str) else kept
    document = {"file": str(path), "key": key, "value": value_shown}
    announce(document, f"Written to {path}.", as_json=as_json, err=True)


@config_app.command(epilog=example("config path --project"))
def path(*, project: Project = False) -> None:
    """Print the path of your own file, or of the project's."""
    typer.echo(_file(project=project))


def _file(*, project: bool) -> Path:
    return (project_file() or Path.cwd() / FILE) if project else user_file()


def _checked(key: str, text: str, *, beside: Path | None) -> object:
    """What stands in the file for a value; a file is named absolutely, or as seen from `beside`."""
    from ..execution.embodiment import Embodiment

    node = parse_value(KEYS[key], text, f"hilt config set {key}")
    value = read_value(node, KEYS[key], Path.cwd())
    config = AgentConfig(**({key: value} if key in OPTIONS else {}))
    Embodiment.from_config(config)
    actions_with(config.actions)
    config.load_settings()
    if config.lexicon:
        load_language(household(), config.lexicon)
    if not KEYS[key].is_file(text):
        return node.plain()
    return os.path.relpath(value, beside) if beside else os.path.abspath(value)
