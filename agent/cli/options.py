# SPDX-License-Identifier: Apache-2.0
"""The application object, and the options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    name="hilt",
    epilog="--kb, --scene, --seed, --speaker and --json may also stand before the command; "
    "--debug, anywhere, shows the traceback of an error. hilt COMMAND --help has an example.",
    add_completion=False,
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


Utterance = Annotated[
    str, typer.Argument(help='What to say; "-" reads lines from stdin, and answers each in JSON.')
]
Kb = Annotated[
    str | None,
    typer.Option(
        "--kb",
        envvar="HILT_KB",
        help='The knowledge base: "memory:", a folder, or the http(s) address of a SPARQL '
        "endpoint. By default a folder in your data directory.",
    ),
]
SceneSpec = Annotated[
    str,
    typer.Option(
        "--scene", help="What is on the table: a YAML file, objects:knife,mug, random:SEED, or all."
    ),
]
Objects = Annotated[
    Path | None,
    typer.Option("--objects", help="A YAML file with objects of your own, besides Hilt's."),
]
Robot = Annotated[
    str, typer.Option("--robot", help="The robot: panda, kuka, or one of a file, FILE.yaml:NAME.")
]
Eyes = Annotated[
    str,
    typer.Option(
        "--vision",
        metavar="mask|learned[:FILE]",
        help="Where percepts come from: the simulator's mask, or what was learned from pictures.",
    ),
]
NoiseText = Annotated[
    str,
    typer.Option(
        "--noise",
        metavar="KEY=VALUE,...",
        help="How the eyes fail: missed, confused, confidence (shares), depth_m (metres).",
    ),
]
Record = Annotated[
    Path | None,
    typer.Option("--record", help="Film what is done: a .mp4, .gif or .png file."),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="The seed of everything random.")]
Speaker = Annotated[str, typer.Option("--speaker", help="Who is speaking.")]
Heard = Annotated[
    float, typer.Option("--heard", min=0.0, max=1.0, help="How surely a recogniser heard it.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document.")]
Gui = Annotated[bool, typer.Option("--gui", help="Show the simulator's window.")]
NoSim = Annotated[bool, typer.Option("--no-sim", help="Decide, but do not move a robot.")]
Induce = Annotated[
    bool,
    typer.Option("--induce", help="Also act on what follows by likeness from what was told."),
]
Out = Annotated[Path, typer.Option("--out", help="The folder for pictures and the animation.")]
ActionsFile = Annotated[
    Path | None, typer.Option("--actions", help="A YAML file with actions of your own.")
]
Contexts = Annotated[
    list[str] | None,
    typer.Option(
        "--context",
        help="What holds now: place:kitchen, role:guest; place:kitchen=0.9 where it is not sure.",
    ),
]
SettingsFile = Annotated[
    Path | None, typer.Option("--settings", help="A YAML file with choices of the inference.")
]
Choices = Annotated[
    list[str] | None,
    typer.Option(
        "--set", help="One choice of the inference: fusion=dempster, threshold.pass=0.1, ..."
    ),
]
UserLexicon = Annotated[
    Path | None, typer.Option("--lexicon", help="A lexicon file of your own, added to English.")
]
