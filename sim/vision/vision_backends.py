"""The detectors that `--vision mask|learned` chooses from.

`mask` uses the simulator's segmentation mask, as a perfect detector; `learned` uses only colours
and depths.
"""

from __future__ import annotations

from pathlib import Path

from ...ontology.errors import UnknownNameError
from ...ontology.plugins import plugin_names
from ..scene.world import World
from .learned_detector import LearnedDetector, Recogniser
from .mask_detector import MaskDetector
from .object_detector import ObjectDetector
from .perception_noise import NoiseLevels

SOURCES = ("mask", "learned")


def open_vision(
    world: World, *, source: str = "mask", noise: NoiseLevels | None = None
) -> ObjectDetector:
    """Open the detector that `--vision` names: "mask", "learned" or "learned:FILE".

    The file is one of classifiers of one's own, a `DataError` when it cannot be read. Both
    detectors use the same cameras with the same depth noise.
    """
    check_source(source)
    kind, _, file = source.partition(":")
    if kind == "mask":
        return MaskDetector(world, noise=noise)
    recogniser = Recogniser.load(Path(file)) if file else None
    return LearnedDetector(world, recogniser=recogniser, noise=noise)


def check_source(source: str) -> None:
    """Check the name of a source of percepts before anything is made, by `UnknownNameError`."""
    kind, _, file = source.partition(":")
    if kind not in SOURCES or (file and kind != "learned"):
        known = (*SOURCES, "learned:FILE", *plugin_names("hilt.vision"))
        raise UnknownNameError("source of vision", source, known)
