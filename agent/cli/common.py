"""Shared parts of the commands: opening bases, reading input, printing results and errors."""

import json
import os
import re
import shlex
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TextIO, cast

import typer

from ...ontology.errors import DataError, HiltError, StoreError, ValidationError
from ...ontology.yaml_reader import YamlNode, parse_yaml, read_text
from .. import config, config_files, presentation
from ..config import AgentConfig, open_base
from ..presentation.plain_text import printable

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from ...kb.bulk.reconciliation import ImportSummary
    from ...kb.knowledge_base import KnowledgeBase
    from ..agent import Agent

FAILED = 1  # exit code
STDIN = "-"  # instead of a text
MOST_MISTAKES = 20  # that are reported one by one


def open_for_reading(kb: str | None) -> "KnowledgeBase":
    """Open a knowledge base (None: the user's own) for reading, without waiting for writers.

    StoreError if there is none, or it cannot be read; nothing is created.
    """
    from ...kb.knowledge_base import KnowledgeBase

    location = kb or str(config.default_location())
    if location == "memory:" or location.startswith(("http://", "https://")):
        return open_base(location)
    try:
        return KnowledgeBase.open(location, read_only=True)
    except StoreError:
        require_base(kb)
        if ":" in location:
            raise
    return open_base(location)  # an older format, or it reports what is wrong


def require_base(kb: str | None) -> None:
    """Check that there is something at a location; StoreError, with what to do, if not."""
    location = kb or str(config.default_location())
    if not _is_missing(location):
        return
    is_usual = kb == config_files.configured()["base"].value
    named = "" if is_usual else f" --kb {shlex.quote(location)}"
    raise StoreError(
        f'There is no knowledge base "{location}". Teach it something, which creates it '
        f'(hilt tell{named} "A knife is used for cutting."), or name another with --kb.'
    )


def open_to_change(kb: str | None, *, dry_run: bool) -> "KnowledgeBase":
    """Open or create a knowledge base; for a dry run only read it, one that is missing as empty."""
    location = kb or str(config.default_location())
    if not dry_run or not _is_missing(location):
        return open_for_reading(kb) if dry_run else open_base(kb)
    typer.echo(f'There is no knowledge base "{location}" yet.', err=True)
    return open_base("memory:")


def open_agent(kb: str | None, config: AgentConfig) -> "Agent":
    """Open an agent over a knowledge base (None: the user's own); only now is it imported."""
    from ..agent import Agent

    return Agent.open(kb, config)


def _is_missing(location: str) -> bool:
    place = Path(location).expanduser()
    is_there = place.is_file() or (place.is_dir() and any(place.iterdir()))
    return ":" not in location and not is_there


def terminal(*, stderr: bool = False) -> "Console":
    """Return the console of the terminal, whose colours and width rich detects.

    Elsewhere lines are as long as their texts, unless COLUMNS says how long they may be.
    """
    from rich.console import Console

    stream = sys.stderr if stderr else sys.stdout
    colours = None if os.environ.get("NO_COLOR") else "auto"
    if stream.isatty():
        return Console(stderr=stderr, highlight=False, color_system=colours)
    width = None if os.environ.get("COLUMNS") else 100_000  # as long as it takes
    plain = cast("TextIO", _Unpadded(stream))
    return Console(file=plain, highlight=False, width=width, color_system=None)


class _Unpadded:
    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return self._stream.write(re.sub(r" +(?=\n)", "", text))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def spinner(doing: str) -> AbstractContextManager[object]:
    """Return a context that shows a spinner on stderr, if that is a terminal."""
    if not sys.stderr.isatty():
        return nullcontext()
    from rich.text import Text

    return terminal(stderr=True).status(Text(doing))


def converse(
    agent: "Agent",
    text: str,
    speaker: str,
    only: Literal["tell", "do", "ask"],
    *,
    heard: float = 1.0,
    others: Sequence[tuple[str, float]] = (),
    as_json: bool,
) -> None:
    """Say each utterance and print its reply at once; exit with code 1 unless all were done."""
    done = True
    for said in utterances(text):
        with spinner(said):
            reply = agent.hear(said, speaker=speaker, only=only, heard=heard, alternatives=others)
        done = done and reply.is_done
        if as_json or text == STDIN:
            certainty = {"heard": round(reply.heard, 6)} if others else {}
            print_json(getattr(reply, f"as_{only}_json")() | certainty)
        elif reply.ending == "not_understood":
            report_error(reply.said)
        else:
            out, console = terminal(), presentation.console
            out.print(console.turn(reply))
            if reply.result and reply.result.steps:
                out.print(console.goal_result(reply.result, agent.quote))
            if reply.ending == "refused" and agent.base.trust(reply.speaker) is None:
                what_to_do = f"Run: hilt trust {shlex.quote(reply.speaker)} DEGREE"
                typer.echo(f"Nobody has said how far to trust them. {what_to_do}", err=True)
    exit_with(done)


def utterances(text: str) -> Iterator[str]:
    """Return the text itself, or for "-" the non-empty lines of stdin."""
    if text == STDIN:
        return filter(None, map(str.strip, stdin_lines()))
    return iter([text])


def stdin_lines() -> Iterator[str]:
    """Yield the lines of stdin without their ends; DataError for what is not UTF-8."""
    for number, line in enumerate(sys.stdin.buffer, start=1):
        try:
            text = line.decode("utf-8-sig" if number == 1 else "utf-8")
        except UnicodeDecodeError as error:
            raise DataError("expected UTF-8 text.", source="<stdin>", line=number) from error
        yield text.rstrip("\r\n")


def read_alternatives(given: str | None, text: str) -> list[tuple[str, float]]:
    """Return the texts that may have been said, with their scores in [0, 1], from JSON.

    It is given itself, as @FILE, or as "-" for stdin. DataError where it is wrong.
    """
    if given is None:
        return []
    if text == STDIN:
        raise typer.BadParameter("--alternatives goes with one utterance, not with stdin.")
    source, document = "--alternatives", given
    if given == STDIN:
        source, document = "<stdin>", "\n".join(stdin_lines())
    elif given.startswith("@"):
        source, document = given[1:], read_text(Path(given[1:]))
    try:
        values = json.loads(document)
    except json.JSONDecodeError as error:
        problem, line, column = f"is not JSON: {error.msg}.", error.lineno, error.colno
        raise DataError(problem, source=source, line=line, column=column) from error
    found = parse_yaml(document, source=source)  # for the place of what is wrong
    if not found.items():
        raise found.fail("expected at least one text with its score.")
    return list(map(_alternative, values, found.items()))


def _alternative(value: object, node: YamlNode) -> tuple[str, float]:
    match value:
        case [str(text), score] | {"text": str(text), "score": score} if (
            isinstance(score, int | float) and not isinstance(score, bool) and 0 <= score <= 1
        ):
            return text, float(score)
        case _:
            wanted = '[TEXT, SCORE] or {"text": TEXT, "score": SCORE}, a score in [0, 1]'
            raise node.fail(f"expected {wanted}.")


def read_sparql(text_or_file: str) -> str:
    """Return the content of a SPARQL file, that of stdin for "-", or the text itself."""
    if text_or_file == STDIN:
        return "\n".join(stdin_lines())
    looks_like_file = "\n" not in text_or_file and "{" not in text_or_file
    if looks_like_file and Path(text_or_file).suffix in {".rq", ".ru", ".sparql"}:
        return read_text(Path(text_or_file))
    return text_or_file


def print_json(document: object, *, err: bool = False) -> None:
    """Print one JSON document on a line of its own."""
    typer.echo(json.dumps(document, ensure_ascii=False), err=err)
    sys.stdout.flush()


def show(
    found: Any, render: "Callable[[Any], RenderableType]", *, as_json: bool, soft_wrap: bool = False
) -> None:
    """Print a result, or a list of results, as JSON or as it is rendered for people."""
    if not as_json:
        terminal().print(render(found), soft_wrap=soft_wrap)
    elif isinstance(found, Sequence):
        print_json([each.as_json() for each in cast("Sequence[Any]", found)])
    else:
        print_json(found.as_json())


def show_import(found: "ImportSummary", source: str, *, dry_run: bool, as_json: bool) -> None:
    """Print what was read from a file or another base."""
    if as_json:
        print_json({"applied": not dry_run, **found.as_json()})
        return
    text = presentation.console.import_summary(found, source, dry_run=dry_run)
    terminal(stderr=True).print(text, soft_wrap=True)


def announce(document: object, text: str, *, as_json: bool, err: bool = False) -> None:
    """Print what was done, as JSON or in words."""
    print_json(document) if as_json else typer.echo(text, err=err)


def write_svg(path: Path, svg: str) -> None:
    """Write a picture to a file; DataError if its name does not end in .svg, or it cannot be."""
    if path.suffix.lower() != ".svg":
        raise DataError("expected a file ending in .svg.", source=str(path))
    write_bytes(path, svg.encode())


def write_bytes(path: Path | str, content: bytes) -> None:
    """Write a file; "-" is standard output; DataError if it cannot be written."""
    from ...kb.formats.file_streams import open_output

    with open_output(str(path)) as stream:
        stream.write(content)


def exit_with(done: bool) -> None:
    """Exit with code 1 unless the command succeeded."""
    if not done:
        raise typer.Exit(FAILED)


def report_error(error: HiltError | str, *, as_json: bool = False) -> None:
    """Print a line on stderr for each mistake; on a terminal also the text, with a caret."""
    several = (isinstance(error, DataError) and error.mistakes) or (error,)
    if isinstance(error, ValidationError):
        several = error.findings
    if as_json:
        print_json({"errors": [_as_json(one) for one in several]}, err=True)
        return
    for one in several[:MOST_MISTAKES]:
        typer.echo(f"hilt: {printable(str(one))}", err=True)
        if isinstance(one, DataError) and one.text and sys.stderr.isatty():
            typer.echo(one.excerpt(), err=True)
    if len(several) > MOST_MISTAKES:
        typer.echo(f"hilt: ... and {len(several) - MOST_MISTAKES} more.", err=True)


def _as_json(error: HiltError | str) -> dict[str, object]:
    kind = "Error" if isinstance(error, str) else type(error).__name__
    places = ("source", "line", "column") if isinstance(error, DataError) else ()
    return {"type": kind, "message": str(error), **{name: getattr(error, name) for name in places}}
