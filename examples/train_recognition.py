"""Train the classifiers of `hilt.sim.vision.learned_detector` on rendered scenes.

    python examples/train_recognition.py [--scenes 260] [--seed 1000000] [--objects MY] [--out OUT]

It needs scikit-learn: `pip install scikit-learn`.

Scene number i has the seed SEED + i. A fifth of the scenes is held out for calibration and for the
accuracy that is printed. The simulator's mask gives the labels.
With objects of your own, use the result by `hilt do --objects MY --vision learned:OUT`.
"""

import argparse
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from hilt.ontology.errors import SimulationError
from hilt.ontology.objects import ObjectType, load_household
from hilt.sim.scene.scene import Placement, Scene, graspable, scene_with
from hilt.sim.scene.world import World
from hilt.sim.vision.camera import CameraImage
from hilt.sim.vision.learned_detector import (
    CLASSIFIERS_FILE,
    Classifier,
    NoveltyDetector,
    Recogniser,
    point_inputs,
)
from hilt.sim.vision.object_detector import MaskDetector, ObjectDetector
from hilt.sim.vision.perception_noise import NoiseLevels
from hilt.sim.vision.point_cloud_operations import farthest_points
from hilt.sim.vision.segmentation import Segment, describe_segment, segment_images

UNUSUAL = 0.3  # share of objects that lie in any stable pose, usual or not
NAIL, LOOSE_NAIL = 0.25, 0.15  # shares of scenes with one
POINTS = 80  # of a segment, for the part classifier
EXAMPLES = 100  # of each type, for novelty detection
NOISY = 0.3  # share of scenes with depth noise
MIN_SCENES = 40  # so that some of every type are held out
MAX_OBJECTS = 8  # on the table, besides a nail

DECAY, RATE, BATCH = 0.02, 0.003, 256  # of the training by Adam (Kingma & Ba 2015)
MIN_DEVIATION = 1e-3  # so that inputs that hardly vary in training do not dominate later
TEMPERATURES = np.geomspace(0.25, 10.0, 200)
LIMIT_QUANTILE = 0.99  # of held-out inputs that are within the limit
MIN_LIMIT = 0.1  # hardly any two inputs are nearer
MAX_LIMIT_RATIO = 1.25  # of a limit to the median of all limits

Rows = list[
    tuple[np.ndarray, int, np.ndarray, np.ndarray]
]  # descriptor, type, point inputs, their parts


class WholeImages(MaskDetector):
    """The mask detector with images of the whole table."""

    _render = ObjectDetector._render


@dataclass(frozen=True)
class TrainingScenes:
    """Renders scenes, and labels their segments.

    Attributes:
        objects: the types, by name.
    """

    objects: Mapping[str, ObjectType]

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """The types to be classified."""
        return (*graspable(self.objects), "block", "nail")

    @cached_property
    def parts(self) -> tuple[tuple[str, str], ...]:
        """The (type, part) pairs to be classified."""
        return tuple((kind, part) for kind in self.kinds for part in self.objects[kind].parts)

    def make_scene(self, seed: int) -> Scene:
        """A scene with objects, some in unusual poses, and sometimes a nail."""
        rng = np.random.default_rng(seed)
        shown = graspable(self.objects)
        if len(shown) > MAX_OBJECTS:
            shown = tuple(str(name) for name in rng.choice(shown, MAX_OBJECTS, replace=False))
        placed = [Placement(name, name, rest=self._rest(name, rng)) for name in shown]
        if rng.random() < LOOSE_NAIL:
            placed.append(Placement("loose nail", "nail", rest="flat"))
        with_block = scene_with(["nail"], seed=seed, objects=self.objects).placements
        return Scene((*placed, *(with_block if rng.random() < NAIL else ())), seed)

    def _rest(self, name: str, rng: np.random.Generator) -> str | None:
        rests = self.objects[name].rests
        return rests[int(rng.integers(len(rests)))].name if rng.random() < UNUSUAL else None

    def samples(self, seed: int) -> Rows:
        """Labelled samples of a scene, from all cameras, from two of them, and from one."""
        rng = np.random.default_rng([seed, 1])
        noise = NoiseLevels(
            depth_m=0.002 * rng.random() if rng.random() < NOISY else 0.0, seed=seed
        )
        try:
            with World.build(self.make_scene(seed), self.objects) as world:
                images = WholeImages(world, noise=noise).capture()
                kinds = {name: kind.name for name, kind in world.kinds.items()}
        except SimulationError:  # a table that is too full
            return []
        rows: Rows = []
        for count in (len(images), 2, 1):
            chosen = [images[i] for i in rng.choice(len(images), count, replace=False)]
            for segment in segment_images(chosen, noise=noise.depth_m):
                rows += self._sample(segment, chosen, kinds, rng)
        return rows

    def _sample(
        self,
        segment: Segment,
        images: list[CameraImage],
        kinds: dict[str, str],
        rng: np.random.Generator,
    ) -> Iterator[tuple[np.ndarray, int, np.ndarray, np.ndarray]]:
        """A sample of a segment with labels from the mask; nothing when it is not an object."""
        links = [
            images[view].names.get(int(images[view].labels.flat[pixel]))
            for view, pixel in segment.sources
        ]
        pairs = [(kinds.get(link[0], ""), link[1]) if link else ("", "") for link in links]
        known = np.array([self.parts.index(pair) if pair in self.parts else -1 for pair in pairs])
        if (known < 0).mean() > 0.2:
            return
        owned = [self.kinds.index(self.parts[i][0]) for i in known if i >= 0]
        kind = int(np.argmax(np.bincount(owned, minlength=len(self.kinds))))
        chosen = rng.permutation(np.flatnonzero(known >= 0))[:POINTS]
        yield (
            describe_segment(segment),
            kind,
            point_inputs(segment, kind, len(self.kinds))[chosen],
            known[chosen],
        )


def main() -> None:
    """Collect samples, train, calibrate, and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=260)
    parser.add_argument("--seed", type=int, default=1_000_000)
    parser.add_argument("--objects", type=Path, help="a file with objects of your own")
    parser.add_argument("--out", type=Path, default=CLASSIFIERS_FILE)
    given = parser.parse_args()
    if given.scenes < MIN_SCENES:
        parser.error(f"expected at least {MIN_SCENES} scenes")
    print(f"scenes {given.scenes}, seeds {given.seed} to {given.seed + given.scenes - 1}")

    household = load_household()
    if given.objects:
        household = load_household(given.objects, added_to=household)
    source, scenes = TrainingScenes(household.objects), []
    for i in range(given.scenes):
        scenes.append(source.samples(given.seed + i))
        if i % 20 == 19:
            print(f"  {i + 1} scenes rendered", flush=True)
    held = given.scenes // 5
    rng = np.random.default_rng(given.seed)
    _save(_train(source, scenes[held:], scenes[:held], rng), given.out)
    print(f"{given.out}: {given.out.stat().st_size / 1000:.0f} kB")


def _train(
    source: TrainingScenes, scenes: list[Rows], held: list[Rows], rng: np.random.Generator
) -> Recogniser:
    """Train both classifiers and the novelty detector, calibrated on the held-out scenes."""
    segments, kinds, points, parts = _stacked(scenes)
    held_segments, held_kinds, held_points, held_parts = _stacked(held)
    objects = calibrated(
        train_classifier(segments, kinds, count=len(source.kinds), units=48, epochs=60, rng=rng),
        held_segments,
        held_kinds,
    )
    part_classifier = calibrated(
        train_classifier(points, parts, count=len(source.parts), units=64, epochs=20, rng=rng),
        held_points,
        held_parts,
    )
    for what, classifier, inputs, classes in (
        ("objects", objects, held_segments, held_kinds),
        ("points", part_classifier, held_points, held_parts),
    ):
        right = (classifier.probabilities(inputs).argmax(axis=1) == classes).mean()
        print(
            f"{what}: {right:.4f} of {len(inputs)} right, temperature {classifier.temperature:.2f}"
        )
    novelty = fit_novelty(segments, kinds, held_segments, held_kinds, count=EXAMPLES)
    return Recogniser(source.kinds, source.parts, objects, part_classifier, novelty)


def train_classifier(
    inputs: np.ndarray,
    classes: np.ndarray,
    *,
    count: int,
    units: int,
    epochs: int,
    rng: np.random.Generator,
) -> Classifier:
    """Train a network with `units` in its hidden layer on inputs (n, d) of `count` classes (n,)."""
    from sklearn.neural_network import MLPClassifier

    plain = Classifier(inputs.mean(axis=0), inputs.std(axis=0) + MIN_DEVIATION, *[np.zeros(0)] * 4)
    network = MLPClassifier(
        (units,),
        activation="tanh",
        alpha=DECAY,
        batch_size=BATCH,
        learning_rate_init=RATE,
        random_state=int(rng.integers(2**31)),
    )
    standardised = plain.standardised(inputs)
    for _ in range(epochs):  # also of classes that are missing from the data
        network.partial_fit(standardised, classes, classes=np.arange(count))
    (hidden, output), (hidden_bias, output_bias) = network.coefs_, network.intercepts_
    return replace(
        plain, hidden=hidden, hidden_bias=hidden_bias, output=output, output_bias=output_bias
    )


def calibrated(classifier: Classifier, inputs: np.ndarray, classes: np.ndarray) -> Classifier:
    """The same network at the temperature that makes these classes (n,) most probable."""
    rows = np.arange(len(classes))
    tried = [replace(classifier, temperature=temperature) for temperature in TEMPERATURES]
    losses = [-np.log(each.probabilities(inputs)[rows, classes] + 1e-8).mean() for each in tried]
    return tried[int(np.argmin(losses))]


def fit_novelty(
    inputs: np.ndarray,
    classes: np.ndarray,
    held_inputs: np.ndarray,
    held_classes: np.ndarray,
    *,
    count: int,
) -> NoveltyDetector:
    """Choose `count` examples of each class among inputs (n, d), and limits from held-out ones.

    The examples of a class lie far from each other (farthest point sampling).
    """
    kinds = range(int(classes.max()) + 1)
    centres = np.array([inputs[classes == kind].mean(axis=0) for kind in kinds])
    deviation = (inputs - centres[classes]).std(axis=0) + MIN_DEVIATION
    members = [np.flatnonzero(classes == kind) for kind in kinds]
    index = np.concatenate(
        [each[farthest_points(inputs[each] / deviation, count, first=0)] for each in members]
    )
    unlimited = NoveltyDetector(deviation, inputs[index], classes[index], np.ones(len(members)))
    pairs = zip(held_inputs, held_classes, strict=True)
    novelty = np.array([unlimited.novelty(row, kind) for row, kind in pairs])
    held = [novelty[held_classes == kind] for kind in kinds]
    limits = [np.quantile(each, LIMIT_QUANTILE) if len(each) else np.nan for each in held]
    # Few inputs of some classes are held out; one outlier must not accept everything.
    limit = np.fmin(limits, MAX_LIMIT_RATIO * np.nanmedian(limits))
    return replace(unlimited, limit=np.maximum(limit, MIN_LIMIT))


def _stacked(scenes: list[Rows]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rows = [row for scene in scenes for row in scene]
    return (
        np.array([row[0] for row in rows]),
        np.array([row[1] for row in rows]),
        np.vstack([row[2] for row in rows]),
        np.concatenate([row[3] for row in rows]),
    )


def _save(recogniser: Recogniser, path: Path) -> None:
    """Write a recogniser to a file, as `Recogniser.load` reads it."""
    arrays = {
        f"{prefix}_{name}": np.asarray(value, dtype=np.float32)
        for prefix, part in (
            ("things", recogniser.objects),
            ("points", recogniser.points),
            ("usual", recogniser.novelty),
        )
        for name, value in vars(part).items()
    }
    parts = np.array(["/".join(pair) for pair in recogniser.parts])
    np.savez_compressed(
        path, allow_pickle=False, kinds=np.array(recogniser.kinds), parts=parts, **arrays
    )


if __name__ == "__main__":
    main()
