"""Measure the learned detector: its accuracy, and the calibration of its confidence.

    python benchmarks/recognition.py [--scenes 400] [--seed 0]

Scene number i is `random:SEED+i`, which training (seeds from 1000000 on) has not seen, with the
robot at its table. Each is seen by all four cameras, by all four with 2 mm and 5 mm of depth noise,
by four with the errors of a stereo depth camera, and by one alone, and made again with each part in
a random colour, and with each object in a random size; what then finds no room is left out. Printed
are the accuracy for objects and points, the expected calibration error over ten bins of confidence,
the number of false detections, the confusion matrix of the first, and how sure the detector is of
five objects that it does not know.
"""

import argparse
import os
import runpy
import sys
import time
from collections import Counter
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from hilt.ontology.errors import SimulationError
from hilt.ontology.objects import ObjectType, PartType, load_household, load_objects
from hilt.sim.body import Body
from hilt.sim.scene.scene import graspable, parse_scene
from hilt.sim.vision.learned_detector import LearnedDetector
from hilt.sim.vision.percept import Percept
from hilt.sim.vision.perception_noise import NoiseLevels

OBJECTS = load_objects()
BINS = 10
NEAR = 0.01  # [m], a point so near to the bounding box of an object belongs to it
NOISES = {
    "4 cameras, 2 mm noise": NoiseLevels(depth_m=0.002),
    "4 cameras, 5 mm noise": NoiseLevels(depth_m=0.005),
    "4 depth cameras": NoiseLevels(camera=1),
}
SIZES = (0.7, 1.4)  # of an object, log-uniform
LOW_CONFIDENCE = 0.5
NOVEL_SCENES = 12
NOVEL = {  # name: form, pitch [degrees], colour
    "rolling pin": ("cylinder: {radius: 0.03, length: 0.3}", 90, "#c99e6c"),
    "bottle": ("cylinder: {radius: 0.03, length: 0.24}", 0, "#d060c0"),
    "brick": ("box: {size: [0.16, 0.06, 0.05]}", 0, "#a03020"),
    "plate": ("cylinder: {radius: 0.09, length: 0.015}", 0, "#f0f0f0"),
    "pen": ("cylinder: {radius: 0.006, length: 0.14}", 90, "#202080"),
}
NOVEL_OBJECT = """  {name}:
    is_a: tool
    parts:
      body: {{role: grip, material: wood, colour: "{colour}", mass: 0.3, shape: [{{{form}}}]}}
    rests: {{usual: {{turn_deg: [0, {pitch}, 0]}}}}
"""
TRAINING = runpy.run_path(str(Path(__file__).parents[1] / "examples" / "train_recognition.py"))


@dataclass
class Tally:
    """The detections under one condition."""

    confused: Counter[tuple[str, str]] = field(default_factory=Counter)
    sure: list[float] = field(default_factory=list)
    right: list[bool] = field(default_factory=list)
    points: Counter[bool] = field(default_factory=Counter)
    false: int = 0

    def add(self, body: Body, percepts: Iterable[Percept]) -> None:
        """Compare percepts with the objects of the world."""
        left = dict.fromkeys(body.world.kinds)
        for percept in percepts:
            name = _object_of(body, percept)
            kind = body.world.kinds[name].name if name in left else ""
            self.sure.append(percept.confidence)
            self.right.append(kind == percept.object)
            if name not in left:
                self.false += 1
                continue
            del left[name]
            self.confused[kind, percept.object] += 1
            if kind == percept.object:
                self._add_points(body, name, percept)
        for name in left:
            self.confused[body.world.kinds[name].name, "nothing"] += 1

    def _add_points(self, body: Body, name: str, percept: Percept) -> None:
        """Count the points that lie on their part, by the bounding box of each part."""
        corners = body.world.models[percept.object].corners
        object_from_world = np.linalg.inv(body.world.pose(name))
        for part, seen in percept.parts.items():
            points = seen @ object_from_world[:3, :3].T + object_from_world[:3, 3]
            gaps = {each: _gap(points, corners[each]) for each in corners}
            least = np.min([gap for each, gap in gaps.items() if each != part], axis=0)
            wrong = int((gaps[part] > least + 0.004).sum())
            self.points[False] += wrong
            self.points[True] += len(points) - wrong

    @property
    def accuracy(self) -> float:
        """Share of the objects that were detected with the right type."""
        return sum(self.right) / self.confused.total()

    @property
    def calibration_error(self) -> float:
        """Expected calibration error: mean gap between confidence and accuracy over bins."""
        sure, right = np.array(self.sure), np.array(self.right, dtype=float)
        bins = np.minimum((sure * BINS).astype(int), BINS - 1)
        gaps = [
            abs(sure[bins == b].mean() - right[bins == b].mean()) * (bins == b).sum()
            for b in set(bins)
        ]
        return float(sum(gaps) / len(sure))


def _gap(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Distances of points (n, 3) to the bounding box of corners [m]."""
    beyond = np.maximum(corners.min(axis=0) - points, points - corners.max(axis=0))
    return np.linalg.norm(np.maximum(beyond, 0), axis=1)


def _object_of(body: Body, percept: Percept) -> str | None:
    """The object whose bounding box holds most points of a percept; None without one."""
    shares: dict[str, float] = {}
    for name, kind in body.world.kinds.items():
        corners = body.world.models[kind.name].points
        object_from_world = np.linalg.inv(body.world.pose(name))
        points = percept.cloud @ object_from_world[:3, :3].T + object_from_world[:3, 3]
        shares[name] = float((_gap(points, corners) < NEAR).mean())
    best = max(shares, key=lambda name: shares[name])
    return best if shares[best] > 0.5 else None


def recoloured(objects: dict[str, ObjectType], rng: np.random.Generator) -> dict[str, ObjectType]:
    """The types that can be taken up, each part in a colour of its own."""

    def painted(part: PartType) -> PartType:
        shape = tuple(replace(solid, colour=None) for solid in part.shape)
        red, green, blue = rng.random(3)
        return replace(part, shape=shape, colour=(red, green, blue))

    def in_colours(kind: ObjectType) -> ObjectType:
        return replace(kind, parts={name: painted(part) for name, part in kind.parts.items()})

    return {**objects, **{name: in_colours(objects[name]) for name in graspable(objects)}}


def resized(objects: dict[str, ObjectType], rng: np.random.Generator) -> dict[str, ObjectType]:
    """The types that can be taken up, each in a size of its own."""
    sizes = {name: float(np.exp(rng.uniform(*np.log(SIZES)))) for name in graspable(objects)}
    return {**objects, **{n: TRAINING["resized"](objects[n], size) for n, size in sizes.items()}}


def main() -> None:
    """Detect objects in scenes and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=400)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    names = ("4 cameras", *NOISES, "1 camera", "random colours", "random sizes")
    tallies = {name: Tally() for name in names}
    seconds = 0.0
    for seed in range(given.seed, given.seed + given.scenes):
        with Body(
            parse_scene(f"random:{seed}", seed=0, objects=OBJECTS), OBJECTS, seed=seed
        ) as body:
            detector = LearnedDetector(body.world)
            images = detector.capture()
            begun = time.process_time()
            tallies["4 cameras"].add(body, detector.detect(images))
            seconds += time.process_time() - begun
            for name, noise in NOISES.items():
                rough_detector = LearnedDetector(body.world, noise=replace(noise, seed=seed))
                tallies[name].add(body, rough_detector.percepts)
            tallies["1 camera"].add(body, detector.detect([images[seed % len(images)]]))
        rng = np.random.default_rng(seed)
        add_varied(tallies["random colours"], recoloured(OBJECTS, rng), seed)
        add_varied(tallies["random sizes"], resized(OBJECTS, rng), seed)
        if sys.stderr.isatty() or seed % 50 == 49:
            print(f"\r{seed - given.seed + 1} scenes", end="", file=sys.stderr, flush=True)
    print(
        f"\nscenes random:{given.seed} to random:{seed}, {seconds / given.scenes:.3f} CPU s each\n"
    )
    _print_table(tallies)
    _print_confusion(tallies["4 cameras"].confused)
    percepts = novel_percepts(given.seed)
    print(f"\nof {len(percepts)} percepts of unknown objects, the surest is {max(percepts):.3f}")


def add_varied(tally: Tally, objects: dict[str, ObjectType], seed: int) -> None:
    """Add the detections in a scene of varied objects, unless there is no room for them."""
    scene = parse_scene(f"random:{seed}", seed=0, objects=objects)
    with suppress(SimulationError), Body(scene, objects, seed=seed) as body:
        tally.add(body, LearnedDetector(body.world).percepts)


def novel_percepts(seed: int) -> list[float]:
    """The confidence of all percepts of objects that the detector does not know."""
    text = "objects:\n" + "".join(
        NOVEL_OBJECT.format(name=name, form=form, pitch=pitch, colour=colour)
        for name, (form, pitch, colour) in NOVEL.items()
    )
    with TemporaryDirectory() as folder:
        path = Path(folder) / "novel.yaml"
        path.write_text(text, encoding="utf-8")
        objects = load_household(path, added_to=load_household()).objects
    found: list[float] = []
    for number in range(seed, seed + NOVEL_SCENES):
        scene = parse_scene(f"objects:{','.join(NOVEL)}", seed=number, objects=objects)
        with Body(scene, objects, seed=number) as body:
            found += [percept.confidence for percept in LearnedDetector(body.world).percepts]
    return found


def _print_table(tallies: dict[str, Tally]) -> None:
    columns = (
        "images",
        "objects",
        "accuracy",
        "calibration error",
        "low confidence",
        "of these right",
        "points on the right part",
        "false",
    )
    print("|", " | ".join(columns), "|")
    print("|---" * len(columns) + "|")
    for name, tally in tallies.items():
        unsure = [
            right
            for sure, right in zip(tally.sure, tally.right, strict=True)
            if sure < LOW_CONFIDENCE
        ]
        row = (
            name,
            f"{tally.confused.total()}",
            f"{tally.accuracy:.4f}",
            f"{tally.calibration_error:.4f}",
            f"{len(unsure)}",
            f"{sum(unsure)}",
            f"{tally.points[True] / tally.points.total():.4f}",
            f"{tally.false}",
        )
        print("|", " | ".join(row), "|")


def _print_confusion(confused: Counter[tuple[str, str]]) -> None:
    kinds = graspable(OBJECTS)
    columns = [*kinds, *sorted({seen for _, seen in confused} - set(kinds))]
    print("\n| type \\ detected as |", " | ".join(columns), "|")
    print("|---|" + "---|" * len(columns))
    for kind in kinds:
        print(f"| {kind} |", " | ".join(str(confused[kind, seen]) for seen in columns), "|")


if __name__ == "__main__":
    with TemporaryDirectory() as cache:
        os.environ["HILT_CACHE"] = cache  # the models of varied objects are used only once
        main()
