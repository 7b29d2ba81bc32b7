"""The command line: `hilt COMMAND`.

Every command that prints a result takes `--json`: one document on stdout and nothing else there.
Exit codes: 0 done, 1 what was asked for failed, 2 wrong usage or unreadable input. Errors are one
line on stderr; `--debug` adds the traceback, `--verbose` the log. What a command needs is imported
when it runs, so that `hilt --help` answers at once.
"""

import atexit
import gc
import sys
import traceback
from collections.abc import Generator, Sequence
from contextlib import contextmanager, nullcontext
from io import BytesIO, TextIOWrapper
from typing import Any

import typer

from ...ontology import errors

# Each module adds its commands to `app`; help lists them in this order.
# pyright: reportUnusedImport=false
from . import conversation, language, rules, files, history  # isort: skip  # noqa: F401
from . import reasoning, scene, configuration, evaluate, serve  # isort: skip  # noqa: F401
from .common import FAILED, report_error
from .options import app

WRONG_USAGE, INTERRUPTED = 2, 130
MAY_LEAD = {"--kb": 1, "--scene": 1, "--seed": 1, "--speaker": 1, "--json": 0}  # option: values
ANYWHERE = ("--debug", "--verbose")
UNREADABLE = (errors.DataError, errors.IntervalError, errors.QueryError, errors.UnknownNameError)
# What was asked for in the right way, and not got.
MISSED = (errors.NotFoundError, errors.QueryLimitError)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command and exit with its code; the entry point of `hilt`."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    if sys.stdin is None:  # pyright: ignore[reportUnnecessaryComparison] - it may be closed
        sys.stdin = TextIOWrapper(BytesIO())
    if isinstance(sys.stdout, TextIOWrapper):  # what it cannot show is spelt out, as on stderr
        sys.stdout.reconfigure(errors="backslashreplace")
    gc.set_threshold(50_000)  # new objects: what a command makes at its start all stays in use
    atexit.register(gc.freeze)  # else the interpreter looks for cycles in all of it when it ends
    words = [word for word in given if word not in ANYWHERE]
    command = typer.main.get_command(app)
    group = _command(command, words)
    is_group = hasattr(group, "commands") and not group.invoke_without_command
    with _logged() if "--verbose" in given else nullcontext():
        words = [*words, "--help"] if is_group else words
        code = _run(command, words, debug="--debug" in given)
    sys.exit(WRONG_USAGE if is_group else code)


def _command(found: Any, words: Sequence[str]) -> Any:
    for word in words:
        found = getattr(found, "commands", {}).get(word)
    return found


@contextmanager
def _logged() -> Generator[None]:
    import logging

    handler, logger = logging.StreamHandler(), logging.getLogger("hilt")
    handler.setFormatter(logging.Formatter("%(relativeCreated)6.0f ms  %(name)s: %(message)s"))
    logger.addHandler(handler)
    logger.setLevel(logging.DEBUG)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(logging.NOTSET)


def _run(command: Any, arguments: Sequence[str], *, debug: bool) -> int:
    try:
        given = _reordered(command, arguments)
        return command.main(given, prog_name="hilt", standalone_mode=False) or 0
    except typer.Abort:
        return INTERRUPTED
    except Exception as error:
        is_expected = isinstance(error, errors.HiltError | OSError)
        if not is_expected and not hasattr(error, "format_message"):
            raise  # no mistake of who typed this
        if debug:
            traceback.print_exc()
        told, code = _told(error)
        report_error(told, as_json="--json" in arguments)
        return code


def _told(error: Any) -> tuple[errors.HiltError | str, int]:
    if isinstance(error, errors.HiltError):
        is_wrong = isinstance(error, UNREADABLE) and not isinstance(error, MISSED)
        return error, WRONG_USAGE if is_wrong else FAILED
    if isinstance(error, OSError):
        what = f"{error.filename}: cannot be read or" if error.filename else "The output cannot be"
        return f"{what} written: {error.strerror or error}.", FAILED
    message: str = error.format_message().rstrip(".")
    context = getattr(error, "ctx", None)
    path = context.command_path if context else "hilt"
    return f"{message}{'' if message.endswith('?') else '.'} Run: {path} --help", WRONG_USAGE


def _reordered(command: Any, arguments: Sequence[str]) -> list[str]:
    words, options, rest = [], [], [*arguments]
    while rest:
        name, _, value = rest[0].partition("=")
        if name in MAY_LEAD:
            count = 1 if value else 1 + MAY_LEAD[name]
            options, rest = [*options, *rest[:count]], rest[count:]
        elif _command(command, [*words, name]):
            words.append(rest.pop(0))
        else:
            break
    return [*words, *options, *rest] if words else rest
