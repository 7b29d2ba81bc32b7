# SPDX-License-Identifier: Apache-2.0
"""Values that the physics engine takes and returns: contacts, joints, light and images."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Contact:
    """Two links that touch.

    Attributes:
        body, link: the one that was asked for.
        other, other_link: the one that it touches.
        position: in the world [m].
        normal: from the other one towards this one, unit length.
        gap: distance of the surfaces; negative where they overlap [m].
        force: along the normal [N].
    """

    body: str
    link: str
    other: str
    other_link: str
    position: tuple[float, float, float]
    normal: tuple[float, float, float]
    gap: float
    force: float


@dataclass(frozen=True)
class JointInfo:
    """A joint of a body, as its URDF describes it.

    Attributes:
        name: of the joint.
        link: that it moves.
        parent: link that carries it.
        kind: "revolute", "prismatic", "fixed" or "other".
        limits: lowest and highest position [rad] or [m].
        speed: limit [rad/s] or [m/s].
        effort: limit [Nm] or [N].
        axis: in the frame of the joint.
    """

    name: str
    link: str
    parent: str
    kind: str
    limits: tuple[float, float]
    speed: float
    effort: float
    axis: tuple[float, float, float]


@dataclass(frozen=True)
class Light:
    """The lighting of an image; all amounts in [0, 1]."""

    direction: tuple[float, float, float] = (0.4, -0.6, 1.0)
    ambient: float = 0.55
    diffuse: float = 0.45
    specular: float = 0.12
    shadow: bool = False


@dataclass(frozen=True)
class Image:
    """A rendered image with depth and labels.

    Attributes:
        colour: (height, width, 3) uint8.
        depth: as in an OpenGL depth buffer, (height, width) float32 in [0, 1].
        labels: number of the body and link that each pixel shows, (height, width) int32.
        names: label -> (body, link); pixels of nothing have a label that is not in here.
    """

    colour: NDArray[np.uint8]
    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
    names: Mapping[int, tuple[str, str]]
