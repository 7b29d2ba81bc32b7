"""Episodes: commands and their results, as they are kept in the graph, with what runs them again.

The document of an episode is that of `hilt do --json`, and has under "again" what is needed to run
it again: the request, the circumstances, and the episode before it, whose changes to the scene it
starts from. There a value is an object of its fields. Atoms are texts, an interval is the list of
its bounds, a conclusion that of its functor and argument; sets are sorted.
"""

import json
from collections.abc import Collection, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

from ..inference.settings import CONTRADICTION, OPERATORS, THRESHOLD, Settings
from ..inference.types import Conclusion
from ..kb.episodes import Episode, EpisodeStep
from ..kb.interval import Interval
from ..kb.rule import Atom
from ..ontology.errors import DataError
from ..sim.scene.scene import Scene
from .config import household
from .dialogue.reply import Reply
from .execution.embodiment import ROBOT_OPTIONS, Embodiment
from .execution.outcome import Json, WalkStep

AGAIN = "again"  # key of the document


def episode_from_reply(reply: Reply, again: Json | None = None, robot: str = "") -> Episode:
    """Return the episode of a command: its steps and grasps, and the whole document as JSON."""
    result, decision, best = reply.result, reply.decision, reply.chosen
    world = result.world if result and result.world.executed else None
    document = reply.as_do_json() | {AGAIN: again}
    return Episode(
        goal=reply.understanding.content,
        text=reply.text,
        speaker=reply.speaker,
        outcome=reply.ending,
        said=reply.said,
        seed=reply.seed,
        document=json.dumps(document, ensure_ascii=False, sort_keys=True),
        object=best.object if best else None,
        part=decision.chosen_part if decision else None,
        rules=tuple(rule.id for rule in decision.rules) if decision else (),
        steps=tuple(_step_of(step) for step in result.steps) if result else (),
        trials=tuple(replace(each, robot=robot) for each in result.trials) if result else (),
        touched=tuple(sorted(world.touched)) if world else (),
        lifted_m=world.lifted_m if world else None,
        handed_over=world.handed_over if world else None,
    )


def _step_of(step: WalkStep) -> EpisodeStep:
    bound = step.constraint
    return EpisodeStep(
        path=step.node,
        features=tuple(Atom.parse(feature) for feature in step.features),
        object=bound.object if bound else None,
        part=bound.part if bound else None,
        interval=bound.interval if bound else None,
        rules=tuple(rule.id for rule in bound.rules) if bound else (),
    )


def as_json(value: object) -> Any:
    """Return the JSON form of a request, a scene, or anything that they consist of."""
    match value:
        case None | str() | int() | float():
            return value
        case Atom():
            return str(value)
        case Interval() | Conclusion():
            return [as_json(getattr(value, each.name)) for each in fields(value)]
        case Mapping():
            return {str(key): as_json(each) for key, each in value.items()}
        case Collection():
            found = [as_json(each) for each in value]
            return sorted(found) if isinstance(value, frozenset) else found
        case _:
            return {name: as_json(getattr(value, name)) for name in _types(type(value))}


def from_json(kind: Any, kept: Any) -> Any:
    """Return the value of a type that `as_json` wrote; a field that is missing has its default."""
    wanted, inner = get_origin(kind), get_args(kind)
    if kind is Atom:
        return Atom.parse(kept)
    if isinstance(kind, type) and is_dataclass(kind):
        types = _types(kind)
        given = kept if isinstance(kept, dict) else dict(zip(types, kept, strict=False))
        return kind(**{name: from_json(types[name], each) for name, each in given.items()})
    if wanted is Mapping:
        return {from_json(inner[0], key): from_json(inner[1], kept[key]) for key in kept}
    if wanted in {tuple, frozenset}:
        of_each = inner if inner[-1] is not ... and wanted is tuple else (inner[0],) * len(kept)
        return wanted(map(from_json, of_each, kept))
    structured = [each for each in inner if is_dataclass(each) or get_origin(each)]
    is_plain = kept is None or (isinstance(kept, str) and Atom not in inner)
    return kept if is_plain or not structured else from_json(structured[0], kept)


@cache
def _types(kind: type) -> Mapping[str, Any]:
    hints = get_type_hints(kind)
    return {each.name: hints[each.name] for each in fields(kind)}


def embodiment_as_json(embodiment: Embodiment) -> Json:
    """Return all that is needed to make the same embodiment again, but for the window."""
    return {
        "scene": as_json(embodiment.scene),
        "objects": file_as_json(embodiment.objects_file),
        **{name: getattr(embodiment, name) for name in ROBOT_OPTIONS},
    }


def embodiment_from_json(kept: Mapping[str, Any], *, gui: bool = False) -> Embodiment:
    """Return the embodiment that was kept.

    DataError if the user's file of objects is gone or changed; UnknownNameError without the robot.
    """
    file = file_from_json(kept["objects"])
    kept = {"simulate": kept.get("simulated"), **kept}  # its name until version 0.1
    robot = {name: kept[name] for name in ROBOT_OPTIONS}
    return Embodiment(from_json(Scene, kept["scene"]), household(file), file, gui=gui, **robot)


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
    """Return the path that was kept; DataError if the file is gone, or was changed."""
    if kept is None:
        return None
    path = Path(kept["file"])
    if file_as_json(path) != kept:
        raise DataError("has been changed since, or is gone.", source=str(path))
    return path
