"""Measure teaching by showing: things that were shown once are known again, and no other is lost.

    python benchmarks/showing.py [--scenes 60] [--new 20] [--grasps 12] [--seed 0]

Eight kinds of things that the learned eyes do not know lie among four of them that they know. Each
is shown in the first scene. Printed is how many of them are unknown before they were shown, and
known again afterwards in the other scenes; the accuracy for the objects of `random:SEED` scenes
with depth noise, before and after all eight were shown; and how many grasps of a mallet by a part
that was named closed on that part only, and lifted it, as poses and contacts say.
"""

import argparse
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from grasping_truth import GroundTruth

from hilt.ontology.objects import load_objects
from hilt.sim.body import Body
from hilt.sim.scene.scene import parse_scene, unknown_objects
from hilt.sim.scene.world import World
from hilt.sim.vision.learned_detector import SURE, LearnedDetector
from hilt.sim.vision.perception_noise import NoiseLevels
from hilt.sim.vision.shown_kinds import ShownKind

OBJECTS = load_objects()
NEW = Path(__file__).parent / "data" / "new_things.yaml"
MALLET = Path(__file__).parents[1] / "examples" / "unknown_thing.yaml"
NOISES = {"no noise": 0.0, "2 mm of noise": 0.002, "5 mm of noise": 0.005}
NEAR = 0.04  # [m], from the middle of a percept to that of its object


def detected(eyes: LearnedDetector) -> dict[str, tuple[str, bool]]:
    """What each object is seen as, by its name, and whether that is sure."""
    world, found = eyes.world, {}
    for percept in eyes.percepts:
        gaps = {
            name: np.linalg.norm((world.top(name) - percept.centre)[:2]) for name in world.kinds
        }
        name = min(gaps, key=lambda each: gaps[each])
        if gaps[name] < NEAR:
            found[name] = percept.object, percept.confidence >= SURE
    return found


def show_all(folder: Path, seed: int, count: int) -> dict[str, str]:
    """Show the new things in a scene, count how they are seen in others, and return their looks."""
    (folder / "scene.yaml").write_text(
        f"objects: [knife, hammer, mug, spoon]\nunknown: {NEW}\n", encoding="utf-8"
    )
    looks, counts = dict[str, str](), Counter[str]()
    for number in range(seed, seed + count + 1):
        scene = parse_scene(str(folder / "scene.yaml"), seed=number, objects=OBJECTS)
        with World.build(scene, OBJECTS) as world:
            eyes = LearnedDetector(world)
            new = {n: k.name for n, k in world.kinds.items() if k.name in unknown_objects(str(NEW))}
            before = detected(eyes)
            counts["unknown"] += sum(name in before and not before[name][1] for name in new)
            counts["things"] += len(new)
            for name, kind in new.items() if not looks else ():
                middle = world.top(name)[:2]
                thing = min(
                    eyes.unknown, key=lambda p: float(np.linalg.norm(p.centre[:2] - middle))
                )
                looks[kind] = eyes.show(kind, thing).as_json()
            for kind, look in looks.items():
                eyes.recall(kind, look)
            if number > seed:
                after = detected(eyes)
                counts["again"] += sum(after.get(n, ("",))[0] == kind for n, kind in new.items())
                counts["other"] += sum(
                    after[n][0] in looks and after[n][0] != world.kinds[n].name for n in after
                )
    shown = counts["things"] - len(looks)
    print(f"unknown before they were shown: {counts['unknown']} of {counts['things']}")
    print(f"known again: {counts['again']} of {shown}; taken for a shown kind: {counts['other']}")
    return looks


def accuracy(looks: Mapping[str, str], seed: int, count: int, noise: float) -> tuple[int, int, int]:
    """The number of known objects in scenes, and how many are right before and after showing."""
    total = before = after = 0
    for number in range(seed, seed + count):
        scene = parse_scene(f"random:{number}", seed=number, objects=OBJECTS)
        with World.build(scene, OBJECTS) as world:
            eyes = LearnedDetector(world, noise=NoiseLevels(depth_m=noise, seed=number))
            total += len(world.kinds)
            before += right(eyes)
            for kind, look in looks.items():
                eyes.recall(kind, look)
            after += right(eyes)
    return total, before, after


def right(eyes: LearnedDetector) -> int:
    """How many objects are seen as what they are."""
    return sum(eyes.world.kinds[name].name == seen for name, (seen, _) in detected(eyes).items())


def grasp(seed: int, part: str, shape: str) -> tuple[bool, bool, bool]:
    """Show a mallet, name a part and grasp it by that: right part, lifted, handed over."""
    scene = parse_scene(str(MALLET), seed=seed, objects=OBJECTS)
    with Body(scene, OBJECTS, seed=seed, vision="learned") as body:
        assert body.eyes is not None
        (thing,) = body.eyes.unknown
        kind = body.eyes.show("mallet", thing)
        named = ShownKind("mallet", kind.views, kind.masses, {shape: part})
        body.eyes.recall("mallet", named.as_json())
        truth = GroundTruth(body, "thing", [part])
        body.grasp(body.search(["object:mallet"])[0], part)
        lifted = body.lift().ok and truth.lift().is_good([part])
        return truth.closed > 0 and not truth.wrong, lifted, body.hand_over().ok


def main() -> None:
    """Show, count, and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=60, help="of known objects")
    parser.add_argument("--new", type=int, default=20, help="scenes after that of the showing")
    parser.add_argument("--grasps", type=int, default=12, help="by each part")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    with TemporaryDirectory() as folder:
        looks = show_all(Path(folder), given.seed, given.new)
    for name, noise in NOISES.items():
        total, before, after = accuracy(looks, given.seed, given.scenes, noise)
        print(f"{name}: {before} of {total} right, {after} after {len(looks)} kinds were shown")
    for part, shape in (("head", "wide"), ("handle", "long")):
        seeds = range(given.seed, given.seed + given.grasps)
        done = np.sum([grasp(each, part, shape) for each in seeds], axis=0).tolist()
        print(f"by the {part}, of {given.grasps}: right part, lifted, handed over: {done}")


if __name__ == "__main__":
    main()
