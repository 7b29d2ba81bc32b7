"""Percepts as evidence for inference, and perfect vision for decisions without a simulator."""

from collections.abc import Sequence

from ...inference.types import Observation
from ...kb.interval import Interval
from ...kb.rule import Atom
from ...ontology.objects import ObjectTypes
from ...sim.scene.scene import Scene
from ...sim.vision.percept import UNMEASURED, Percept


def percept_as_observation(
    percept: Percept, features: Sequence[Atom], *, point: bool = False
) -> Observation:
    """Return a percept as evidence: an interval for each feature that was looked for.

    An object detected with confidence d has each feature it shows with [d, 1]: uncertainty is not
    evidence against (theory of the paper; with rules [p, 1] only the lower bound matters). A
    property it does not show is denied with [0, 1 - d]; other missing features are left out.
    With `point` the probability is [d, d] instead.
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
    shown = {"object": {percept.object}, "part": percept.parts, "property": percept.properties}
    return feature.name in shown.get(feature.kind, ())


class PerfectVision:
    """Vision that reports everything in a scene with certainty (paper, section 4.1)."""

    def __init__(self, scene: Scene, objects: ObjectTypes) -> None:
        self._percepts: list[Percept] = []
        for each in scene.placements:
            kind = objects[each.object]
            parts, props = dict.fromkeys(kind.parts, UNMEASURED), kind.properties
            self._percepts.append(Percept(each.name, each.object, 1.0, parts, props))

    def search(self, features: Sequence[str]) -> Sequence[Percept]:
        """Return the objects of the scene that show one of the features."""
        atoms = [Atom.parse(feature) for feature in features]
        return [p for p in self._percepts if any(_shows(p, atom) for atom in atoms)]
