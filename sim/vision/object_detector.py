"""Object detection in the images of cameras, and with the simulator's segmentation mask.

A detector sees a world through cameras. What it sees is searched by features ("object:knife",
"part:blade", "property:sharp"; others are not visible).

`MaskDetector` is a perfect detector. The confidence of its percepts follows from the share of the
expected silhouette that is visible. Known depth noise is removed before by fitting planes to each
part. Most of the time of an image is the robot's. So the objects are drawn first, without room and
robot. Where links of the robot may be before them, by their bounding boxes, the image is drawn
again with these: the pixels that show objects are those of an image of everything.
"""

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...ontology.objects import ObjectType
from ..physics.engine import PhysicsEngine
from ..poses import Array, voxel_downsample
from ..scene.scene import ROOM
from ..scene.world import World
from .camera import CAMERAS_ROUND_TABLE, Camera, CameraImage
from .percept import Percept, visible_features
from .perception_noise import NoiseLevels, with_depth_noise, without_mixed_pixels

OBSTACLE_SPACING = 0.004  # [m], voxel size of the cloud of obstacles
FULL_CONFIDENCE = 0.95  # in a fully visible object; even that may be a good likeness
FULL_SIGHT = 0.8  # share of the expected silhouette that counts as all: views differ that much
MIN_PIXELS = 40  # fewer pixels are not reported as an object
CLOUD_SPACING = 0.0012  # [m], voxel size of the clouds of percepts

BULGE = 0.02  # [m] that the visual shape of a link may exceed its collision shape
_CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])  # of a box

SMOOTHING_HALF = 2  # pixels to each side of the window that a plane is fitted to
EDGE_FACTOR = 1.5  # times the noise; depths farther from their plane than that lie at an edge
_RIDGE = 0.1  # [pixel^2], keeps the plane level where the pixels lie in one line


@dataclass(eq=False)
class ObjectDetector(ABC):
    """Detects the objects of a world; new images are taken only after time has passed in it.

    Of the noise only that of depths is used here; see `NoisyDetector` for the rest.
    """

    world: World
    noise: NoiseLevels = field(default_factory=NoiseLevels)
    cameras: Sequence[Camera] = CAMERAS_ROUND_TABLE
    _seen: tuple[int, tuple[Percept, ...]] = field(default=(-1, ()), init=False)  # with the step

    @property
    def kinds(self) -> Mapping[str, ObjectType]:
        """The types of objects that it knows, by name."""
        return self.world.objects

    @abstractmethod
    def detect(self, images: Sequence[CameraImage]) -> Iterable[Percept]:
        """Return the objects that images of one moment show."""

    def capture(self, cameras: Sequence[Camera] | None = None) -> tuple[CameraImage, ...]:
        """Take one image with each camera, or with some, with its depth noise."""
        kinds, seen = self.world.kinds.items(), list[CameraImage]()
        parts = {(name, part.name): part for name, kind in kinds for part in kind.parts.values()}
        for image in self._render(cameras or self.cameras):
            shown = ((label, parts.get(link)) for label, link in image.names.items())
            shine = {label: part.material.shine for label, part in shown if part}
            seen.append(with_depth_noise(image, self.noise, self.world.engine.steps, shine))
        return tuple(map(without_mixed_pixels, seen) if self.noise.camera else seen)

    def _render(self, cameras: Sequence[Camera]) -> Iterable[CameraImage]:
        return (camera.capture(self.world.engine) for camera in cameras)

    @property
    def percepts(self) -> tuple[Percept, ...]:
        """All objects in view, most confident first."""
        step, seen = self._seen
        if step != self.world.engine.steps:
            found = self.detect(self.capture())
            seen = tuple(sorted(found, key=lambda percept: -percept.confidence))
            self._seen = self.world.engine.steps, seen
        return seen

    def search(self, features: Iterable[str]) -> tuple[Percept, ...]:
        """Return the objects in view that have one of the features, most confident first."""
        wanted = frozenset(features)
        kinds = {name for name, kind in self.kinds.items() if wanted & visible_features(kind)}
        return tuple(percept for percept in self.percepts if percept.object in kinds)

    def find(self, name: str) -> Percept | None:
        """The percept of an object of the world; None when it is not visible."""
        return next((p for p in self.percepts if p.name == name in self.world.kinds), None)

    def look(self, expected: Percept) -> Percept | None:
        """An object as the first two cameras, which is faster, see it now; None if they do not.

        `expected` is the object where it should be.
        """
        found = self.detect(self.capture(self.cameras[:2]))
        return next((percept for percept in found if percept.name == expected.name), None)

    def obstacles(self, exclude: str) -> Array:
        """Return points (n, 3) on all objects in view but `exclude`, in the world [m]."""
        clouds = [percept.cloud for percept in self.percepts if percept.name != exclude]
        cloud = np.vstack([np.empty((0, 3)), *clouds])
        return cloud[voxel_downsample(cloud, OBSTACLE_SPACING)]


class MaskDetector(ObjectDetector):
    """Detects objects by their mask, in images of them alone."""

    def _render(self, cameras: Sequence[Camera]) -> Iterable[CameraImage]:
        return capture_objects(self.world.engine, self.world.kinds, cameras)

    def capture(self, cameras: Sequence[Camera] | None = None) -> tuple[CameraImage, ...]:
        """Take one image with each camera, or with some, and smooth depths that have noise."""
        images, noise = super().capture(cameras), self.noise.depth_error
        if not noise:
            return images
        smooth: list[CameraImage] = []
        for image in images:
            wanted = [label for label, link in image.names.items() if link[0] in self.world.kinds]
            depth = smooth_depth(image.depth, image.labels, wanted, noise=noise)
            smooth.append(replace(image, depth=depth))
        return tuple(smooth)

    def detect(self, images: Sequence[CameraImage]) -> Iterator[Percept]:
        """Return the objects that images of one moment show with at least `MIN_PIXELS`."""
        surfaces = [_surfaces(image, self.world.kinds) for image in images]
        for name, kind in self.world.kinds.items():
            own = [(name, part) for part in kind.parts]
            seen = [{link[1]: each[link] for link in own if link in each} for each in surfaces]
            areas = [sum(area for _, area in each.values()) for each in seen]
            shown = [part for part in kind.parts if any(part in each for each in seen)]
            clouds = {p: np.vstack([each[p][0] for each in seen if p in each]) for p in shown}
            if sum(map(len, clouds.values())) >= MIN_PIXELS:
                share = max(areas) / self.world.models[kind.name].silhouette
                confidence = FULL_CONFIDENCE * min(1.0, share / FULL_SIGHT)
                parts = {p: c[voxel_downsample(c, CLOUD_SPACING)] for p, c in clouds.items()}
                yield Percept(name, kind.name, confidence, parts, kind.properties)


def _surfaces(
    image: CameraImage, objects: Collection[str]
) -> dict[tuple[str, str], tuple[Array, float]]:
    mask = np.isin(image.labels, [n for n, (name, _) in image.names.items() if name in objects])
    points, labels = image.points(mask), image.labels[mask]
    areas = (image.depth[mask].astype(np.float64) / image.camera.intrinsics[0]) ** 2
    found: dict[tuple[str, str], tuple[Array, float]] = {}
    for label in np.unique(labels):
        own, area = points[labels == label], areas[labels == label]
        is_known = np.isfinite(area)
        if is_known.any():  # the others are seen all the same, though not how far away
            area = float(np.nansum(area) * len(area) / np.count_nonzero(is_known))
            found[image.names[label]] = own[is_known], area
    return found


def capture_objects(
    engine: PhysicsEngine, objects: Collection[str], cameras: Sequence[Camera]
) -> Iterator[CameraImage]:
    """Take an image of some bodies with each camera; those of the room cannot hide anything."""
    hidden = tuple(name for name in engine.bodies.names if name not in objects)
    robot = [body for body in hidden if body not in ROOM]
    links = [(body, link) for body in robot for link in engine.rendering.visible_links(body)]
    ends = [np.add(engine.bodies.bounds(*each), [[-BULGE], [BULGE]]) for each in links]
    boxes = np.array(ends).reshape(-1, 2, 3)[:, _CORNERS, [0, 1, 2]]
    for camera in cameras:
        with engine.rendering.hidden(hidden):
            image = camera.capture(engine)
        if occluders := [links[index] for index in _occluders(image, boxes)]:
            with engine.rendering.hidden(hidden, but=occluders):
                image = camera.capture(engine)
        yield image


def _occluders(image: CameraImage, boxes: Array) -> np.ndarray:
    shown = np.nonzero(image.labels >= 0)
    if not len(shown[0]):
        return np.zeros(0, dtype=int)
    camera, corners = image.camera, boxes.reshape(-1, 3)
    depths = ((camera.eye - corners) @ camera.world_from_camera[:3, 2]).reshape(-1, 8)
    near = depths.min(axis=1) <= image.depth[shown].max()
    pixels = camera.pixels(corners).reshape(-1, 8, 2)
    first, last = ([each(axis) for axis in reversed(shown)] for each in (np.min, np.max))
    # Behind the camera pixels are NaN and no comparison holds, so that the link is kept.
    outside = (pixels.max(axis=1) < first) | (pixels.min(axis=1) > np.add(last, 1))
    return np.flatnonzero(near & ~outside.any(axis=1))


def smooth_depth(
    depth: NDArray[np.float32], labels: NDArray[np.int32], wanted: Iterable[int], *, noise: float
) -> NDArray[np.float32]:
    """Return a depth image (height, width) [m] smoothed by local least squares planes.

    A mean would do as well in the middle of a face, but would bend an oblique face at its rim.
    5 x 5 pixels reduce noise of 2 mm to 0.4 mm, at a rim to 0.7 mm. Pixels without a wanted label
    are unchanged, and so are those whose surroundings deviate from a plane much more than `noise`,
    the standard deviation of depths [m]: there a part occludes itself, as the rim of a mug does.
    """
    result = depth.copy()
    for label in wanted:
        rows, columns = np.nonzero((labels == label) & np.isfinite(depth))
        if len(rows):
            measured = depth[rows, columns].astype(float)
            fitted, error = _fit_planes(measured, rows, columns)
            result[rows, columns] = np.where(error < EDGE_FACTOR * noise, fitted, measured)
    return result


def _fit_planes(depth: Array, rows: np.ndarray, columns: np.ndarray) -> tuple[Array, Array]:
    """Fit a plane to the pixels round each of n pixels.

    Returns its depth (n,) at that pixel, and the root mean square distance from it (n,) [m].
    """
    from scipy.ndimage import uniform_filter  # here: images without noise save its import

    y, x = rows - rows.min(), columns - columns.min()
    middle, size = depth.mean(), 2 * SMOOTHING_HALF + 1

    def near(values: Array) -> Array:
        """The sums (n, ...) of values (n, ...) over the window round each pixel."""
        image = np.zeros((int(y.max()) + 1, int(x.max()) + 1, *values.shape[1:]))
        image[y, x] = values
        return size**2 * uniform_filter(image, size, mode="constant", axes=(0, 1))[y, x]

    z, terms = depth - middle, np.column_stack([np.ones(len(x)), x, y])
    # The normal equations of the plane z = a + b x + c y in each window.
    squares = near(terms[:, :, None] * terms[:, None]) + np.diag([0, _RIDGE, _RIDGE])
    products = near(terms * z[:, None])
    plane = np.linalg.solve(squares, products[..., None])[..., 0]
    spread = near(z * z) - (plane * products).sum(axis=1)
    return middle + (plane * terms).sum(axis=1), np.sqrt(np.maximum(spread, 0.0) / squares[:, 0, 0])
