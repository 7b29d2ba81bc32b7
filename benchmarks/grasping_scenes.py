"""Scenes in which grasping is measured: crowds, heaps, and objects of other colours."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from zlib import crc32

import numpy as np

from hilt.ontology.objects import ObjectType
from hilt.sim import poses
from hilt.sim.poses import Array
from hilt.sim.scene.placement import LIMITS, REACH
from hilt.sim.scene.scene import Scene, graspable, parse_scene, scene_with
from hilt.sim.scene.world import World

HEAP_AREA = ((0.42, 0.58), (-0.2, 0.2))  # [m], x and y of the middle of a heap
SCATTER = 0.02  # [m], standard deviation of where objects are dropped on a heap
DROP = 0.01  # [m] above what lies there already
DROP_STEPS = 60  # from one object of a heap to the next: a quarter of a second
AWAY = 5.0  # [m] above the table, where objects wait for their turn
MAX_HEAPS = 20  # that are tried until one stays in reach


def scene_of(table: str, name: str, *, seed: int, objects: Mapping[str, ObjectType]) -> Scene:
    """Return the scene of an object on a table: alone, eight, twelve (with doubles) or heap."""
    if table == "twelve":
        return parse_scene(f"random:{seed}:12", seed=seed, objects=objects)
    names = (name,) if table == "alone" else graspable(objects)
    return scene_with(names, seed=seed, objects=objects)


def heap(scene: Scene, objects: Mapping[str, ObjectType], *, number: int = 0) -> dict[str, Array]:
    """Return a pose for each object of a scene, dropped in any orientation onto one place.

    Each `number` gives another heap. One of which something rolls out of reach is dropped again;
    `RuntimeError` after many.
    """
    rng = np.random.default_rng([scene.seed, number])
    with World.build(scene, objects) as world:
        for _ in range(MAX_HEAPS):
            _drop(world, rng)
            found = {name: world.pose(name) for name in world.kinds}
            if all(_is_in_reach(world.points(name)) for name in found):
                return found
    raise RuntimeError(f"No heap of seed {scene.seed} stays in reach.")


def _drop(world: World, rng: np.random.Generator) -> None:
    middle = [rng.uniform(*limits) for limits in HEAP_AREA]
    waiting, top = [str(name) for name in rng.permutation(list(world.kinds))], 0.0
    while waiting:
        for number, name in enumerate(waiting):
            world.engine.bodies.place(name, poses.translation(number, 0.0, AWAY))
        name = waiting.pop()
        turn = _random_rotation(rng)
        points = world.models[world.kinds[name].name].points @ turn.T
        x, y = np.array(middle) + rng.normal(0.0, SCATTER, 2)
        centre = (points.min(axis=0) + points.max(axis=0)) / 2
        height = top + DROP - points[:, 2].min()
        world.engine.bodies.place(name, poses.pose(turn, (x - centre[0], y - centre[1], height)))
        world.engine.step(DROP_STEPS)
        dropped = [each for each in world.kinds if each not in waiting]
        top = max(float(world.points(each)[:, 2].max()) for each in dropped)
    world.settle()


def _random_rotation(rng: np.random.Generator) -> Array:
    axes, signs = np.linalg.qr(rng.normal(size=(3, 3)))
    turned = axes * np.sign(np.diag(signs))
    return turned * np.linalg.det(turned)


def _is_in_reach(points: Array) -> bool:
    low, high = np.transpose(LIMITS)
    inside = (points[:, :2] >= low) & (points[:, :2] <= high)
    return bool(inside.all() and np.linalg.norm(points[:, :2], axis=1).max() <= REACH)


def recoloured(kind: ObjectType, *, seed: int) -> ObjectType:
    """Return a type with a random colour of each part, its trim included."""
    rng = np.random.default_rng([seed, crc32(kind.name.encode())])
    parts = {
        name: replace(
            part,
            colour=tuple(rng.random(3).tolist()),
            shape=tuple(replace(solid, colour=None) for solid in part.shape),
        )
        for name, part in kind.parts.items()
    }
    return replace(kind, parts=parts)
