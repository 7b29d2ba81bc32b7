"""Rendering: camera images of the bodies, and what is hidden or tinted in them."""

from collections import Counter
from collections.abc import Callable, Collection, Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..poses import Array
from .bodies import Bodies
from .pybullet_client import PhysicsClient

TINT_SHARE = 0.6  # of the tint in the colour that is drawn
LINK_SHIFT = 24  # the mask packs body + ((link + 1) << 24) into one number


@dataclass(frozen=True)
class Lighting:
    """The lighting of an image; all amounts in [0, 1]."""

    direction: tuple[float, float, float] = (0.4, -0.6, 1.0)
    ambient: float = 0.55
    diffuse: float = 0.45
    specular: float = 0.12
    shadow: bool = False


@dataclass(frozen=True)
class VisualShape:
    """A visual shape of a link, as its URDF describes it.

    `size` has the edges of a box, the radius of a sphere, the length and radius of a cylinder or
    capsule [m], or the scale of a mesh.
    """

    link: str
    kind: str  # "sphere", "box", "cylinder", "mesh", "plane" or "capsule"
    size: tuple[float, float, float]
    file: Path  # of a mesh
    link_from_shape: Array  # (4, 4)
    colour: tuple[float, float, float, float]  # red, green, blue and opacity in [0, 1]


_KINDS = {2: "sphere", 3: "box", 4: "cylinder", 5: "mesh", 6: "plane", 7: "capsule"}
_Shape: TypeAlias = tuple[int, int, int, Sequence[float]]  # body, link, index there, colour
Rendered: TypeAlias = tuple[
    NDArray[np.uint8], NDArray[np.float32], NDArray[np.int32], Mapping[int, tuple[str, str]]
]


class Rendering:
    """Camera images of the bodies in one simulator."""

    def __init__(self, client: PhysicsClient, bodies: Bodies) -> None:
        self._client, self._bodies = client, bodies

    def render(
        self, view: Array, projection: Array, width: int, height: int, *, light: Lighting
    ) -> Rendered:
        """Return what a camera sees, in `width` times `height` pixels.

        These are red, green and blue of each pixel (height, width, 3), in 0..255; the OpenGL depth
        buffer (height, width), in [0, 1]; the label of each pixel (height, width); and the body and
        link of each label. Pixels that show nothing have a label without a name. The OpenGL
        matrices are (4, 4); `view` is camera_from_world.
        """
        raw = self._client.call(
            "getCameraImage",
            width,
            height,
            viewMatrix=view.T.ravel().tolist(),  # OpenGL stores columns
            projectionMatrix=projection.T.ravel().tolist(),
            lightDirection=light.direction,
            lightAmbientCoeff=light.ambient,
            lightDiffuseCoeff=light.diffuse,
            lightSpecularCoeff=light.specular,
            shadow=int(light.shadow),
            flags=self._client.constant("ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX"),
            renderer=self._client.constant("ER_TINY_RENDERER"),
        )
        colour = np.asarray(raw[2], dtype=np.uint8).reshape(height, width, 4)[..., :3]
        depth = np.asarray(raw[3], dtype=np.float32).reshape(height, width)
        labels = np.asarray(raw[4], dtype=np.int32).reshape(height, width)
        links = self._bodies.links.items()
        names = {body + ((link + 1) << LINK_SHIFT): name for (body, link), name in links}
        return colour, depth, labels, names

    @contextmanager
    def tinted(self, body: str, link: str, colour: Sequence[float]) -> Generator[None]:
        """Tint a link inside this block; red, green and blue of the colour are in [0, 1]."""
        link_id = self._bodies.link_id(body, link)
        shapes = [shape for shape in self._shapes(body) if shape[:2] == link_id]
        tint = TINT_SHARE * np.array([*colour[:3], 1.0])
        with self._painted(shapes, lambda own: ((1 - TINT_SHARE) * np.array(own) + tint).tolist()):
            yield

    @contextmanager
    def hidden(
        self, bodies: Sequence[str], *, but: Collection[tuple[str, str]] = ()
    ) -> Generator[None]:
        """Leave bodies out of images inside this block, which saves the time of drawing them.

        The pairs of body and link in `but` are drawn. In a window all stay, or they would flicker.
        """
        kept = {self._bodies.link_id(body, link) for body, link in but}
        names = () if self._client.gui else bodies
        shapes = [s for name in names for s in self._shapes(name) if s[:2] not in kept]
        with self._painted(shapes, lambda own: (*own[:3], 0.0)):
            yield

    @contextmanager
    def _painted(
        self, shapes: Sequence[_Shape], paint: Callable[[Sequence[float]], Sequence[float]]
    ) -> Generator[None]:
        try:
            for number, link, index, own in shapes:
                self._paint(number, link, index, paint(own))
            yield
        finally:
            for shape in shapes:
                self._paint(*shape)

    def visible_links(self, body: str) -> tuple[str, ...]:
        """The links of a body that have a visual shape."""
        shapes = self._shapes(body)
        return tuple(dict.fromkeys(self._bodies.links[shape[:2]][1] for shape in shapes))

    def visual_shapes(self, body: str) -> Iterator[VisualShape]:
        """Iterate over the visual shapes of a body."""
        for raw in self._visual_data(body):
            link, at = self._bodies.links[raw[:2]][1], self._bodies.world_pose(raw[5], raw[6])
            yield VisualShape(link, _KINDS[raw[2]], raw[3], Path(raw[4].decode()), at, raw[7])

    def _visual_data(self, body: str) -> Sequence[Any]:
        return self._client.call("getVisualShapeData", self._bodies.link_id(body)[0])

    def _shapes(self, body: str) -> Iterator[_Shape]:
        count = Counter[int]()
        for shape in self._visual_data(body):
            yield shape[0], shape[1], count[shape[1]], shape[7]
            count[shape[1]] += 1

    def _paint(self, number: int, link: int, index: int, colour: Sequence[float]) -> None:
        options = {"shapeIndex": index, "rgbaColor": list(colour)}
        self._client.call("changeVisualShape", number, link, **options)
