"""Train the classifiers of `hilt.sim.vision.learned_detector` on rendered scenes.

    python examples/train_recognition.py [--scenes 1500] [--seed 1000000] [--objects MY] [--out OUT]

It needs scikit-learn: `pip install scikit-learn`.

Scene number i has the seed SEED + i. A fifth of the scenes is held out for calibration and for the
accuracy that is printed. The simulator's mask gives the labels.

Kinds are learned, not instances: objects get other colours and sizes (domain randomisation, Tobin
et al. 2017). Random solids among them are the examples of the class of all others (outlier
exposure, Hendrycks et al. 2019).
With objects of your own, use the result by `hilt do --objects MY --vision learned:OUT`.
"""

import argparse
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from hilt.ontology.errors import SimulationError
from hilt.ontology.objects import Material, ObjectType, PartType, RestingPose, load_household
from hilt.ontology.part_shapes import Box, Extrusion, Form, Lathe, PlacedSolid
from hilt.sim.models.object_models import object_model
from hilt.sim.poses import farthest_points
from hilt.sim.scene.scene import ROOM, Placement, Scene, graspable, scene_with
from hilt.sim.scene.world import World
from hilt.sim.vision.camera import CameraImage
from hilt.sim.vision.learned_detector import (
    CLASSIFIERS_FILE,
    Classifier,
    NoveltyDetector,
    Recogniser,
    point_inputs,
)
from hilt.sim.vision.object_detector import ObjectDetector
from hilt.sim.vision.perception_noise import NoiseLevels
from hilt.sim.vision.segmentation import Segment, describe_segment, segment_images

UNUSUAL = 0.3  # share of objects that lie in any stable pose, usual or not
NAIL, LOOSE_NAIL = 0.25, 0.15  # shares of scenes with one
POINTS = 80  # of a segment, for the part classifier
EXAMPLES = 100  # of each type, for novelty detection
NOISY, MAX_NOISE = 0.4, 0.006  # share of scenes with depth noise, and the most of it [m]
MIN_SCENES = 100  # so that some of every type are held out
MAX_OBJECTS, MAX_OTHERS = 8, 3  # on the table, besides a nail; random solids among them
ALONE = 0.6  # share of scenes with random solids only, and perhaps a nail

SCENES_OF_TYPES = 4  # with the same varied types: to build their models takes the most time
RECOLOURED, RESIZED = 0.6, 0.6  # shares of objects, the first of those that can be taken up
FACTORS = (0.65, 1.45)  # of their lengths
LENGTHS = {"size", "bevel", "profile", "wall", "outline", "thickness", "path", "sections", "scale"}
SOLID_LENGTHS = (0.04, 0.32)  # [m], of the longest side of a random solid
SOLID_RATIOS = ((0.04, 1.0), (0.2, 1.0))  # of the others to it: sticks and plates, or bottles
MIN_LENGTH = 0.003  # [m], of any side
ALIKE = 0.5  # share of random solids that are about as long, wide and high as a known object
LYING, STANDING, ON_EDGE = (0.0, 0.0, 0.0), (0.0, np.pi / 2, 0.0), (np.pi / 2, 0.0, 0.0)
TURNS = (LYING, LYING, STANDING, STANDING, ON_EDGE)  # of random solids, as often

DECAY, RATE, BATCH = 0.02, 0.003, 256  # of the training by Adam (Kingma & Ba 2015)
NETWORKS = 6  # for the types, of which the mean is taken: they agree only on what they know
OBJECT_DECAY = 0.2  # more, so that what no example is like has no extreme probabilities
MIN_DEVIATION = 1e-3  # so that inputs that hardly vary in training do not dominate later
TEMPERATURES = np.geomspace(0.25, 10.0, 200)
LIMIT_QUANTILE = 0.95  # of held-out inputs that are within the limit
MIN_LIMIT = 0.1  # hardly any two inputs are nearer
MAX_LIMIT_RATIO = 1.25  # of a limit to the median of all limits

Rows = list[
    tuple[np.ndarray, int, np.ndarray, np.ndarray]
]  # descriptor, type, point inputs, their parts


class WholeImages(ObjectDetector):
    """A detector of nothing: only its images are used."""

    def detect(self, images: Sequence[CameraImage]) -> tuple[()]:
        """Return nothing."""
        return ()


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

    @cached_property
    def palette(self) -> list[tuple[float, float, float]]:
        """The colours of all parts."""
        return [part.colour for kind in self.objects.values() for part in kind.parts.values()]

    @cached_property
    def sizes(self) -> list[np.ndarray]:
        """Length, width and height of each type, the largest first (3,) [m]."""
        models = [object_model(self.objects[kind]) for kind in self.kinds]
        return [-np.sort(-np.ptp(model.points, axis=0)) for model in models]

    def make_scene(self, seed: int) -> tuple[Scene, dict[str, ObjectType]]:
        """A scene of varied objects, some in unusual poses, random solids and sometimes a nail.

        With it come the types of its objects.
        """
        rng = np.random.default_rng(seed)
        known = varied(self.objects, np.random.default_rng([seed // SCENES_OF_TYPES, 2]))
        count = MAX_OBJECTS if rng.random() < ALONE else int(rng.integers(MAX_OTHERS + 1))
        others = {
            name: random_object(name, self.palette, self.sizes, rng)
            for name in [f"other {i}" for i in range(count)]
        }
        objects = {**known, **others}
        shown, most = graspable(self.objects), MAX_OBJECTS - len(others)
        if len(shown) > most:
            shown = tuple(str(name) for name in rng.choice(shown, most, replace=False))
        placed = [Placement(name, name, rest=self._rest(name, rng)) for name in shown]
        placed += [Placement(name, name) for name in others]
        if rng.random() < LOOSE_NAIL:
            placed.append(Placement("loose nail", "nail", rest="flat"))
        with_block = scene_with(["nail"], seed=seed, objects=objects).placements
        return Scene((*placed, *(with_block if rng.random() < NAIL else ())), seed), objects

    def _rest(self, name: str, rng: np.random.Generator) -> str | None:
        rests = self.objects[name].rests
        return rests[int(rng.integers(len(rests)))].name if rng.random() < UNUSUAL else None

    def samples(self, seed: int) -> Rows:
        """Labelled samples of a scene, from all cameras, from two of them, and from one."""
        rng = np.random.default_rng([seed, 1])
        depth = MAX_NOISE * rng.random() if rng.random() < NOISY else 0.0
        noise = NoiseLevels(depth_m=depth, seed=seed)
        try:
            with World.build(*self.make_scene(seed)) as world:
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
        """A sample of a segment with labels from the mask; nothing when it is not an object.

        The type of random solids comes after all others, and they have no parts.
        """
        labels = np.stack([image.labels.ravel() for image in images])[tuple(segment.sources.T)]
        names = {label: link for image in images for label, link in image.names.items()}
        shown, index = np.unique(labels, return_inverse=True)
        links = [names.get(int(label), ("", "")) for label in shown]
        pairs = [(kinds.get(body, ""), part) for body, part in links]
        known = np.array([self.parts.index(pair) if pair in self.parts else -1 for pair in pairs])
        if np.array([kind == "" for kind, _ in pairs])[index].mean() > 0.2:
            return
        known = known[index]
        count = len(self.kinds)
        owners = [self.kinds.index(self.parts[i][0]) if i >= 0 else count for i in known]
        kind = int(np.argmax(np.bincount(owners)))
        chosen = _chosen_points(known, rng) if kind < count else np.zeros(0, dtype=int)
        yield (
            describe_segment(segment),
            kind,
            point_inputs(segment, min(kind, count - 1), count)[chosen],
            known[chosen],
        )


def _chosen_points(parts: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Indices of some points, given the part of each (n,), -1 for none.

    Points of small parts are more often among them, else a nail in its block would have none.
    """
    known = np.flatnonzero(parts >= 0)
    weights = np.bincount(parts[known])[parts[known]] ** -0.5
    return rng.choice(known, min(POINTS, len(known)), replace=False, p=weights / weights.sum())


def varied(objects: Mapping[str, ObjectType], rng: np.random.Generator) -> dict[str, ObjectType]:
    """The types in other sizes, what stands in another in that of it, and those to take in colours.

    A block has no form of its own: in any colour it would be any box.
    """
    result: dict[str, ObjectType] = {}
    factors = {
        name: log_uniform(FACTORS, rng) if rng.random() < RESIZED else 1.0 for name in objects
    }
    for name, kind in objects.items():
        if name in ROOM:
            result[name] = kind
            continue
        sized = resized(kind, factors[kind.mount.support if kind.mount else name])
        painted = kind.graspable and rng.random() < RECOLOURED
        result[name] = recoloured(sized, rng) if painted else sized
    return result


def log_uniform(limits: tuple[float, float], rng: np.random.Generator) -> float:
    """A number between the limits that is as often in each range with the same ratio."""
    return float(np.exp(rng.uniform(*np.log(limits))))


def recoloured(kind: ObjectType, rng: np.random.Generator) -> ObjectType:
    """A type in one random colour, or in one for each part, with or without its details."""
    details, single, common = rng.random() < 0.5, rng.random() < 0.5, random_colour(rng)
    parts = {}
    for name, part in kind.parts.items():
        shape = tuple(replace(each, colour=each.colour if details else None) for each in part.shape)
        parts[name] = replace(part, shape=shape, colour=common if single else random_colour(rng))
    return replace(kind, parts=parts)


def random_colour(rng: np.random.Generator) -> tuple[float, float, float]:
    """A colour, pale and pure ones among them."""
    red, green, blue = rng.beta(0.7, 0.7, 3)
    return float(red), float(green), float(blue)


def resized(kind: ObjectType, factor: float) -> ObjectType:
    """A type with all lengths multiplied by a factor, and masses by its cube."""

    def form(old: Form) -> Form:
        lengths = {name: value for name, value in vars(old).items() if name in LENGTHS}
        return replace(old, **{name: times(value, factor) for name, value in lengths.items()})

    def part(old: PartType) -> PartType:
        shape = tuple(
            replace(each, form=form(each.form), at=times(each.at, factor)) for each in old.shape
        )
        return replace(old, shape=shape, mass=old.mass * factor**3)

    mount = kind.mount and replace(
        kind.mount,
        **{name: times(getattr(kind.mount, name), factor) for name in ("at", "depth", "deepest")},
    )
    parts = {name: part(old) for name, old in kind.parts.items()}
    return replace(kind, parts=parts, mount=mount)


def times(value: Any, factor: float) -> Any:
    """A number, or numbers in tuples, multiplied by a factor; the path of a file as it is."""
    if isinstance(value, tuple):
        return tuple(times(each, factor) for each in value)
    return value if isinstance(value, Path) else value * factor


def random_object(
    name: str,
    palette: list[tuple[float, float, float]],
    sizes: list[np.ndarray],
    rng: np.random.Generator,
) -> ObjectType:
    """A type of one or two random solids, some in colours of a palette or about of given sizes."""
    size = random_size(log_uniform(SOLID_LENGTHS, rng), rng)
    if rng.random() < ALIKE:
        factors = [log_uniform((0.8, 1.25), rng) for _ in size]
        size = sizes[rng.integers(len(sizes))] * log_uniform(FACTORS, rng) * factors
    solids = [random_solid(size, rng)]
    if rng.random() < 0.5:
        second = random_solid(random_size(size[0] * log_uniform((0.15, 1.0), rng), rng), rng)
        at = (rng.choice([0.0, size[0] / 2]), 0.0, rng.choice([0.0, size[0] / 4]))
        solids.append(replace(second, at=at))
    usual = rng.random() < 0.5
    colours = [palette[rng.integers(len(palette))] if usual else random_colour(rng) for _ in solids]
    shape = tuple(replace(s, colour=colour) for s, colour in zip(solids, colours, strict=True))
    body = PartType("body", "grip", frozenset(), Material("any", 0.6, 0.3), colours[0], 0.1, shape)
    rest = RestingPose("any", TURNS[rng.integers(len(TURNS))], usual=True)
    return ObjectType(name, None, frozenset(), graspable=True, parts={"body": body}, rests=(rest,))


def random_size(length: float, rng: np.random.Generator) -> np.ndarray:
    """Length, width and height (3,) [m] of a given length: of a stick, a plate or a bottle."""
    ratios = SOLID_RATIOS[rng.integers(len(SOLID_RATIOS))]
    return length * np.array([1.0, log_uniform(ratios, rng), log_uniform(ratios, rng)])


def random_solid(size: np.ndarray, rng: np.random.Generator) -> PlacedSolid:
    """A box, a round solid or vessel, a disc, or half a tube, with its length along x."""
    length, width, height = np.maximum(size, MIN_LENGTH).tolist()
    turn = STANDING
    form: Form
    match int(rng.integers(7)):
        case 0:
            form, turn = Box((length, width, height), 0.0), LYING
        case 1 | 2:
            form = cylinder(width / 2, length)
        case 3:
            form, turn = cylinder(length / 2, height), LYING
        case 4 | 5:
            form = random_lathe(length, width, rng)
        case _:
            form = half_tube(length, max(width, 4 * MIN_LENGTH))
    return PlacedSolid(form, (0.0, 0.0, 0.0), turn, None, visible=True, collides=True)


def cylinder(radius: float, length: float) -> Lathe:
    """A cylinder along z [m]."""
    return Lathe(((radius, -length / 2), (radius, length / 2)), 0.0, 0, (1.0, 1.0), smooth=False)


def random_lathe(length: float, width: float, rng: np.random.Generator) -> Lathe:
    """A solid of revolution: a bottle, a cone, a pin, or as often a vessel."""
    count = int(rng.integers(2, 6))
    heights = np.linspace(-length / 2, length / 2, count)
    radii = np.maximum(width / 2 * rng.uniform(0.1, 1.0, count), MIN_LENGTH)
    profile = tuple((float(r), float(z)) for r, z in zip(radii, heights, strict=True))
    wall = min(0.002, radii.min() / 2) if rng.random() < 0.5 and length > 0.02 else 0.0
    return Lathe(profile, float(wall), 0, (1.0, 1.0), smooth=count > 2 and rng.random() < 0.5)


def half_tube(length: float, width: float) -> Extrusion:
    """A gutter [m]."""
    angles = np.linspace(0, np.pi, 9)
    arc = np.column_stack([np.cos(angles), np.sin(angles)])
    outline = np.vstack([width / 2 * arc, (width / 2 - MIN_LENGTH) * arc[::-1]])
    points = tuple((float(x), float(y)) for x, y in outline)
    return Extrusion(points, (length,) * len(points), 0.0, smooth=False)


def main() -> None:
    """Collect samples, train, calibrate, and save."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=1500)
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
    with TemporaryDirectory() as folder:
        os.environ["HILT_CACHE"] = folder  # the models of varied objects are used only once
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
    networks = [
        train_classifier(
            segments,
            kinds,
            count=len(source.kinds) + 1,
            units=128,
            epochs=60,
            decay=OBJECT_DECAY,
            rng=rng,
        )
        for _ in range(NETWORKS)
    ]
    objects = calibrated(joined(networks), held_segments, held_kinds)
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
    known, held_known = kinds < len(source.kinds), held_kinds < len(source.kinds)
    novelty = fit_novelty(
        segments[known],
        kinds[known],
        held_segments[held_known],
        held_kinds[held_known],
        count=EXAMPLES,
    )
    return Recogniser(source.kinds, source.parts, objects, part_classifier, novelty)


def train_classifier(
    inputs: np.ndarray,
    classes: np.ndarray,
    *,
    count: int,
    units: int,
    epochs: int,
    rng: np.random.Generator,
    decay: float = DECAY,
) -> Classifier:
    """Train a network with `units` in its hidden layer on inputs (n, d) of `count` classes (n,)."""
    from sklearn.neural_network import MLPClassifier

    plain = Classifier(inputs.mean(axis=0), inputs.std(axis=0) + MIN_DEVIATION, *[np.zeros(0)] * 4)
    network = MLPClassifier(
        (units,),
        activation="tanh",
        alpha=decay,
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


def joined(networks: list[Classifier]) -> Classifier:
    """One network whose logits are the mean of those of several, which were trained on one set."""
    return replace(
        networks[0],
        hidden=np.hstack([each.hidden for each in networks]),
        hidden_bias=np.hstack([each.hidden_bias for each in networks]),
        output=np.vstack([each.output for each in networks]) / len(networks),
        output_bias=np.mean([each.output_bias for each in networks], axis=0),
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
