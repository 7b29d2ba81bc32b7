# SPDX-License-Identifier: Apache-2.0
"""Looks: what cameras see of bodies, and in which colours."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Generator, Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from ..poses import Array
from .bodies import Bodies
from .types import Image, Light

LINK_SHIFT = 24  # the mask packs body + ((link + 1) << 24) into one number


class Looks(Bodies):
    """Bodies as they are drawn."""

    def render(
        self, view: Array, projection: Array, width: int, height: int, *, light: Light
    ) -> Image:
        """What a camera sees.

        Args:
            view: OpenGL view matrix, camera_from_world (4, 4).
            projection: OpenGL projection matrix (4, 4).
            width: of the picture in pixels.
            height: of the picture in pixels.
            light: how it is lit.
        """
        raw = self._call(
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
            flags=self._p.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX,
            renderer=self._p.ER_TINY_RENDERER,
        )
        colour = np.asarray(raw[2], dtype=np.uint8).reshape(height, width, 4)[..., :3]
        depth = np.asarray(raw[3], dtype=np.float32).reshape(height, width)
        labels = np.asarray(raw[4], dtype=np.int32).reshape(height, width)
        return Image(colour, depth, labels, self._labels())

    def _labels(self) -> dict[int, tuple[str, str]]:
        return {
            body.number + ((index + 1) << LINK_SHIFT): (name, link)
            for name, body in self._bodies.items()
            for link, index in body.links.items()
        }

    def paint(self, body: str, link: str | None, colour: Sequence[float]) -> None:
        """Give a link one colour (red, green, blue, opacity in [0, 1]); all links when None."""
        for each in self.links(body) if link is None else (link,):
            self._call("changeVisualShape", *self._link(body, each), rgbaColor=list(colour))

    @contextmanager
    def tinted(
        self, body: str, link: str, colour: Sequence[float], *, share: float = 0.6
    ) -> Generator[None]:
        """Inside this block a link is tinted.

        Args:
            body: whose link.
            link: which one.
            colour: red, green, blue in [0, 1].
            share: of the tint in what is seen, in [0, 1].
        """
        number, index = self._link(body, link)
        shapes = [s for s in self._call("getVisualShapeData", number) if s[1] == index]
        own = [np.array(shape[7]) for shape in shapes]
        tint = np.array([*colour[:3], 1.0])
        try:
            self._recolour(number, index, [(1 - share) * each + share * tint for each in own])
            yield
        finally:
            self._recolour(number, index, own)

    @contextmanager
    def unseen(
        self, bodies: Sequence[str], *, but: Collection[tuple[str, str]] = ()
    ) -> Generator[None]:
        """Inside this block some bodies are not drawn, which saves the time of drawing them.

        In a window they stay, or they would flicker there.

        Args:
            bodies: their names.
            but: body and link of those of their links that are drawn all the same.
        """
        kept = {self._link(body, link) for body, link in but}
        shapes = [] if self.gui else [shape for name in bodies for shape in self._drawn(name)]
        shapes = [shape for shape in shapes if shape[:2] not in kept]
        try:
            for number, link, index, colour in shapes:
                self._paint_shape(number, link, index, (*colour[:3], 0.0))
            yield
        finally:
            for shape in shapes:
                self._paint_shape(*shape)

    def seen_links(self, body: str) -> tuple[str, ...]:
        """The links of a body of which there is something to be seen."""
        return tuple(dict.fromkeys(self._link_name(body, shape[1]) for shape in self._drawn(body)))

    def _drawn(self, name: str) -> Iterator[tuple[int, int, int, Sequence[float]]]:
        """What is drawn of a body: its number, the link, the shape's number there, its colour."""
        count = Counter[int]()
        for shape in self._call("getVisualShapeData", self._body(name).number):
            yield shape[0], shape[1], count[shape[1]], shape[7]
            count[shape[1]] += 1

    def _paint_shape(self, number: int, link: int, index: int, colour: Sequence[float]) -> None:
        self._call("changeVisualShape", number, link, shapeIndex=index, rgbaColor=list(colour))

    def _recolour(self, number: int, index: int, colours: Sequence[Array]) -> None:
        for shape, colour in enumerate(colours):
            self._paint_shape(number, index, shape, colour.tolist())
