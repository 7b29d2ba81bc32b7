"""JSON forms of what an episode keeps to be run again: request, embodiment, settings, files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

from ...inference.settings import CONTRADICTION, OPERATORS, THRESHOLD, Settings
from ...inference.types import Conclusion, Target
from ...kb.interval import Interval
from ...kb.rule import Atom, Rule
from ...ontology.errors import DataError
from ...sim.scene.scene import Placement, Scene
from ..config import household
from ..execution.embodiment import Embodiment
from ..execution.outcome import Json
from ..execution.request import Request


def request_as_json(request: Request) -> Json:
    """Return a request as an episode keeps it."""
    return {
        "action": request.action,
        "arguments": {
            name: _target_as_json(each) if isinstance(each, Target) else each
            for name, each in request.arguments.items()
        },
        "speaker": request.speaker,
        "part": request.part,
        "contexts": {str(a): [held.lower, held.upper] for a, held in request.contexts.items()},
        "assumed": sorted(request.assumed),
        "excluded": sorted(request.excluded),
        "agreed": dict(request.agreed),
        "momentary": [_norm_as_json(norm) for norm in request.momentary],
        "unheeded": sorted(request.unheeded),
    }


def request_from_json(kept: Mapping[str, Any]) -> Request:
    """Return the request that was kept."""
    return Request(
        kept["action"],
        {
            name: _target_from_json(each) if isinstance(each, dict) else each
            for name, each in kept["arguments"].items()
        },
        kept["speaker"],
        kept["part"],
        {Atom.parse(atom): Interval(*held) for atom, held in kept["contexts"].items()},
        frozenset(kept["assumed"]),
        frozenset(kept.get("excluded", ())),  # episodes of older versions have none
        dict(kept.get("agreed", {})),
        tuple(map(_norm_from_json, kept.get("momentary", ()))),
        frozenset(kept.get("unheeded", ())),
    )


def _norm_as_json(norm: Rule) -> Json:
    return {
        "features": sorted(map(str, norm.features)),
        "contexts": sorted(map(str, norm.contexts)),
        "functor": norm.functor,
        "argument": None if norm.argument is None else str(norm.argument),
        "interval": [norm.interval.lower, norm.interval.upper],
        "speaker": norm.speaker,
    }


def _norm_from_json(kept: Mapping[str, Any]) -> Rule:
    return Rule(
        frozenset(map(Atom.parse, kept["features"])),
        frozenset(map(Atom.parse, kept["contexts"])),
        kept["functor"],
        Atom.parse(kept["argument"]) if kept["argument"] else None,
        Interval(*kept["interval"]),
        kept["speaker"],
    )


def _target_as_json(target: Target) -> Json:
    affords = target.affords
    return {
        "object": target.object,
        "used_for": target.used_for,
        "not_used_for": target.not_used_for,
        "affords": affords
        and [affords.functor, None if affords.argument is None else str(affords.argument)],
        "properties": sorted(target.properties),
        "is_confirmed": target.is_confirmed,
        "material": target.material,
    }


def _target_from_json(kept: dict[str, Any]) -> Target:
    affords = None
    if kept["affords"]:
        functor, argument = kept["affords"]
        affords = Conclusion(functor, Atom.parse(argument) if argument else None)
    return Target(
        kept["object"],
        kept["used_for"],
        kept["not_used_for"],
        affords,
        frozenset(kept["properties"]),
        kept["is_confirmed"],
        kept.get("material"),  # episodes of older versions have none
    )


def embodiment_as_json(embodiment: Embodiment) -> Json:
    """Return all that is needed to make the same embodiment again, but for the window."""
    scene = embodiment.scene
    return {
        "scene": {
            "placements": [asdict(placement) for placement in scene.placements],
            "seed": scene.seed,
            "gap": scene.gap,
        },
        "objects": file_as_json(embodiment.objects_file),
        "robot": embodiment.robot,
        "vision": embodiment.vision,
        "noise": embodiment.noise,
        "simulate": embodiment.simulate,
    }


def embodiment_from_json(kept: Mapping[str, Any], *, gui: bool = False) -> Embodiment:
    """Return the embodiment that was kept.

    Raises:
        DataError: the user's own file of objects is gone, or was changed.
        UnknownNameError: the robot is gone.
    """
    objects = file_from_json(kept["objects"])
    scene = kept["scene"]
    return Embodiment(
        Scene(tuple(map(_placement, scene["placements"])), scene["seed"], scene["gap"]),
        household(objects),
        objects,
        kept["robot"],
        kept["vision"],
        kept["noise"],
        kept["simulate"] if "simulate" in kept else kept["simulated"],  # until version 0.1
        gui,
    )


def _placement(kept: dict[str, Any]) -> Placement:
    placement = Placement(**kept)
    return replace(placement, at=(kept["at"][0], kept["at"][1])) if kept["at"] else placement


def settings_as_choices(settings: Settings) -> list[str]:
    """Return settings as choices for `Settings.with_choices`: "fusion=dempster", ..."""
    chosen = {name: getattr(settings.operators, name) for name in OPERATORS}
    chosen |= {"stage": settings.stage, "detection": settings.detection}
    chosen |= {THRESHOLD: settings.threshold, CONTRADICTION: settings.contradiction}
    chosen |= {f"{THRESHOLD}.{name}": each for name, each in settings.thresholds.items()}
    return [f"{name}={value}" for name, value in chosen.items()]


def file_as_json(path: Path | None) -> dict[str, str] | None:
    """Return the path of a file and a hash of its content, as an episode keeps them."""
    if path is None:
        return None
    content = path.read_bytes() if path.exists() else b""
    return {"file": str(path.resolve()), "sha256": sha256(content).hexdigest()}


def file_from_json(kept: Mapping[str, str] | None) -> Path | None:
    """Return the path that was kept.

    Raises:
        DataError: the file is gone, or was changed.
    """
    if kept is None:
        return None
    path = Path(kept["file"])
    if file_as_json(path) != kept:
        raise DataError("has been changed since, or is gone.", source=str(path))
    return path
