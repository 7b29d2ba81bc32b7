"""The application object, and the options that several commands share."""

import inspect
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

from ...ontology.errors import check_simulator
from ..config import OPTIONS, AgentConfig, ConfigOption, is_plugin, read_values
from ..config_files import KEYS, configured, lasting_values, variable

app = typer.Typer(
    name="hilt",
    epilog="--kb, --scene, --seed, --speaker and --json may also stand before the command; "
    "anywhere, --verbose logs what is done and how long that takes, --debug shows the traceback of "
    "an error. hilt COMMAND --help has an example.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def example(command: str) -> str:
    """What stands below the help of a command: how it is used."""
    return f"Example: hilt {command}"


def _show_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"hilt {version('hilt')}")
        raise typer.Exit


@app.callback()
def hilt(
    *,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Learn from plain sentences what objects are for and how to hold them, and act on it."""


def _lasting_base(value: str | None) -> str | None:
    return value or configured()["base"].value


def _lasting_speaker(context: typer.Context, value: str | None) -> str | None:
    source, found = context.get_parameter_source("speaker"), configured()["speaker"]
    is_given = source is not None and source.name == "COMMANDLINE"
    return value if is_given or found.origin == "default" else found.value


Utterance = Annotated[
    str, typer.Argument(help='What to say; "-" reads lines from stdin, and answers each in JSON.')
]
Kb = Annotated[
    str | None,
    typer.Option(
        callback=_lasting_base,
        envvar=variable("base"),
        help='The knowledge base: "memory:", a folder, or the http(s) address of a SPARQL '
        "endpoint. By default that of `hilt config`.",
    ),
]
Record = Annotated[Path | None, typer.Option(help="Film what is done: a .mp4, .gif or .png file.")]
Speaker = Annotated[
    str, typer.Option(callback=_lasting_speaker, show_default=False, help=KEYS["speaker"].help)
]
Host = Annotated[
    str | None,
    typer.Option(callback=_lasting_speaker, help="Who is speaking; by default who taught first."),
]
Heard = Annotated[float, typer.Option(min=0.0, max=1.0, help="How surely a recogniser heard it.")]
Recognisers = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME[:REST]",
        help="moonshine, pocketsphinx, or a plug-in; may be repeated. By default these two.",
    ),
]
KeptSound = Annotated[Path | None, typer.Option(help="Keep what is said as sound in this folder.")]
Alternatives = Annotated[
    str | None,
    typer.Option(
        metavar="JSON",
        help="What a recogniser may have heard: a list of [text, score], scores in [0, 1]; @FILE "
        'reads a file, "-" stdin. Then what is not sure is read back.',
    ),
]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Only check; report what would change.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document.")]
Out = Annotated[Path, typer.Option(help="The folder for pictures and the animation.")]
Seed = Annotated[int, typer.Option(min=0, help=OPTIONS["seed"].help)]
Gui = Annotated[bool, typer.Option("--gui", help=OPTIONS["gui"].help)]
UserLexicon = Annotated[Path | None, typer.Option(help=OPTIONS["lexicon"].help)]
ConfigFile = Annotated[
    Path | None,
    typer.Option(help="A YAML or TOML file with options; those given here replace its own."),
]

SCENE = ("scene", "seed", "objects")
ROBOT = ("robot", "vision", "motion", "noise", "gui", "simulate")
LANGUAGE = ("objects", "actions", "lexicon")
INFERENCE = ("induce", "contexts", "settings", "overrides", "taxonomy")
EVERY = tuple(OPTIONS)


def with_config(*names: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command these options of `AgentConfig`, and `--config`, for its parameter `config`."""

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def run(**given: Any) -> None:
            file: Path | None = given.pop("config")
            values = {**lasting_values(), **(read_values(file) if file else {})}
            for name in names:
                if (value := given.pop(name)) is not None and value != []:
                    values[name] = tuple(value) if isinstance(value, list) else value
            config = AgentConfig(**values)
            moves = "simulate" in names and config.simulate and not given.get("bare")
            if moves and not is_plugin(config.vision):
                check_simulator()
            command(config=config, **given)

        own = inspect.signature(command, eval_str=True).parameters
        options = [_parameter(OPTIONS[name]) for name in names]
        others = [own[name] for name in own if name != "config"]
        parameters = [*options, _keyword("config", ConfigFile), *others]
        parameters.sort(key=lambda each: each.kind)  # keywords come last
        setattr(run, "__signature__", inspect.Signature(parameters))  # noqa: B010 - typer reads it
        run.__annotations__ = {each.name: each.annotation for each in parameters}
        return run

    return decorate


def _parameter(option: ConfigOption) -> inspect.Parameter:
    kind, default = list[str] if option.kind is tuple else option.kind, option.default
    is_shown = isinstance(default, str | int) and not isinstance(default, bool) and default != ""
    declared = typer.Option(
        option.flag or f"--{option.name}",
        help=option.help + (f" [default: {default}]" if is_shown else ""),
        metavar=option.metavar,
        min=0 if option.kind is int else None,
    )
    return _keyword(option.name, Annotated[kind | None, declared])


def _keyword(name: str, annotation: Any) -> inspect.Parameter:
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation
    )
