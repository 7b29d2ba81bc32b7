"""Plug-ins for Hilt: a camera and an arm without a simulator, a robot, and a store.

`hilt_workshop.speech` has a recogniser and a voice.

Its `pyproject.toml` names each in a group of entry points. Replace the bodies of the methods by
calls into your own system.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from hilt.agent.execution.embodiment import Embodiment
from hilt.kb.stores import Store, open_store
from hilt.ontology.errors import StoreError
from hilt.sim.manipulation.motion_report import MotionReport
from hilt.sim.vision.percept import Percept


class Camera:
    """Your detector; it sees what the scene names, and is 0.9 sure of it."""

    def __init__(self, embodiment: Embodiment) -> None:
        self._kinds = {each.name: each.object for each in embodiment.scene.placements}

    def search(self, features: Sequence[str]) -> list[Percept]:
        """Return the objects that show one of the features: "object:knife"."""
        return [
            Percept(name, kind, 0.9, parts={})
            for name, kind in self._kinds.items()
            if f"object:{kind}" in features
        ]


class Arm:
    """Your motion stack; it says on stderr what it does."""

    abilities = frozenset({"graspObject", "moveTo", "handOver"})

    def __init__(self, embodiment: Embodiment) -> None:
        self._label = embodiment.robot

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Close the hand on a part, and report what was touched."""
        print(f"{self._label}: grasp {percept.name} by the {part}", file=sys.stderr)
        return MotionReport("grasp", ok=True, touched=(part,) if part else ())

    def lift(self) -> MotionReport:
        """Raise what is held, and hold it."""
        return MotionReport("lift", ok=True, lifted_m=0.2, held_s=1.0)

    def hand_over(self) -> MotionReport:
        """Bring it to the person."""
        return MotionReport("hand_over", ok=True)


def robots() -> Path:
    """Return the file with the robots of this package."""
    return Path(__file__).with_name("robots.yaml")


def open_quads(location: str, *, read_only: bool) -> Store:
    """Open `quads:FILE`: a copy in memory of a file of N-Quads, whose changes are not kept."""
    file, store = Path(location.partition(":")[2]), open_store("memory:")
    try:
        with file.open("rb") as lines:
            store.load(lines)
    except OSError as error:
        raise StoreError(f'"{file}" cannot be read: {error.strerror}.') from error
    return store
