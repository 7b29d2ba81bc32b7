# SPDX-License-Identifier: Apache-2.0
"""Recognition: vision that has learned what things look like, without the simulator's mask.

What stands on the table is segmented by depth, each segment is named by one small network and its
points are shared out to parts by another. Both were trained on rendered views
(`examples/train_recognition.py`) and are kept in `recognition.npz`. The confidence of a percept is
the first network's, calibrated (of all percepts with 0.8, eight in ten are right), and less where
the thing looks like nothing that was learned.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from ...ontology.errors import DataError
from ...ontology.objects import ObjectType
from ..physics.engine import PhysicsEngine
from ..poses import Array
from .camera import Camera, CameraImage, cameras_round_table
from .classifier import Network
from .descriptors import describe, describe_points
from .detector import OBSTACLE_SPACING, thinned, with_noise
from .familiarity import Familiarity
from .noise import Noise
from .percept import PartPercept, Percept, visible_features
from .segmentation import TABLE_MARGIN, Segment, cube_numbers, segments

NETWORKS_FILE = Path(__file__).with_name("recognition.npz")
LEAST_PART = 12  # points; fewer are a slip of the part network
NOISE_MARGIN = 4.0  # standard deviations of depth noise that still are the table
SMOOTHING = 0.006  # [m], side of the cubes in which points agree on their part


@dataclass(frozen=True, eq=False)
class Recogniser:
    """The two networks, and what their outputs mean.

    Attributes:
        kinds: the types that segments are named by, in the order of the outputs.
        parts: (type, part) in the order of the outputs of the part network.
        things: names segments.
        points: names points, given the type.
        usual: what segments of each type usually look like.
    """

    kinds: tuple[str, ...]
    parts: tuple[tuple[str, str], ...]
    things: Network
    points: Network
    usual: Familiarity

    @classmethod
    def load(cls, path: Path = NETWORKS_FILE) -> Recogniser:
        """The networks of a file.

        Raises:
            DataError: the file cannot be read.
        """
        try:
            with np.load(path, allow_pickle=False) as kept:
                return cls(
                    tuple(str(kind) for kind in kept["kinds"]),
                    tuple(_pair(str(text)) for text in kept["parts"]),
                    Network.from_arrays(kept, "things"),
                    Network.from_arrays(kept, "points"),
                    Familiarity.from_arrays(kept, "usual"),
                )
        except (OSError, ValueError, KeyError) as error:
            raise DataError(f"cannot be read: {error}.", source=str(path)) from error

    def save(self, path: Path) -> None:
        """Keep the networks in a file."""
        np.savez_compressed(
            path,
            allow_pickle=False,
            kinds=np.array(self.kinds),
            parts=np.array(["/".join(pair) for pair in self.parts]),
            **self.things.as_arrays("things"),
            **self.points.as_arrays("points"),
            **self.usual.as_arrays("usual"),
        )

    def name(self, segment: Segment) -> tuple[str, float]:
        """What a segment is taken for, and how sure that is, in [0, 1]."""
        described = describe(segment)[None]
        shares = self.things.shares(described)[0]
        best = int(np.argmax(shares))
        familiar = self.usual.of(described, np.array([best]))[0]
        return self.kinds[best], float(shares[best] * familiar)

    def share_out(
        self, segment: Segment, kind: str, candidates: Sequence[tuple[str, str]]
    ) -> np.ndarray:
        """Which of some (type, part) each point of a segment belongs to (n,), as its index.

        Args:
            segment: its points.
            kind: what the segment is taken for.
            candidates: what can be there.
        """
        scores = self.points.scores(point_inputs(segment, self.kinds.index(kind), len(self.kinds)))
        columns = [self.parts.index(pair) for pair in candidates]
        return np.argmax(_agreed(segment.points, scores[:, columns]), axis=1)


def _pair(text: str) -> tuple[str, str]:
    kind, _, part = text.partition("/")
    return kind, part


def point_inputs(segment: Segment, kind: int, count: int) -> Array:
    """Descriptors of points with the type of their segment, one column a type (n, k + count)."""
    types = np.zeros((len(segment), count))
    types[:, kind] = 1.0
    return np.hstack([describe_points(segment), types])


def _agreed(points: Array, scores: Array) -> Array:
    """Scores (n, c) averaged over the points of each small cube: neighbours are mostly alike."""
    _, index = np.unique(cube_numbers(points, SMOOTHING), return_inverse=True)
    counts = np.bincount(index)
    sums = [np.bincount(index, weights=column) for column in scores.T]
    return np.column_stack(sums)[index] / counts[index, None]


@cache
def _recogniser() -> Recogniser:
    return Recogniser.load()


def _by_kind(percept: Percept) -> str:
    return percept.object


@dataclass(frozen=True)
class LearnedVision:
    """The eyes round the table, with what they have learned instead of a perfect detector.

    It is used as `Vision` is, and needs nothing of the world but pictures.

    Attributes:
        engine: where the world is.
        objects: the types there are, by name; only those that were learned are recognised.
        cameras: the eyes.
        noise: of which the cameras have the depth noise.
        track: gives a percept the name by which its thing is tracked; by what it is when left out.
        recogniser: what was learned; that of Hilt's own objects when left out.

    Raises:
        DataError: something was learned that is not among the types.
    """

    engine: PhysicsEngine
    objects: Mapping[str, ObjectType]
    cameras: tuple[Camera, ...] = field(default_factory=cameras_round_table)
    noise: Noise = field(default_factory=Noise)
    track: Callable[[Percept], str] = _by_kind
    recogniser: Recogniser = field(default_factory=_recogniser)

    def __post_init__(self) -> None:
        missing = [kind for kind in self.recogniser.kinds if kind not in self.objects]
        if missing:
            raise DataError(
                f"they know {', '.join(missing)}, which is not among the objects: name the file of "
                "those with --objects.",
                source="networks",
            )

    def look(self) -> tuple[CameraImage, ...]:
        """What all cameras see now."""
        views = (camera.look(self.engine) for camera in self.cameras)
        return with_noise(views, self.noise, self.engine.steps)

    def search(
        self, features: Iterable[str], *, views: Sequence[CameraImage] | None = None
    ) -> tuple[Percept, ...]:
        """The things in sight that seem to have one of the features, the surest first.

        Args:
            features: "object:knife", "part:blade", "property:sharp", ...; others are not visible.
            views: what to search in; a new look when None.
        """
        wanted = frozenset(features)
        found = self._segments(views)
        named = map(self.recogniser.name, found)
        percepts = [
            percept
            for segment, (kind, sure) in zip(found, named, strict=True)
            if any(wanted & visible_features(self.objects[each]) for each in self._in(kind))
            for percept in self._percepts(segment, kind, sure)
            if wanted & visible_features(self.objects[percept.object])
        ]
        ordered = sorted(percepts, key=lambda percept: -percept.confidence)
        return tuple(_told_apart(ordered, self.track))

    def obstacles(
        self, besides: str | None, *, views: Sequence[CameraImage] | None = None
    ) -> Array:
        """Points on all other things in sight (n, 3), in the world [m].

        Args:
            besides: name of the thing that is not in the way.
            views: what to search in; a new look when None.
        """
        features = [f"object:{kind}" for kind in self.objects]
        others = [p.cloud for p in self.search(features, views=views) if p.name != besides]
        return thinned(np.vstack([np.empty((0, 3)), *others]), OBSTACLE_SPACING)

    def _segments(self, views: Sequence[CameraImage] | None) -> tuple[Segment, ...]:
        seen = self.look() if views is None else views
        return segments(seen, margin=TABLE_MARGIN + NOISE_MARGIN * self.noise.depth_m)

    def _in(self, kind: str) -> tuple[str, ...]:
        """A type, and the types that may stand in it: they are one segment."""
        mounted = (
            name
            for name in self.recogniser.kinds
            if (mount := self.objects[name].mount) and mount.support == kind
        )
        return (kind, *mounted)

    def _percepts(self, segment: Segment, kind: str, sure: float) -> Iterator[Percept]:
        """What a segment shows: a thing of that type, and what stands in it."""
        candidates = [(each, part) for each in self._in(kind) for part in self.objects[each].parts]
        parts = self.recogniser.share_out(segment, kind, candidates)
        for each in self._in(kind):
            seen = {
                part: PartPercept(part, segment.points[parts == i], int((parts == i).sum()))
                for i, (owner, part) in enumerate(candidates)
                if owner == each and (parts == i).sum() >= LEAST_PART
            }
            if seen:
                yield Percept(each, each, sure, seen, self.objects[each].properties)


def _told_apart(percepts: Sequence[Percept], track: Callable[[Percept], str]) -> Iterator[Percept]:
    """The percepts under the names of what they show; a name given twice gets a number."""
    taken: dict[str, int] = {}
    for percept in percepts:
        name = track(percept)
        taken[name] = number = taken.get(name, 0) + 1
        name = name if number == 1 else f"{name} {number}"
        yield Percept(name, percept.object, percept.confidence, percept.parts, percept.properties)
