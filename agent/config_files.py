"""What options are when a command is not given them.

A value comes from the environment, else from the file `hilt.toml` of the project (in the working
folder or the nearest one above it), else from that in the user's configuration folder, else it is
the default. The keys are the names of the options of `AgentConfig`, `base` and `speaker`; each has
an environment variable, as HILT_ROBOT.
"""

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from ..ontology.yaml_reader import YamlNode
from .config import OPTIONS, ConfigOption, read_nodes, read_value

FILE = "hilt.toml"
_VARIABLES = {"base": "HILT_KB"}  # whose names are others
KEYS: Mapping[str, ConfigOption] = {
    "speaker": ConfigOption(str, "sam", "Who is speaking.", name="speaker"),
    "base": ConfigOption(str, None, "The knowledge base.", name="base"),
    **OPTIONS,
}


class Configured(NamedTuple):
    """The value of an option, and where it comes from."""

    value: Any
    origin: str = "default"  #: "environment", "project", "user" or "default"
    place: str = ""  #: the variable, or the file and line; empty for a default


def configured() -> dict[str, Configured]:
    """Return the value of each key; DataError, with its place, if one is wrong."""
    found = {name: Configured(option.default) for name, option in KEYS.items()}
    for origin, path in (("user", user_file()), ("project", project_file())):
        nodes = read_nodes(path, KEYS) if path and path.is_file() else {}
        for name, node in nodes.items():
            value = read_value(node, KEYS[name], Path(node.source).parent)
            found[name] = Configured(value, origin, f"{node.source}:{node.line}")
    for name, option in KEYS.items():
        if text := os.environ.get(variable(name)):
            value = read_value(parse_value(option, text, variable(name)), option, Path())
            found[name] = Configured(value, "environment", variable(name))
    return found


def lasting_values() -> dict[str, Any]:
    """Return the values of options of `AgentConfig` that are not their defaults."""
    found = configured()
    return {name: found[name].value for name in OPTIONS if found[name].origin != "default"}


def variable(key: str) -> str:
    """Return the environment variable of a key."""
    return _VARIABLES.get(key, f"HILT_{key.upper()}")


def user_file() -> Path:
    """Return the path of the user's own file, which need not exist."""
    from platformdirs import user_config_path

    return user_config_path("hilt", appauthor=False) / FILE


def project_file() -> Path | None:
    """Return the file of the project; None when there is none."""
    here = Path.cwd()
    files = (folder / FILE for folder in (here, *here.parents))
    return None if (found := next(filter(Path.is_file, files), None)) == user_file() else found


def parse_value(option: ConfigOption, text: str, source: str) -> YamlNode:
    """Return what a text stands for as a value of an option, which is still to be checked."""
    node = YamlNode(text, source, 0, 0)
    if option.kind is bool:
        return replace(node, value={"true": True, "false": False}.get(text.lower(), text))
    if option.kind is int and text.isdecimal():
        return replace(node, value=int(text))
    if option.kind is tuple:
        texts = filter(None, map(str.strip, text.split(",")))
        return replace(node, value=tuple(replace(node, value=each) for each in texts))
    return node
