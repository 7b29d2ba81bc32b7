"""Seeded perception noise: missed and confused objects, lower confidence, noisy depths.

Section 4.1 of the paper measures without sensor noise and attributes further errors in the world to
it. An object is misperceived in the same way in every search of a run, so that a seed gives the
same run. Depth noise is drawn anew for every image.

The errors of a stereo depth camera follow those of an Intel RealSense D435 (data sheet, and "Best
known methods for tuning Intel RealSense depth cameras"): they arise in the disparity, in pixels, so
that those of the depth grow with its square, in steps; pixels at edges show something between both
surfaces, or nothing; and what shines, as glass and steel do, has holes.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from zlib import crc32

import numpy as np

from ...ontology.errors import DataError
from ...ontology.objects import ObjectType
from ..poses import Array
from .camera import CameraImage
from .percept import Percept, visible_features

# The largest amounts; no camera has depth noise of 5 cm.
_MAX = {"missed": 1.0, "confused": 1.0, "confidence": 1.0, "depth_m": 0.05, "camera": 2.0}

BASELINE = 0.05  # [m], between the two eyes of the camera
SUBPIXEL, STEPS = 0.08, 32  # [pixels], standard deviation of the disparity; its steps in a pixel
CAMERA_ERROR = 0.0025  # [m], of a depth of 0.9 m: depth^2 SUBPIXEL / (focal length * BASELINE)
EDGE, BACKGROUND = 0.02, 0.3  # [m], least jump of depth at an edge; the most that is mixed in there
MIXED, LOST = 0.3, 0.3  # shares of the pixels at edges
PATCH, HOLES = 4, 0.002  # [pixels], size of a hole; their share where nothing shines


@dataclass(frozen=True)
class NoiseLevels:
    """The amounts of perception noise.

    >>> NoiseLevels.parse("missed=0.1,confused=0.05", seed=7)
    NoiseLevels(missed=0.1, confused=0.05, confidence=0.0, depth_m=0.0, camera=0.0, seed=7)
    """

    missed: float = 0.0  #: probability that an object is not detected
    confused: float = 0.0  #: probability that an object is detected as another type
    confidence: float = 0.0  #: largest share of its confidence that a percept loses, in [0, 1]
    depth_m: float = 0.0  #: standard deviation of each pixel's depth [m]
    camera: float = 0.0  #: errors of a stereo camera; 1 for those of a RealSense D435, at most 2
    seed: int = 0

    def __post_init__(self) -> None:
        for name, high in _MAX.items():
            value: float = getattr(self, name)
            if not 0 <= value <= high:
                problem = f"{name} must be in [0, {high:g}], found {value:g}."
                raise DataError(problem, source="noise")

    @property
    def depth_error(self) -> float:
        """The standard deviation of depths where objects are [m]."""
        return float(np.hypot(self.depth_m, CAMERA_ERROR * self.camera))

    @classmethod
    def parse(cls, text: str, *, seed: int = 0) -> "NoiseLevels":
        """Read `--noise`, such as "missed=0.1,confused=0.05"; `DataError` where it is wrong."""
        values: dict[str, float] = {}
        for item in filter(None, (piece.strip() for piece in text.split(","))):
            name, _, number = item.partition("=")
            if name not in _MAX:
                problem = f'expected one of {", ".join(_MAX)}, found "{name}".'
                raise DataError(problem, source="--noise")
            try:
                values[name] = float(number)
            except ValueError:
                problem = f'expected a number after "{name}=", found "{number}".'
                raise DataError(problem, source="--noise") from None
        return cls(**values, seed=seed)

    def generator(self, name: str, *numbers: int) -> np.random.Generator:
        """The random generator for one name, independent of all others."""
        return np.random.default_rng([self.seed, crc32(name.encode()), *numbers])


@dataclass(frozen=True)
class NoisyDetector:
    """A detector with noise: it misses and confuses objects, and lowers their confidence.

    A confused object is found by the features of the type it is taken for, not by its own. So all
    `objects`, the types by name, have to be searched for when they can be confused. The depth noise
    is that of the detector's cameras. Nothing is taken for a kind that was shown.
    """

    detect: Callable[[Sequence[str]], Sequence[Percept]]  #: the detector's `search`
    noise: NoiseLevels
    objects: Mapping[str, ObjectType]

    def search(self, features: Sequence[str]) -> tuple[Percept, ...]:
        """Return the objects that seem to have one of the features, most confident first."""
        others = self.objects if features and self.noise.confused else ()
        searched = [*features, *(f"object:{name}" for name in others)]
        noisy = (self._misperceived(percept) for percept in self.detect(searched))
        wanted = frozenset(features)
        known = {name: visible_features(kind) for name, kind in self.objects.items()}
        found = (p for p in noisy if p and wanted & known.get(p.object, wanted))
        return tuple(sorted(found, key=lambda percept: -percept.confidence))

    def _misperceived(self, percept: Percept) -> Percept | None:
        miss, confuse, loss, which = self.noise.generator(percept.name).random(4)
        if miss < self.noise.missed:
            return None
        others = [k for k in self.objects.values() if k.graspable and k.name != percept.object]
        if confuse < self.noise.confused and others:
            percept = relabelled(percept, others[int(which * len(others))])
        return replace(percept, confidence=percept.confidence * (1 - loss * self.noise.confidence))


def relabelled(percept: Percept, kind: ObjectType) -> Percept:
    """Return a percept with the type, part names and properties of another type."""
    parts = dict(zip(kind.parts, percept.parts.values(), strict=False))
    return replace(percept, object=kind.name, parts=parts, properties=kind.properties)


def with_depth_noise(
    image: CameraImage, noise: NoiseLevels, step: int, shine: Mapping[int, float]
) -> CameraImage:
    """Return an image with the noise of a step, NaN where lost; `shine` of labels is in [0, 1]."""
    if not noise.depth_error:
        return image
    random = noise.generator(image.camera.name, step)
    depth = image.depth + random.normal(0.0, noise.depth_m, image.depth.shape)
    if noise.camera:
        holes, focal = np.full(depth.shape, HOLES), image.camera.intrinsics[0]
        for label, value in shine.items():
            holes[image.labels == label] = value**2
        depth = _with_stereo_errors(depth, holes, noise.camera, focal, random)
    return replace(image, depth=depth.astype(np.float32))


def _with_stereo_errors(
    depth: Array, holes: Array, amount: float, focal: float, random: np.random.Generator
) -> Array:
    from scipy.ndimage import maximum_filter, minimum_filter  # here: without noise not needed

    near, far = minimum_filter(depth, 3), maximum_filter(depth, 3)
    scale, where = focal * BASELINE * STEPS, random.random(depth.shape)
    disparity = scale / depth + random.normal(0.0, SUBPIXEL * STEPS * amount, depth.shape)
    mixed = near + np.minimum(far - near, BACKGROUND) * random.random(depth.shape)
    is_edge = far - near > EDGE
    rows, columns = (np.arange(size) // PATCH for size in depth.shape)
    patches = random.random((rows[-1] + 1, columns[-1] + 1))[np.ix_(rows, columns)]
    is_lost = (patches < amount * holes) | (is_edge & (where > 1 - LOST * amount))
    measured = scale / np.maximum(np.round(disparity), 1)
    return np.where(is_lost, np.nan, np.where(is_edge & (where < MIXED * amount), mixed, measured))


def without_mixed_pixels(image: CameraImage) -> CameraImage:
    """Return an image without the depths at edges, which may be those of no surface."""
    from scipy.ndimage import maximum_filter, minimum_filter

    far = maximum_filter(np.nan_to_num(image.depth, nan=-np.inf), 3)
    near = minimum_filter(np.nan_to_num(image.depth, nan=np.inf), 3)
    return replace(image, depth=np.where(far - near > EDGE, np.float32(np.nan), image.depth))
