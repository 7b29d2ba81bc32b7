# SPDX-License-Identifier: Apache-2.0
"""Rendering: camera images of the bodies, and what is hidden or tinted in them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Generator, Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from ..poses import Array
from .bodies import Bodies
from .client import PhysicsClient
from .types import Image, Light

LINK_SHIFT = 24  # the mask packs body + ((link + 1) << 24) into one number


class Rendering:
    """Images of bodies.

    Args:
        client: the simulator.
        bodies: that are drawn.
    """

    def __init__(self, client: PhysicsClient, bodies: Bodies) -> None:
        self._client, self._bodies = client, bodies

    def render(
        self, view: Array, projection: Array, width: int, height: int, *, light: Light
    ) -> Image:
        """Render what a camera sees.

        Args:
            view: OpenGL view matrix, camera_from_world (4, 4).
            projection: OpenGL projection matrix (4, 4).
            width: of the image in pixels.
            height: of the image in pixels.
            light: of the scene.
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
        names = {
            number + ((index + 1) << LINK_SHIFT): self._bodies.link_name(number, index)
            for body in self._bodies.names
            for number, index in self._bodies.link_ids(body)
        }
        return Image(colour, depth, labels, names)

    @contextmanager
    def tinted(
        self, body: str, link: str, colour: Sequence[float], *, share: float = 0.6
    ) -> Generator[None]:
        """Tint a link inside this block.

        Args:
            body: whose link.
            link: which one.
            colour: red, green, blue in [0, 1].
            share: of the tint in the colour that is drawn, in [0, 1].
        """
        link_id = self._bodies.link_id(body, link)
        shapes = [shape for shape in self._shapes(body) if shape[:2] == link_id]
        tint = np.array([*colour[:3], 1.0])
        try:
            for number, index, shape, own in shapes:
                mixed = (1 - share) * np.array(own) + share * tint
                self._paint(number, index, shape, mixed.tolist())
            yield
        finally:
            for shape in shapes:
                self._paint(*shape)

    @contextmanager
    def hidden(
        self, bodies: Sequence[str], *, but: Collection[tuple[str, str]] = ()
    ) -> Generator[None]:
        """Leave some bodies out of images inside this block, which saves the time of drawing them.

        In a window they stay, or they would flicker there.

        Args:
            bodies: their names.
            but: body and link of those of their links that are drawn all the same.
        """
        kept = {self._bodies.link_id(body, link) for body, link in but}
        names = () if self._client.gui else bodies
        shapes = [s for name in names for s in self._shapes(name) if s[:2] not in kept]
        try:
            for number, link, index, colour in shapes:
                self._paint(number, link, index, (*colour[:3], 0.0))
            yield
        finally:
            for shape in shapes:
                self._paint(*shape)

    def visible_links(self, body: str) -> tuple[str, ...]:
        """The links of a body that have a visual shape."""
        shapes = self._shapes(body)
        return tuple(dict.fromkeys(self._bodies.link_name(*shape[:2])[1] for shape in shapes))

    def _shapes(self, body: str) -> Iterator[tuple[int, int, int, Sequence[float]]]:
        """The visual shapes of a body: its number, the link, index of the shape there, colour."""
        count = Counter[int]()
        for shape in self._client.call("getVisualShapeData", self._bodies.number(body)):
            yield shape[0], shape[1], count[shape[1]], shape[7]
            count[shape[1]] += 1

    def _paint(self, number: int, link: int, index: int, colour: Sequence[float]) -> None:
        self._client.call(
            "changeVisualShape", number, link, shapeIndex=index, rgbaColor=list(colour)
        )
