# SPDX-License-Identifier: Apache-2.0
"""Pictures for people: the scene in good light, before a plain warm wall.

Rendered at twice the size and reduced (Lanczos), which smooths all edges. Where the simulator sees
nothing there is a soft gradient instead of its white. The boards and the grain of the table are
laid over its plain colour afterwards, computed from the place in the world behind each pixel: as a
texture in the simulator they would slow every look of the robot.
"""

from __future__ import annotations

from dataclasses import replace
from math import radians
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from ..ontology.errors import MissingExtraError
from .camera import Camera
from .engine import Engine
from .poses import Array
from .readings import Light

Picture = NDArray[np.uint8]

PICTURE_LIGHT = Light(direction=(0.5, -0.9, 1.6), shadow=True)
SUPERSAMPLING = 2
TABLE_TOP = ("table", "top")
BOARD_WIDTH = 0.16  # [m]
SEAM = 0.0018  # [m], half the width of the dark line between two boards
WALL_TOP, WALL_BOTTOM = (250, 247, 242), (232, 224, 213)  # warm white

OVERVIEW = Camera("overview", (1.62, -1.0, 0.86), (0.32, 0.0, 0.24), radians(38), 960, 720)


def closeup(target: tuple[float, float, float], *, width: int = 960, height: int = 720) -> Camera:
    """A camera that looks at a point on the table from near [m]."""
    x, y, z = target
    return Camera("closeup", (x + 0.42, y - 0.40, z + 0.34), target, radians(36), width, height)


def take_picture(
    engine: Engine,
    camera: Camera = OVERVIEW,
    *,
    light: Light = PICTURE_LIGHT,
    smooth: bool = True,
    wood: tuple[str, str] = TABLE_TOP,
) -> Picture:
    """A picture of the world as it is now, (height, width, 3).

    Args:
        engine: where the world is.
        camera: from where.
        light: how it is lit.
        smooth: whether to supersample, at four times the cost.
        wood: the body and link that is drawn as boards.
    """
    factor = SUPERSAMPLING if smooth else 1
    large = replace(camera, width=camera.width * factor, height=camera.height * factor)
    view = large.look(engine, light=light)
    known = np.fromiter(view.names, dtype=np.int32)
    shown = np.isin(view.labels, known)
    picture = np.where(shown[..., None], view.colour, _wall(large))
    table = view.mask(*wood) if wood[0] in engine.bodies else np.zeros_like(shown)
    picture[table] *= _grain(view.points(table)[:, :2])
    picture = np.clip(picture, 0, 255).astype(np.uint8)
    return _reduced(picture, camera) if smooth else picture


def _grain(places: Array) -> Array:
    """How much darker or lighter wood is at places (n, 2) of the table, (n, 3) factors."""
    x, y = places.T
    board = np.floor(y / BOARD_WIDTH)
    across = y / BOARD_WIDTH - board
    tone = np.sin(board * 12.9898) * 43758.5453 % 1.0  # one number in [0, 1] a board
    # Rings of a trunk cut lengthwise: lines along the board that wander slowly.
    wander = 0.35 * np.sin(3.1 * x + 40 * tone) + 0.15 * np.sin(7.7 * x + 90 * tone)
    rings = np.sin(2 * np.pi * (across * 5 + wander + 9 * tone))
    fibre = np.sin(900 * y + 25 * np.sin(5 * x + 60 * tone)) * np.sin(31 * x + 500 * y)
    seam = np.clip(np.minimum(across, 1 - across) * BOARD_WIDTH / SEAM, 0, 1)
    light = (0.93 + 0.12 * tone + 0.025 * rings + 0.012 * fibre) * (0.72 + 0.28 * seam)
    return light[:, None] ** np.array([0.8, 1.0, 1.25])  # dark wood is redder


def _wall(camera: Camera) -> NDArray[np.float64]:
    share = np.linspace(0, 1, camera.height)[:, None, None]
    return (1 - share) * np.array(WALL_TOP) + share * np.array(WALL_BOTTOM)


def _reduced(picture: Picture, camera: Camera) -> Picture:
    image = _pillow().fromarray(picture)
    return np.asarray(image.resize((camera.width, camera.height), _pillow().Resampling.LANCZOS))


def save_picture(picture: Picture, path: Path) -> None:
    """Write a picture; the ending of the path names the format (PNG, JPEG, ...)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    _pillow().fromarray(picture).save(path)


def _pillow() -> ModuleType:
    try:
        from PIL import Image
    except ImportError as error:
        raise MissingExtraError("sim", "pillow") from error
    return Image
