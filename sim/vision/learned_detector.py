"""Object detection by trained classifiers, from colours and depths only.

Depths are segmented into objects; one classifier recognises each segment, another assigns its
points to parts. Both were trained on rendered images (`examples/train_recognition.py`).

The confidence of a percept is the calibrated probability of its type: of all percepts with 0.8,
eight in ten are right. Networks are overconfident: dividing the logits by a temperature found on
held-out data calibrates them (Guo et al. 2017). All other objects are a class as well, trained on
random solids. As these are not all, `NoveltyDetector` compares inputs with stored examples of their
class, and lowers the confidence beyond a distance that hardly any known input exceeds.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import TypeVar
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from ...ontology.errors import DataError
from ...ontology.objects import ObjectType
from ..poses import Array, voxel_downsample, voxel_keys
from ..scene.scene import numbered
from . import segmentation
from .camera import CameraImage
from .object_detector import ObjectDetector
from .percept import Percept
from .registration import SPACING
from .segmentation import Segment, describe_segment, segment_images
from .shown_kinds import ShownKind, estimated_masses

CLASSIFIERS_FILE = Path(__file__).with_name("recognition.npz")
NEAR = 0.03  # [m], to where an object should be, of its points
MIN_PART_POINTS = 12  # fewer are errors of the part classifier
SMOOTHING = 0.006  # [m], voxels in which points share their part
SAME_PLACE = 0.04  # [m], between the centre of a percept and where an object was seen last

MAX_DEVIATIONS = 6.0  # standardised inputs are clipped to it, so that none decides alone
SURE = 0.7  # confidence from which on a thing is known
ALIKE = 0.65  # from a view, as from an example: most from one of the kind, half of others
STEEPNESS = 6.0  # at 1.5 times the limit a twelfth of the confidence is left

# What numpy raises, by what there is in place of a file of arrays.
_UNREADABLE = (OSError, EOFError, BadZipFile, ValueError, KeyError, TypeError, AttributeError)
_T = TypeVar("_T", "Classifier", "NoveltyDetector")


@dataclass(frozen=True, eq=False)
class Classifier:
    """A trained network."""

    mean: Array  #: of the inputs (d,)
    deviation: Array  #: standard deviation of the inputs (d,)
    hidden: Array  #: weights of the hidden layer (d, h)
    hidden_bias: Array  #: (h,)
    output: Array  #: weights of the output layer (h, c)
    output_bias: Array  #: (c,)
    temperature: Array | float = 1.0  #: by which the logits are divided

    def standardised(self, inputs: Array) -> Array:
        """Inputs (n, d) in standard deviations from their means, clipped."""
        return np.clip((inputs - self.mean) / self.deviation, -MAX_DEVIATIONS, MAX_DEVIATIONS)

    def logits(self, inputs: Array) -> Array:
        """Calibrated logits (n, c) of inputs (n, d)."""
        units = np.tanh(self.standardised(inputs) @ self.hidden + self.hidden_bias)
        return (units @ self.output + self.output_bias) / self.temperature

    def probabilities(self, inputs: Array) -> Array:
        """Class probabilities (n, c) of inputs (n, d)."""
        logits = self.logits(inputs)
        raised = np.exp(logits - logits.max(axis=1, keepdims=True))
        return raised / raised.sum(axis=1, keepdims=True)


@dataclass(frozen=True, eq=False)
class NoveltyDetector:
    """Examples of each class, to tell known inputs from novel ones."""

    deviation: Array  #: of each input within the classes (d,); the unit of distances
    examples: Array  #: some members of all classes (m, d)
    classes: Array  #: class of each example (m,)
    limit: Array  #: distance to the nearest example of each class up to which inputs are known (c,)

    def distance(self, row: Array, examples: Array) -> float:
        """The root mean square distance of an input (d,) from the nearest example (m, d)."""
        squares = np.minimum(np.abs(examples - row) / self.deviation, MAX_DEVIATIONS) ** 2
        return float(np.sqrt(squares.mean(axis=1).min()))

    def novelty(self, row: Array, kind: int) -> float:
        """The distance of an input (d,) from a class; the limit is 1."""
        return self.distance(row, self.examples[self.classes == kind]) / float(self.limit[kind])

    def confidence(self, row: Array, kind: int) -> float:
        """Confidence in (0, 1] that an input (d,) is a member of its class at all."""
        return max(self.novelty(row, kind), 1.0) ** -STEEPNESS


def read_arrays(kind: type[_T], arrays: Mapping[str, NDArray[np.float32]], prefix: str) -> _T:
    """Return a classifier or a detector from those arrays whose names begin with a prefix."""
    names = [each.name for each in fields(kind)]
    return kind(**{name: arrays[f"{prefix}_{name}"].astype(np.float64) for name in names})


@dataclass(frozen=True, eq=False)
class Recogniser:
    """Recognises the objects and parts that segments show."""

    kinds: tuple[str, ...]  #: the types, as in the outputs of `objects`; others are last
    parts: tuple[tuple[str, str], ...]  #: (type, part), in the order of the outputs of `points`
    objects: Classifier  #: of segments
    points: Classifier  #: of their points
    novelty: NoveltyDetector  #: tells segments unlike any known object

    @classmethod
    def load(cls, path: Path) -> "Recogniser":
        """Read a recogniser from a file; a `DataError` when it cannot be read."""
        try:
            with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
                pairs = (str(text).partition("/") for text in arrays["parts"])
                made = cls(
                    tuple(str(kind) for kind in arrays["kinds"]),
                    tuple((kind, part) for kind, _, part in pairs),
                    read_arrays(Classifier, arrays, "things"),
                    read_arrays(Classifier, arrays, "points"),
                    read_arrays(NoveltyDetector, arrays, "usual"),
                )
            if len(made.objects.output_bias) != len(made.kinds) + 1:
                raise ValueError("made by an earlier version")
        except _UNREADABLE as error:
            problem = f"cannot be read ({error}); make it by examples/train_recognition.py."
            raise DataError(problem, source=str(path)) from error
        return made

    @staticmethod
    @cache
    def default() -> "Recogniser":
        """The recogniser of Hilt's own objects."""
        return Recogniser.load(CLASSIFIERS_FILE)

    def recognise(self, segment: Segment) -> tuple[str, float]:
        """Return the type of a segment, and the confidence in it, in [0, 1]."""
        described = describe_segment(segment)
        probabilities = self.objects.probabilities(described[None])[0, : len(self.kinds)]
        best = int(np.argmax(probabilities))
        known = self.novelty.confidence(described, best)
        return self.kinds[best], float(probabilities[best] * known)

    def assign_parts(
        self, segment: Segment, kind: str, candidates: Sequence[tuple[str, str]]
    ) -> np.ndarray:
        """Return the part of each point, as an index (n,) of the `candidates` (type, part)."""
        logits = self.points.logits(point_inputs(segment, self.kinds.index(kind), len(self.kinds)))
        logits = logits[:, [self.parts.index(pair) for pair in candidates]]
        # Neighbouring points mostly share their part: logits are averaged over each voxel.
        index = np.unique(voxel_keys(segment.points, SMOOTHING), return_inverse=True)[1]
        sums = [np.bincount(index, weights=column) for column in logits.T]
        return np.argmax(np.column_stack(sums)[index] / np.bincount(index)[index, None], axis=1)


def point_inputs(segment: Segment, kind: int, count: int) -> Array:
    """Descriptors of a segment's points with its type as a one-hot vector (n, k + count)."""
    types = np.zeros((len(segment), count))
    types[:, kind] = 1.0
    return np.hstack([segmentation.describe_points(segment), types])


@dataclass(eq=False)
class LearnedDetector(ObjectDetector):
    """Detects objects by trained classifiers; only the types that they know.

    The names of percepts are those of the objects of the scene that were last seen nearest; the
    first places are those of the scene. DataError if a type is not of the world.
    """

    recogniser: Recogniser = field(default_factory=Recogniser.default)
    #: the kinds that were shown, by name
    shown: dict[str, ShownKind] = field(default_factory=dict[str, ShownKind], init=False)

    def __post_init__(self) -> None:
        self._places = {name: self.world.top(name)[:2] for name in self.world.kinds}
        if missing := [kind for kind in self.recogniser.kinds if kind not in self.world.objects]:
            problem = f"were trained on {', '.join(missing)}, which is not among the objects."
            advice = "Name the file that defines them with --objects."
            raise DataError(f"the classifiers {problem} {advice}", source="classifiers")

    @property
    def kinds(self) -> Mapping[str, ObjectType]:
        """The types that it knows, with those that were shown."""
        known = {name: self.world.objects[name] for name in self.recogniser.kinds}
        return known | {name: each.kind for name, each in self.shown.items()}

    @property
    def unknown(self) -> tuple[Percept, ...]:
        """The things in view that it does not know, as what they are like most."""
        return tuple(each for each in self.percepts if each.confidence < SURE)

    def show(self, name: str, thing: Percept) -> ShownKind:
        """Return what is known of a kind after looks at a thing of it that is in view.

        All cameras see it together, and again without each of them.
        """
        known = self.shown.get(name) or ShownKind(name, (), estimated_masses(thing.cloud))
        images = self.capture()
        looks = (images, *combinations(images, max(1, len(images) - 1)))
        found = filter(None, (self._segment_at(thing, some) for some in looks))
        return replace(known, views=(*known.views, *map(describe_segment, found)))

    def recall(self, name: str, look: str) -> None:
        """Know a kind by what `ShownKind.as_json` returned, in place of one with this name."""
        self.shown[name] = ShownKind.from_json(name, look)
        self._seen = -1, ()

    def detect(self, images: Sequence[CameraImage]) -> list[Percept]:
        """Return the objects that the images seem to show; alike ones get numbered names."""
        segments = segment_images(images, noise=self.noise.depth_error)
        percepts = [percept for segment in segments for percept in self._percepts(segment)]
        percepts.sort(key=lambda percept: -percept.confidence)
        names = numbered(map(self._nearest_object, percepts))
        named = [replace(each, name=name) for each, name in zip(percepts, names, strict=True)]
        self._places |= {each.name: each.centre[:2] for each in named if each.name in self._places}
        return named

    def look(self, expected: Percept) -> Percept | None:
        """The points near where an object should be, of the parts that should be nearest."""
        from scipy.spatial import KDTree  # here: it takes half a second to import

        low, high = expected.cloud.min(axis=0) - NEAR, expected.cloud.max(axis=0) + NEAR
        table = segmentation.TABLE_MARGIN + segmentation.NOISE_MARGIN * self.noise.depth_error
        low[2] = max(low[2], table)
        clouds = list[Array]()
        for image in self.capture(self.cameras[:2]):
            mask = np.isfinite(image.depth)
            mask[1::2] = mask[:, 1::2] = False  # a quarter of the pixels is dense enough
            clouds.append(image.points(mask))
        seen = np.vstack(clouds)  # in a hand it is no segment of its own
        seen = seen[((seen > low) & (seen < high)).all(axis=1)]
        seen = seen[voxel_downsample(seen, SPACING)]
        gaps = [KDTree(cloud).query(seen)[0] for cloud in expected.parts.values()]
        nearest = np.where(np.min(gaps, axis=0) < NEAR, np.argmin(gaps, axis=0), -1)
        parts = {name: seen[nearest == i] for i, name in enumerate(expected.parts)}
        shown = {name: cloud for name, cloud in parts.items() if len(cloud) >= MIN_PART_POINTS}
        return replace(expected, parts=shown) if shown else None

    def _segment_at(self, thing: Percept, images: Sequence[CameraImage]) -> Segment | None:
        for segment in segment_images(images, noise=self.noise.depth_error):
            middle = (segment.points.min(axis=0) + segment.points.max(axis=0)) / 2
            if np.linalg.norm((middle - thing.centre)[:2]) < SAME_PLACE:
                return segment
        return None

    def _as_shown(self, segment: Segment) -> Percept | None:
        row = describe_segment(segment)
        distance, shown = self.recogniser.novelty.distance, self.shown.items()
        gaps = {name: distance(row, np.array(kind.views)) for name, kind in shown}
        name = min(gaps, key=lambda each: gaps[each], default="")
        if not name or gaps[name] >= ALIKE:
            return None
        parts, known = self.shown[name].parts(segment.points), self.shown[name].kind.parts
        sure = 1.0 - (gaps[name] / ALIKE) ** 2 * (1.0 - SURE)
        return Percept(name, name, sure, parts) if parts.keys() <= known.keys() else None

    def _percepts(self, segment: Segment) -> Iterator[Percept]:
        if shown := self._as_shown(segment):
            yield shown
            return
        objects = self.world.objects
        kind, confidence = self.recogniser.recognise(segment)
        known = self.recogniser.kinds if confidence >= SURE else ()
        mounts = ((name, objects[name].mount) for name in known)
        kinds = [kind, *(name for name, mount in mounts if mount and mount.support == kind)]
        candidates = [(each, part) for each in kinds for part in objects[each].parts]
        parts = self.recogniser.assign_parts(segment, kind, candidates)
        for each in kinds:
            visible = {
                part: segment.points[parts == i]
                for i, (owner, part) in enumerate(candidates)
                if owner == each and (parts == i).sum() >= MIN_PART_POINTS
            }
            if visible:
                yield Percept(each, each, confidence, visible, objects[each].properties)

    def _nearest_object(self, percept: Percept) -> str:
        gaps = {n: np.linalg.norm(at - percept.centre[:2]) for n, at in self._places.items()}
        alike = [name for name in gaps if self.world.kinds[name].name == percept.object]
        near = [name for name in alike if gaps[name] < SAME_PLACE]
        return min(near or alike or gaps, key=lambda name: gaps[name], default=percept.object)
