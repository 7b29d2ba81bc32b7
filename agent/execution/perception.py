# SPDX-License-Identifier: Apache-2.0
"""From what vision reports to what inference takes; and perfect vision, to decide bodiless."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...inference.types import Observation
from ...kb.interval import Interval
from ...kb.rule import Atom
from ...ontology.objects import ObjectType
from ...sim.scene.scene import Scene
from ...sim.vision.percept import PartPercept, Percept


def percept_as_observation(
    percept: Percept, features: Sequence[Atom], *, point: bool = False
) -> Observation:
    """A percept as evidence: an interval for each feature that was looked for.

    A thing detected with confidence d has each feature it shows with [d, 1]: what is left open is
    not evidence against (theory of the paper; with rules [p, 1] only the lower bound matters). A
    property it does not show is denied with [0, 1 - d]; other features it does not show stay out.

    Args:
        percept: what was seen.
        features: what was looked for.
        point: take d for a probability, [d, d], instead.
    """
    sure = percept.confidence
    atoms: dict[Atom, Interval] = {}
    for feature in features:
        if _shows(percept, feature):
            atoms[feature] = Interval(sure, sure if point else 1.0)
        elif feature.kind == "property":
            atoms[feature] = Interval(1.0 - sure if point else 0.0, 1.0 - sure)
    return Observation(percept.name, percept.object, atoms)


def _shows(percept: Percept, feature: Atom) -> bool:
    shown = {
        "object": (percept.object,),
        "part": tuple(percept.parts),
        "property": percept.properties,
    }
    return feature.name in shown.get(feature.kind, ())


def _unseen(part: str) -> PartPercept:
    """A part that is known to be there, without a point of its surface."""
    return PartPercept(part, np.zeros((0, 3)), 0)


class PerfectVision:
    """Sees everything in a scene with certainty: for decisions without noise (section 4.1)."""

    def __init__(self, scene: Scene, objects: Mapping[str, ObjectType]) -> None:
        self._percepts = tuple(
            Percept(
                name=placement.name,
                object=placement.object,
                confidence=1.0,
                parts={name: _unseen(name) for name in objects[placement.object].parts},
                properties=objects[placement.object].properties,
            )
            for placement in scene.placements
        )

    def search(self, features: Sequence[str]) -> Sequence[Percept]:
        """The things of the scene that show one of the features."""
        atoms = [Atom.parse(feature) for feature in features]
        return [p for p in self._percepts if any(_shows(p, atom) for atom in atoms)]
