# SPDX-License-Identifier: Apache-2.0
"""The command line: `hilt COMMAND`.

Every command that prints a result takes `--json`: one document on stdout and nothing else there.
Exit codes: 0 done, 1 what was asked for failed, 2 wrong usage or unreadable input. Errors are one
line on stderr; `--debug` adds the traceback. What a command needs is imported when it runs, so that
`hilt --help` answers at once.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..ontology.errors import DataError, HiltError, IntervalError, QueryError, UnknownNameError

if TYPE_CHECKING:
    from rich.console import Console

    from .agent import Agent
    from .outcome import Json
    from .reply import Reply

FAILED, WRONG_USAGE, INTERRUPTED = 1, 2, 130
MAY_LEAD = {"--kb": 1, "--scene": 1, "--seed": 1, "--speaker": 1, "--json": 0}  # option: values
UNREADABLE = (DataError, IntervalError, QueryError, UnknownNameError)

app = typer.Typer(
    name="hilt",
    help="Learn from plain sentences what objects are for and how to hold them, and act on it.",
    epilog="--kb, --scene, --seed, --speaker and --json may also stand before the command.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

Utterance = Annotated[str, typer.Argument(help='What to say, or "-" for a line each from stdin.')]
Kb = Annotated[
    str | None,
    typer.Option(
        "--kb",
        envvar="HILT_KB",
        help='The knowledge base: "memory:", a folder, or the http(s) address of a SPARQL '
        "endpoint. Default: a folder in your data directory.",
    ),
]
SceneSpec = Annotated[
    str,
    typer.Option(
        "--scene", help="What is on the table: a YAML file, objects:knife,mug, random:SEED, or all."
    ),
]
Seed = Annotated[int, typer.Option("--seed", help="The seed of everything random.")]
Speaker = Annotated[str, typer.Option("--speaker", help="Who is speaking.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document.")]
Gui = Annotated[bool, typer.Option("--gui", help="Show the simulator's window.")]
NoSim = Annotated[bool, typer.Option("--no-sim", help="Decide, but do not move a robot.")]
Out = Annotated[Path, typer.Option("--out", help="The folder for pictures and the animation.")]


# --- Talking to the robot ------------------------------------------------------------------


@app.command()
def demo(
    *,
    kb: Kb = "memory:",
    seed: Seed = 7,
    out: Out = Path("out/demo"),
    gui: Gui = False,
    no_sim: NoSim = False,
) -> None:
    """Run the paper's running example: three sentences, and a knife passed by the blade."""
    from .demo import run

    with _agent(kb, scene="all", seed=seed, gui=gui, no_sim=no_sim) as agent:
        _finish(run(agent, _console(), out))


@app.command()
def tell(
    text: Utterance, *, kb: Kb = None, speaker: Speaker = "sam", as_json: AsJson = False
) -> None:
    """Teach a rule: "A knife is used for cutting"."""
    with _agent(kb) as agent:
        _converse(
            agent,
            text,
            lambda said: agent.hear(said, speaker=speaker, only="tell"),
            (lambda reply: reply.as_tell_json()) if as_json else None,
        )


@app.command()
def do(
    text: Utterance,
    *,
    kb: Kb = None,
    scene: SceneSpec = "all",
    seed: Seed = 0,
    speaker: Speaker = "sam",
    as_json: AsJson = False,
    gui: Gui = False,
    no_sim: NoSim = False,
) -> None:
    """Ask for something to be done: "pass me something used for cutting"."""
    with _agent(kb, scene=scene, seed=seed, gui=gui, no_sim=no_sim) as agent:
        _converse(
            agent,
            text,
            lambda said: agent.hear(said, speaker=speaker, only="do"),
            (lambda reply: reply.as_do_json()) if as_json else None,
        )


@app.command()
def ask(
    text: Utterance,
    *,
    kb: Kb = None,
    scene: SceneSpec = "all",
    seed: Seed = 0,
    speaker: Speaker = "sam",
    as_json: AsJson = False,
) -> None:
    """Ask what is known: "what is a knife used for?"."""
    with _agent(kb, scene=scene, seed=seed, no_sim=True) as agent:
        _converse(
            agent,
            text,
            lambda said: agent.hear(said, speaker=speaker, only="ask"),
            (lambda reply: reply.as_ask_json()) if as_json else None,
        )


@app.command()
def chat(
    *,
    kb: Kb = None,
    scene: SceneSpec = "all",
    seed: Seed = 0,
    speaker: Speaker = "sam",
    gui: Gui = False,
    no_sim: NoSim = False,
) -> None:
    """Talk: teach, ask and command, a line each; /rules, /why, /scene and /quit."""
    from .chat import run

    with _agent(kb, scene=scene, seed=seed, gui=gui, no_sim=no_sim) as agent:
        run(agent, _console(), sys.stdin, speaker)


@app.command()
def parse(text: Utterance, *, speaker: Speaker = "sam", as_json: AsJson = False) -> None:
    """Show how a sentence is understood: derivation, predicate form, meaning."""
    from ..nlu.language import Language
    from . import console

    language = Language.load()
    understood = [language.understand(said, speaker=speaker) for said in _utterances(text)]
    for found in understood:
        _show(found.as_json()) if as_json else _console().print(console.understood(found))
    _finish(all(found.reading is not None for found in understood))


# --- The knowledge base --------------------------------------------------------------------


@app.command()
def rules(*, kb: Kb = None, as_json: AsJson = False) -> None:
    """List the rules that were told and hold."""
    with _base(kb) as base:
        found = base.rules()
        if as_json:
            _show([rule.as_json() for rule in found])
        else:
            from . import console

            _console().print(console.rules(found))


@app.command()
def query(
    sparql: Annotated[str, typer.Argument(help="SPARQL, or a file that holds it.")],
    kb: Kb = None,
    as_json: AsJson = False,
) -> None:
    """Ask the graph in SPARQL; the prefixes are declared already."""
    from . import console

    with _base(kb) as base:
        found = base.query(_text_of(sparql))
        _show(found.as_json()) if as_json else _console().print(console.results(found))


@app.command(name="export")
def export_(
    file: Annotated[str, typer.Argument(help='A .ttl or .trig file, or "-" for stdout.')],
    kb: Kb = None,
) -> None:
    """Write the rules (Turtle) or the whole base (TriG) to a file."""
    from ..kb.exchange import export_file

    with _base(kb) as base:
        count = export_file(base, file)
    typer.echo(f"Wrote {count} triples to {file}.", err=True)


@app.command(name="import")
def import_(
    file: Annotated[str, typer.Argument(help='A .ttl or .trig file, or "-" for stdin.')],
    kb: Kb = None,
) -> None:
    """Read rules (Turtle) or a whole base (TriG): checked first, applied whole or not at all."""
    from ..kb.exchange import import_file

    with _base(kb) as base:
        count = import_file(base, file)
    typer.echo(f"Read {count} triples from {file}.", err=True)


@app.command()
def trust(
    speaker: Annotated[str, typer.Argument(help="Who.")],
    degree: Annotated[float, typer.Argument(min=0.0, max=1.0, help="How far, in [0, 1].")],
    kb: Kb = None,
) -> None:
    """Say how far a speaker is to be trusted; 0 is not at all."""
    with _base(kb) as base:
        base.set_trust(speaker, degree)
    typer.echo(f"{speaker} is trusted to {degree:g}.", err=True)


@app.command()
def evaluate(
    what: Annotated[str, typer.Argument(help="paper (Table 2) or grasps (16 combinations).")],
    poses: Annotated[int, typer.Option(min=1, help="Random poses for each combination.")] = 3,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Repeat the paper's evaluation: Table 2's decisions, or the running example's grasps."""
    from . import evaluation

    report = evaluation.run(what, poses=poses, seed=seed, console=_console(stderr=True))
    _show(report.as_json()) if as_json else _console().print(report.table())
    _finish(report.is_right)


# --- Helpers -------------------------------------------------------------------------------


def _agent(
    kb: str | None,
    *,
    scene: str = "all",
    seed: int = 0,
    gui: bool = False,
    no_sim: bool = False,
) -> Agent:
    from .agent import Agent

    return Agent.open(kb, scene=scene, seed=seed, gui=gui, simulate=not no_sim)


def _base(kb: str | None):
    from .agent import open_base

    return open_base(kb)


def _console(*, stderr: bool = False) -> Console:
    from rich.console import Console

    return Console(stderr=stderr, highlight=False)


def _converse(
    agent: Agent,
    text: str,
    hear: Callable[[str], Reply],
    as_json: Callable[[Reply], Json] | None,
) -> None:
    """Say each utterance and print each reply as soon as it is there."""
    done = True
    for said in _utterances(text):
        reply = hear(said)
        done = done and reply.is_done
        if as_json:
            _show(as_json(reply))
        elif reply.ending == "not_understood":
            _complain(reply.said)
        else:
            _show_reply(agent, reply)
    _finish(done)


def _show_reply(agent: Agent, reply: Reply) -> None:
    from . import console

    out = _console()
    out.print(console.turn(reply))
    if reply.achievement and reply.achievement.steps:
        out.print(console.achievement(reply.achievement, agent.quote))


def _utterances(text: str) -> Iterator[str]:
    """The text itself, or for "-" the lines of stdin that hold something."""
    if text != "-":
        yield text
        return
    yield from (line.strip() for line in _lines(sys.stdin.buffer) if line.strip())


def _lines(stream: Iterable[bytes]) -> Iterator[str]:
    for number, line in enumerate(stream, start=1):
        try:
            yield line.decode("utf-8")
        except UnicodeDecodeError as error:
            raise DataError("expected UTF-8 text.", source="<stdin>", line=number) from error


def _text_of(text_or_file: str) -> str:
    """The content of a file when there is one of that name, else the text itself."""
    looks_like_file = "\n" not in text_or_file and "{" not in text_or_file
    if looks_like_file and Path(text_or_file).suffix in {".rq", ".sparql"}:
        try:
            return Path(text_or_file).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise DataError(f"cannot be read: {error}.", source=text_or_file) from error
    return text_or_file


def _show(document: object) -> None:
    typer.echo(json.dumps(document, ensure_ascii=False))
    sys.stdout.flush()


def _finish(done: bool) -> None:
    if not done:
        raise typer.Exit(FAILED)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command and exit with its code; the entry point of `hilt`."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in given
    sys.exit(_run([word for word in given if word != "--debug"], debug=debug))


def _run(arguments: Sequence[str], *, debug: bool) -> int:
    command = typer.main.get_command(app)
    try:
        return command.main(_reordered(arguments), prog_name="hilt", standalone_mode=False) or 0
    except HiltError as error:
        if debug:
            raise
        _complain(error)
        return WRONG_USAGE if isinstance(error, UNREADABLE) else FAILED
    except typer.Abort:
        return INTERRUPTED
    except Exception as error:
        if debug or not hasattr(error, "format_message"):
            raise
        message: str = error.format_message()  # pyright: ignore[reportAttributeAccessIssue]
        if arguments:
            _complain(f"{message.rstrip('.')}. Run: hilt --help")
        else:
            typer.echo(message)
        return WRONG_USAGE


def _complain(error: HiltError | str) -> None:
    typer.echo(f"hilt: {error}", err=True)
    if isinstance(error, DataError) and error.text and sys.stderr.isatty():
        typer.echo(error.excerpt(), err=True)


def _reordered(arguments: Sequence[str]) -> list[str]:
    """Options that lead the command moved behind it, where they are declared."""
    at = 0
    while at < len(arguments) and arguments[at].split("=")[0] in MAY_LEAD:
        name, _, value = arguments[at].partition("=")
        at += 1 if value else 1 + MAY_LEAD[name]
    return [*arguments[at : at + 1], *arguments[:at], *arguments[at + 1 :]]
