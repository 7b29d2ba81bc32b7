"""Plug-ins: what other distributions add to Hilt, found by their entry points.

An entry point `mine` of the group `hilt.vision` is what `--vision mine` names: a callable, which
gets what is known and returns a vision. Installed distributions are looked through only for a
name that is not one of Hilt's own, as that takes a while.
"""

from collections.abc import Sequence
from typing import Any

from .errors import HiltError, PluginError, UnknownNameError


def plugin_names(group: str) -> tuple[str, ...]:
    """Return the names of all plug-ins of a group, sorted."""
    from importlib.metadata import entry_points

    return tuple(sorted({each.name for each in entry_points(group=group)}))


def call_plugin(
    group: str, name: str, *arguments: object, methods: Sequence[str] = (), **options: object
) -> Any:
    """Load a plug-in and call it; return what it makes, which must have these methods.

    UnknownNameError if there is none of that name; PluginError if it cannot be loaded, fails, or
    makes something else; errors of Hilt that it raises are passed on.
    """
    from importlib.metadata import entry_points

    if (found := next(iter(entry_points(group=group, name=name)), None)) is None:
        raise UnknownNameError(f"plug-in of {group}", name, plugin_names(group))
    source = f"{found.dist.name} {found.dist.version}" if found.dist else found.value
    try:
        made = found.load()(*arguments, **options)
    except HiltError:
        raise
    except Exception as error:
        problem = f"{type(error).__name__}: {error}".splitlines()[0]
        raise PluginError(group, name, source, problem) from error
    if missing := ", ".join(each for each in methods if not hasattr(made, each)):
        problem = f"it makes a {type(made).__name__}, which lacks {missing}"
        raise PluginError(group, name, source, problem)
    return made
