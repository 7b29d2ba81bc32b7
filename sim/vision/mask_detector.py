"""Object detection with the simulator's segmentation mask, as a perfect detector would give it.

An object is searched for only when one of the requested features names its type, one of its parts
or one of its properties. The confidence of a percept follows from the share of the expected
silhouette that is visible. Known depth noise is removed before by fitting planes to each part.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...ontology.objects import ObjectType
from ..models.object_models import ObjectModel
from ..physics.engine import PhysicsEngine
from ..poses import Array
from .camera import CAMERAS_ROUND_TABLE, Camera, CameraImage
from .percept import PartPercept, Percept, visible_features
from .perception_noise import NoiseLevels, with_depth_noise
from .point_cloud_operations import voxel_downsample
from .region_of_interest import RegionRenderer

FULL_CONFIDENCE = 0.95  # in a fully visible object; even that may be a good likeness
FULL_SIGHT = 0.75  # share of the expected silhouette that counts as all: views differ that much
MIN_PIXELS = 40  # fewer pixels are not reported as an object
CLOUD_SPACING = 0.0012  # [m], voxel size of the clouds of percepts
OBSTACLE_SPACING = 0.004  # [m], voxel size of the cloud of obstacles

SMOOTHING_HALF = 2  # pixels to each side of the window that a plane is fitted to
EDGE_FACTOR = 1.5  # times the noise; depths farther from their plane than that lie at an edge
_RIDGE = 0.1  # [pixel^2], keeps the plane level where the pixels lie in one line


@dataclass(frozen=True)
class MaskDetector:
    """Detects objects in the images of the cameras round the table by their mask.

    Attributes:
        kinds: name of each object that may be visible -> its type.
        models: type -> its model, for the silhouette to be expected.
        noise: only its depth noise is used here; see `NoisyDetector` for the rest.
        room: bodies that hide nothing. When given, only the region of interest is rendered.
    """

    engine: PhysicsEngine
    kinds: Mapping[str, ObjectType]
    models: Mapping[str, ObjectModel]
    cameras: tuple[Camera, ...] = CAMERAS_ROUND_TABLE
    noise: NoiseLevels = field(default_factory=NoiseLevels)
    room: tuple[str, ...] = ()

    def capture(self) -> tuple[CameraImage, ...]:
        """Take one image with each camera."""
        if self.room:
            region = RegionRenderer.around(self.kinds, self.engine, room=self.room)
            images = [region.capture(camera) for camera in self.cameras]
        else:
            images = [camera.capture(self.engine) for camera in self.cameras]
        noisy = with_camera_noise(images, self.noise, self.engine.steps)
        return tuple(self._smooth(image) for image in noisy) if self.noise.depth_m else noisy

    def _smooth(self, image: CameraImage) -> CameraImage:
        labels = [label for label, (name, _) in image.names.items() if name in self.kinds]
        depth = smooth_depth(image.depth, image.labels, labels, noise=self.noise.depth_m)
        return replace(image, depth=depth)

    def search(
        self, features: Iterable[str], *, images: Sequence[CameraImage] | None = None
    ) -> tuple[Percept, ...]:
        """Return the visible objects that have one of the features, most confident first.

        Features are "object:knife", "part:blade", "property:sharp", ...; others are not visible.
        New images are taken when none are given.
        """
        wanted = frozenset(features)
        names = [name for name, kind in self.kinds.items() if wanted & visible_features(kind)]
        if not names:
            return ()
        images = self.capture() if images is None else images
        found = (
            perceive(images, name, self.kinds[name], self.models[self.kinds[name].name].silhouette)
            for name in names
        )
        percepts = [percept for percept in found if percept is not None]
        return tuple(sorted(percepts, key=lambda percept: -percept.confidence))

    def obstacles(
        self, exclude: str | None, *, images: Sequence[CameraImage] | None = None
    ) -> Array:
        """Return points (n, 3) on all visible objects but `exclude`, in the world [m]."""
        images = self.capture() if images is None else images
        others = [name for name in self.kinds if name != exclude]
        clouds = [image.points(image.mask(name)) for image in images for name in others]
        cloud = np.vstack([np.empty((0, 3)), *clouds])
        return cloud[voxel_downsample(cloud, OBSTACLE_SPACING)]


def with_camera_noise(
    images: Iterable[CameraImage], noise: NoiseLevels, step: int
) -> tuple[CameraImage, ...]:
    """Return images with the depth noise of the cameras at a time step."""
    return tuple(
        replace(image, depth=with_depth_noise(image.depth, noise, image.camera.name, step))
        for image in images
    )


def perceive(
    images: Sequence[CameraImage], name: str, kind: ObjectType, silhouette: float
) -> Percept | None:
    """Return what the images of one moment show of one object; None below `MIN_PIXELS`.

    `silhouette` is the area that the object usually shows to a camera [m^2].
    """
    parts = [_perceive_part(images, name, part) for part in kind.parts]
    if sum(part.pixels for part in parts) < MIN_PIXELS:
        return None
    visible = {part.name: part for part in parts if part.pixels}
    share = max(_silhouette(image, name) for image in images) / silhouette
    confidence = FULL_CONFIDENCE * min(1.0, share / FULL_SIGHT)
    return Percept(name, kind.name, confidence, visible, kind.properties)


def _perceive_part(images: Sequence[CameraImage], name: str, part: str) -> PartPercept:
    clouds = [image.points(image.mask(name, part)) for image in images]
    cloud = np.vstack([np.empty((0, 3)), *clouds])
    return PartPercept(part, cloud[voxel_downsample(cloud, CLOUD_SPACING)], len(cloud))


def _silhouette(image: CameraImage, name: str) -> float:
    """The area of an object's silhouette in an image, at the distance of the object [m^2]."""
    depths = image.depth[image.mask(name)].astype(np.float64)
    return float(((depths / image.camera.focal) ** 2).sum())


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
        rows, columns = np.nonzero(labels == label)
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
    shape = (int(y.max()) + 1, int(x.max()) + 1)
    middle, size = depth.mean(), 2 * SMOOTHING_HALF + 1

    def near(values: Array) -> Array:
        """The sum of values (n,) over the window round each pixel."""
        image = np.zeros(shape)
        image[y, x] = values
        return size**2 * uniform_filter(image, size, mode="constant")[y, x]

    z = depth - middle
    n, sx, sy, sz = (near(each) for each in (np.ones(len(x)), x, y, z))
    sxx, sxy, syy = near(x * x), near(x * y), near(y * y)
    sxz, syz = near(x * z), near(y * z)
    # Covariances about the mean of the window, which is not always at the pixel itself.
    xx, yy = sxx - sx * sx / n + _RIDGE, syy - sy * sy / n + _RIDGE
    xy, xz, yz = sxy - sx * sy / n, sxz - sx * sz / n, syz - sy * sz / n
    determinant = xx * yy - xy * xy
    along_x = (xz * yy - yz * xy) / determinant
    along_y = (yz * xx - xz * xy) / determinant
    spread = near(z * z) - sz * sz / n - along_x * xz - along_y * yz
    error = np.sqrt(np.maximum(spread, 0.0) / n)
    return middle + sz / n + along_x * (x - sx / n) + along_y * (y - sy / n), error
