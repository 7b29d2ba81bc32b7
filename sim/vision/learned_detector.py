"""Object detection by trained classifiers, from colours and depths only.

Depths are segmented into objects; one classifier recognises each segment, another assigns its
points to parts. Both were trained on rendered images (`examples/train_recognition.py`) and are
stored in `recognition.npz`. The confidence of a percept is the calibrated probability of its type
(of all percepts with 0.8, eight in ten are right), reduced for segments unlike any known object.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from operator import attrgetter
from pathlib import Path

import numpy as np

from ...ontology.errors import DataError
from ...ontology.objects import ObjectType
from ..physics.engine import PhysicsEngine
from ..poses import Array
from .camera import CAMERAS_ROUND_TABLE, Camera, CameraImage
from .mask_detector import OBSTACLE_SPACING, with_camera_noise
from .neural_classifier import Classifier, NoveltyDetector, read_arrays
from .percept import PartPercept, Percept, visible_features
from .perception_noise import NoiseLevels
from .point_cloud_operations import voxel_downsample, voxel_keys
from .segmentation import TABLE_MARGIN, Segment, describe_points, describe_segment, segment_images

CLASSIFIERS_FILE = Path(__file__).with_name("recognition.npz")
MIN_PART_POINTS = 12  # fewer are errors of the part classifier
NOISE_MARGIN = 4.0  # standard deviations of depth noise that still belong to the table
SMOOTHING = 0.006  # [m], voxels in which points share their part


@dataclass(frozen=True, eq=False)
class Recogniser:
    """Recognises the objects and parts that segments show.

    Attributes:
        kinds, objects: the types, in the order of the outputs of the classifier of segments.
        parts, points: (type, part), in the order of the outputs of the classifier of their points.
        novelty: tells segments unlike any known object.
    """

    kinds: tuple[str, ...]
    parts: tuple[tuple[str, str], ...]
    objects: Classifier
    points: Classifier
    novelty: NoveltyDetector

    @classmethod
    def load(cls, path: Path) -> Recogniser:
        """Read a recogniser from a file; a `DataError` when it cannot be read."""
        try:
            with np.load(path, allow_pickle=False) as arrays:
                return cls(
                    tuple(str(kind) for kind in arrays["kinds"]),
                    tuple(_pair(str(text)) for text in arrays["parts"]),
                    read_arrays(Classifier, arrays, "things"),
                    read_arrays(Classifier, arrays, "points"),
                    read_arrays(NoveltyDetector, arrays, "usual"),
                )
        except (OSError, ValueError, KeyError) as error:
            raise DataError(f"cannot be read: {error}.", source=str(path)) from error

    @staticmethod
    @cache
    def default() -> Recogniser:
        """The recogniser of Hilt's own objects."""
        return Recogniser.load(CLASSIFIERS_FILE)

    def recognise(self, segment: Segment) -> tuple[str, float]:
        """Return the type of a segment, and the confidence in it, in [0, 1]."""
        described = describe_segment(segment)
        probabilities = self.objects.probabilities(described[None])[0]
        best = int(np.argmax(probabilities))
        known = self.novelty.confidence(described, best)
        return self.kinds[best], float(probabilities[best] * known)

    def assign_parts(
        self, segment: Segment, kind: str, candidates: Sequence[tuple[str, str]]
    ) -> np.ndarray:
        """Return the part of each point of a segment, as an index (n,) of the candidates.

        The candidates are the (type, part) that can be in a segment of that type.
        """
        logits = self.points.logits(point_inputs(segment, self.kinds.index(kind), len(self.kinds)))
        columns = [self.parts.index(pair) for pair in candidates]
        return np.argmax(_voxel_means(segment.points, logits[:, columns]), axis=1)


def _pair(text: str) -> tuple[str, str]:
    kind, _, part = text.partition("/")
    return kind, part


def point_inputs(segment: Segment, kind: int, count: int) -> Array:
    """Descriptors of a segment's points with its type as a one-hot vector (n, k + count)."""
    types = np.zeros((len(segment), count))
    types[:, kind] = 1.0
    return np.hstack([describe_points(segment), types])


def _voxel_means(points: Array, logits: Array) -> Array:
    """Logits (n, c) averaged over each voxel: neighbouring points mostly share their part."""
    _, index = np.unique(voxel_keys(points, SMOOTHING), return_inverse=True)
    counts = np.bincount(index)
    sums = [np.bincount(index, weights=column) for column in logits.T]
    return np.column_stack(sums)[index] / counts[index, None]


@dataclass(frozen=True)
class LearnedDetector:
    """Detects objects by trained classifiers; used like `MaskDetector`.

    Attributes:
        objects: all types, by name; only those of the recogniser are detected.
        noise: only its depth noise is used here.
        track: names a percept; by its type when left out.
        recogniser: that of Hilt's own objects when left out.

    Raises:
        DataError: the recogniser knows a type that is not among the objects.
    """

    engine: PhysicsEngine
    objects: Mapping[str, ObjectType]
    cameras: tuple[Camera, ...] = CAMERAS_ROUND_TABLE
    noise: NoiseLevels = field(default_factory=NoiseLevels)
    track: Callable[[Percept], str] = attrgetter("object")
    recogniser: Recogniser = field(default_factory=Recogniser.default)

    def __post_init__(self) -> None:
        missing = [kind for kind in self.recogniser.kinds if kind not in self.objects]
        if missing:
            raise DataError(
                f"the classifiers were trained on {', '.join(missing)}, which is not among the "
                "objects. Name the file that defines them with --objects.",
                source="classifiers",
            )

    def capture(self) -> tuple[CameraImage, ...]:
        """Take one image with each camera."""
        images = (camera.capture(self.engine) for camera in self.cameras)
        return with_camera_noise(images, self.noise, self.engine.steps)

    def search(
        self, features: Iterable[str], *, images: Sequence[CameraImage] | None = None
    ) -> tuple[Percept, ...]:
        """Return the objects that seem to have one of the features; see `MaskDetector.search`."""
        wanted = frozenset(features)
        images = self.capture() if images is None else images
        margin = TABLE_MARGIN + NOISE_MARGIN * self.noise.depth_m
        segments = segment_images(images, margin=margin)
        percepts = [
            percept
            for segment, (kind, confidence) in [(s, self.recogniser.recognise(s)) for s in segments]
            if any(
                wanted & visible_features(self.objects[each]) for each in self._with_mounted(kind)
            )
            for percept in self._percepts(segment, kind, confidence)
            if wanted & visible_features(self.objects[percept.object])
        ]
        ordered = sorted(percepts, key=lambda percept: -percept.confidence)
        return tuple(_named(ordered, self.track))

    def obstacles(
        self, exclude: str | None, *, images: Sequence[CameraImage] | None = None
    ) -> Array:
        """Return points (n, 3) on all detected objects but `exclude`, in the world [m]."""
        features = [f"object:{kind}" for kind in self.objects]
        found = self.search(features, images=images)
        clouds = [percept.cloud for percept in found if percept.name != exclude]
        cloud = np.vstack([np.empty((0, 3)), *clouds])
        return cloud[voxel_downsample(cloud, OBSTACLE_SPACING)]

    def _with_mounted(self, kind: str) -> tuple[str, ...]:
        """A type, and the types that may stand in it: together they are one segment."""
        mounted = (
            name
            for name in self.recogniser.kinds
            if (mount := self.objects[name].mount) and mount.support == kind
        )
        return (kind, *mounted)

    def _percepts(self, segment: Segment, kind: str, confidence: float) -> Iterator[Percept]:
        """The percepts of one segment: an object of that type, and what stands in it."""
        kinds = self._with_mounted(kind)
        candidates = [(each, part) for each in kinds for part in self.objects[each].parts]
        parts = self.recogniser.assign_parts(segment, kind, candidates)
        for each in kinds:
            visible = {
                part: PartPercept(part, segment.points[parts == i], int((parts == i).sum()))
                for i, (owner, part) in enumerate(candidates)
                if owner == each and (parts == i).sum() >= MIN_PART_POINTS
            }
            if visible:
                yield Percept(each, each, confidence, visible, self.objects[each].properties)


def _named(percepts: Sequence[Percept], track: Callable[[Percept], str]) -> Iterator[Percept]:
    """The percepts under the names of their objects; a name given twice gets a number."""
    taken: dict[str, int] = {}
    for percept in percepts:
        name = track(percept)
        taken[name] = number = taken.get(name, 0) + 1
        yield replace(percept, name=name if number == 1 else f"{name} {number}")
