# SPDX-License-Identifier: Apache-2.0
"""The command line: `hilt COMMAND`.

Every command that prints a result takes `--json`: one document on stdout and nothing else there.
Exit codes: 0 done, 1 what was asked for failed, 2 wrong usage or unreadable input. Errors are one
line on stderr; `--debug` adds the traceback. What a command needs is imported when it runs, so that
`hilt --help` answers at once.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import typer

from ...ontology.errors import (
    DataError,
    HiltError,
    IntervalError,
    NotFoundError,
    QueryError,
    UnknownNameError,
)

# The order in which help lists them.
from . import talking, parsing, knowledge, exchanging, history, picturing, checking  # isort: skip
from . import querying, safety, reasoning, seeing, episodes, measuring  # isort: skip
from .options import app
from .terminal import FAILED, complain

WRONG_USAGE, INTERRUPTED = 2, 130
MAY_LEAD = {"--kb": 1, "--scene": 1, "--seed": 1, "--speaker": 1, "--json": 0}  # option: values
UNREADABLE = (DataError, IntervalError, QueryError, UnknownNameError)
COMMANDS = (
    talking,
    parsing,
    knowledge,
    exchanging,
    history,
    picturing,
    checking,
    querying,
    safety,
    reasoning,
    seeing,
    episodes,
    measuring,
)  # imported for what they add to `app`


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
        complain(error)
        is_wrong = isinstance(error, UNREADABLE) and not isinstance(error, NotFoundError)
        return WRONG_USAGE if is_wrong else FAILED
    except typer.Abort:
        return INTERRUPTED
    except Exception as error:
        if debug or not hasattr(error, "format_message"):
            raise
        message: str = error.format_message()  # pyright: ignore[reportAttributeAccessIssue]
        if arguments:
            complain(f"{message.rstrip('.')}. Run: hilt --help")
        else:
            typer.echo(message)
        return WRONG_USAGE


def _reordered(arguments: Sequence[str]) -> list[str]:
    """Options that lead the command moved behind it, where they are declared."""
    at = 0
    while at < len(arguments) and arguments[at].split("=")[0] in MAY_LEAD:
        name, _, value = arguments[at].partition("=")
        at += 1 if value else 1 + MAY_LEAD[name]
    return [*arguments[at : at + 1], *arguments[:at], *arguments[at + 1 :]]
