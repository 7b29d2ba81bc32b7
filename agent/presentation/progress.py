"""What the robot does at a step, in words, for who watches it: "grasping the knife by the blade".

The file of a picture or film is shown by the viewer of the desktop, where there is one.
"""

import os
import sys
import webbrowser
from collections.abc import Mapping
from pathlib import Path

from ...inference.node_rules import FIND
from ..execution.outcome import WalkStep

_DOING: Mapping[str, str] = {  # primitive -> what is done
    "graspObject": "grasping the {}",
    "moveTo": "lifting the {}",
    "handOver": "handing over the {}",
    "pointAt": "pointing at the {}",
    "moveAbove": "moving the {} above it",
    "raise": "raising the {}",
    "lower": "striking with the {}",
    "placeObject": "putting down the {}",
    "returnObject": "putting back the {}",
    "letGo": "letting go of the {}",
}
_ALWAYS = ("darwin", "win32")  # where there is a desktop
_DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")


def doing(step: WalkStep, found: str) -> str:
    """Return what is done at a step with the object that was found; empty for a step of steps."""
    action, constraint = step.node.rpartition("/")[2], step.constraint
    if action == FIND:
        first = next(iter(step.inference.candidates), None)
        if first and first.argument and first.argument.kind == "affordance":
            return f"looking for something used for {first.argument.name}"
        return f"looking for {f'the {first.object}' if first else 'it'}"
    if action not in _DOING:
        return ""
    part = f" by the {constraint.part}" if constraint and constraint.part else ""
    return _DOING[action].format(found or "object") + part


def view(path: Path) -> None:
    """Open a file in the viewer of the desktop; nothing happens where there is none."""
    if sys.platform in _ALWAYS or any(map(os.environ.get, _DISPLAYS)):
        webbrowser.open(path.absolute().as_uri())
