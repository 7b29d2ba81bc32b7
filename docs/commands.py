"""The page that lists every command, made from the commands themselves.

    python docs/commands.py > docs/commands.md

A test sees to it that the page is fresh.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import typer

from hilt.agent.cli import app

HEAD = """# Commands

Made by `make docs` from the commands themselves. An option means the same wherever it occurs.
`--kb`, `--scene`, `--seed`, `--speaker` and `--json` may also stand before the command, and
`--debug` and `--verbose` anywhere. Exit codes: 0 done, 1 what was asked for failed, 2 wrong usage
or unreadable input.
"""


def reference() -> str:
    """The page as Markdown."""
    return "\n".join([HEAD, *_sections(typer.main.get_command(app), "hilt")]).rstrip() + "\n"


def _sections(command: Any, path: str) -> Iterator[str]:
    for name, each in getattr(command, "commands", {}).items():
        full = f"{path} {name}"
        if each.epilog:
            yield from _section(each, full)
        yield from _sections(each, full)


def _section(command: Any, path: str) -> Iterator[str]:
    shown = [p for p in command.params if p.name != "help" and not getattr(p, "hidden", False)]
    arguments = [p for p in shown if p.param_type_name == "argument"]
    names = " ".join(
        f"{p.name.upper()}" if p.required else f"[{p.name.upper()}]" for p in arguments
    )
    yield f"## {path} {names}".rstrip() + "\n"
    yield f"{' '.join((command.help or '').split())}\n"
    yield f"    {command.epilog.partition(' ')[2]}\n"
    rows = [(_flag(p), " ".join((p.help or "").split())) for p in shown]
    if rows:
        yield "| | |\n|---|---|"
        yield from (f"| `{flag}` | {text} |" for flag, text in rows)
        yield ""


def _flag(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return parameter.name.upper()
    value = (parameter.metavar or parameter.name.upper().rstrip("_")).replace("|", r"\|")
    takes = "" if parameter.is_flag else f" {value}"
    names = "/".join((*parameter.opts[:1], *parameter.secondary_opts))
    return f"{names}{takes}"


if __name__ == "__main__":
    sys.stdout.write(reference())
