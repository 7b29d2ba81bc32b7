# SPDX-License-Identifier: Apache-2.0
"""Trains the networks of `hilt.sim.recognition` on rendered scenes and keeps them in a file.

    python examples/train_recognition.py [--scenes 260] [--seed 1000000] [--out FILE]

Scene number i has the seed SEED + i. A fifth of the scenes is kept back: on it the temperature is
found and the accuracy printed. The mask of the simulator serves as the teacher here, and here only.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hilt.ontology.errors import SimulationError
from hilt.ontology.objects import load_objects
from hilt.sim.camera import View
from hilt.sim.descriptors import describe
from hilt.sim.familiarity import Familiarity
from hilt.sim.network import fit
from hilt.sim.noise import Noise
from hilt.sim.recognition import NETWORKS_FILE, Recogniser, point_inputs
from hilt.sim.scene import Placement, Scene, graspable, scene_of
from hilt.sim.segmentation import TABLE_MARGIN, Segment, segments
from hilt.sim.vision import Vision
from hilt.sim.world import World

OBJECTS = load_objects()
KINDS = (*graspable(OBJECTS), "block", "nail")
PARTS = tuple((kind, part) for kind in KINDS for part in OBJECTS[kind].parts)
UNUSUAL = 0.3  # how often a thing lies in any way it can, usual or not
NAIL, LOOSE_NAIL = 0.25, 0.15  # how often there is one
POINTS = 80  # of a segment, for the part network
EXAMPLES = 100  # of each kind, to tell what is familiar
NOISY = 0.3  # share of the scenes with some depth noise
Rows = list[tuple[np.ndarray, int, np.ndarray, np.ndarray]]  # thing, kind, points, their parts


def make_scene(seed: int) -> Scene:
    """All objects, some of them in unusual ways, and sometimes a nail."""
    rng = np.random.default_rng(seed)
    placed = [Placement(name, name, rest=_rest(name, rng)) for name in graspable(OBJECTS)]
    if rng.random() < LOOSE_NAIL:
        placed.append(Placement("loose nail", "nail", rest="flat"))
    with_block = scene_of(["nail"], seed=seed, objects=OBJECTS).placements
    return Scene((*placed, *(with_block if rng.random() < NAIL else ())), seed)


def _rest(name: str, rng: np.random.Generator) -> str | None:
    rests = OBJECTS[name].rests
    return rests[int(rng.integers(len(rests)))].name if rng.random() < UNUSUAL else None


def samples(seed: int) -> Rows:
    """What a scene shows to all cameras, to two of them, and to one."""
    rng = np.random.default_rng([seed, 1])
    noise = Noise(depth_m=0.002 * rng.random() if rng.random() < NOISY else 0.0, seed=seed)
    try:
        with World.build(make_scene(seed), OBJECTS) as world:
            views = Vision(world.engine, world.kinds, world.models, noise=noise).look()
            kinds = {name: kind.name for name, kind in world.kinds.items()}
    except SimulationError:  # a table that is too full
        return []
    rows: Rows = []
    for count in (len(views), 2, 1):
        chosen = [views[i] for i in rng.choice(len(views), count, replace=False)]
        for segment in segments(chosen, margin=TABLE_MARGIN + 4 * noise.depth_m):
            rows += _sample(segment, chosen, kinds, rng)
    return rows


def _sample(
    segment: Segment, views: list[View], kinds: dict[str, str], rng: np.random.Generator
) -> Iterator[tuple[np.ndarray, int, np.ndarray, np.ndarray]]:
    """A segment with what the mask says it is; nothing when that is not one of the objects."""
    links = [
        views[view].names.get(int(views[view].labels.flat[pixel]))
        for view, pixel in segment.sources
    ]
    pairs = [(kinds.get(link[0], ""), link[1]) if link else ("", "") for link in links]
    known = np.array([PARTS.index(pair) if pair in PARTS else -1 for pair in pairs])
    if (known < 0).mean() > 0.2:
        return
    owners = np.bincount([KINDS.index(PARTS[i][0]) for i in known if i >= 0], minlength=len(KINDS))
    kind = int(np.argmax(owners))
    chosen = rng.permutation(np.flatnonzero(known >= 0))[:POINTS]
    inputs = point_inputs(segment, kind, len(KINDS))[chosen]
    yield describe(segment), kind, inputs, known[chosen]


def main() -> None:
    """Collect, train, calibrate, keep."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=260)
    parser.add_argument("--seed", type=int, default=1_000_000)
    parser.add_argument("--out", type=Path, default=NETWORKS_FILE)
    given = parser.parse_args()
    print(f"scenes {given.scenes}, seeds {given.seed} to {given.seed + given.scenes - 1}")

    scenes = []
    for i in range(given.scenes):
        scenes.append(samples(given.seed + i))
        if i % 20 == 19:
            print(f"  {i + 1} scenes rendered", flush=True)
    held = given.scenes // 5
    _train(scenes[held:], scenes[:held], np.random.default_rng(given.seed)).save(given.out)
    print(f"{given.out}: {given.out.stat().st_size / 1000:.0f} kB")


def _train(scenes: list[Rows], held: list[Rows], rng: np.random.Generator) -> Recogniser:
    """Both networks and what is usual, calibrated on the scenes that were held back."""
    things, kinds, inputs, parts = _stacked(scenes)
    held_things, held_kinds, held_inputs, held_parts = _stacked(held)
    named = fit(things, kinds, count=len(KINDS), units=48, epochs=60, rng=rng)
    named = named.calibrated(held_things, held_kinds)
    shared = fit(inputs, parts, count=len(PARTS), units=64, epochs=20, rng=rng)
    shared = shared.calibrated(held_inputs, held_parts)
    for what, network, rows, wanted in (
        ("things", named, held_things, held_kinds),
        ("points", shared, held_inputs, held_parts),
    ):
        right = (network.shares(rows).argmax(axis=1) == wanted).mean()
        print(f"{what}: {right:.4f} of {len(rows)} right, temperature {network.temperature:.2f}")
    usual = Familiarity.learned(things, kinds, held_things, held_kinds, count=EXAMPLES)
    return Recogniser(KINDS, PARTS, named, shared, usual)


def _stacked(scenes: list[Rows]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rows = [row for scene in scenes for row in scene]
    return (
        np.array([row[0] for row in rows]),
        np.array([row[1] for row in rows]),
        np.vstack([row[2] for row in rows]),
        np.concatenate([row[3] for row in rows]),
    )


if __name__ == "__main__":
    main()
