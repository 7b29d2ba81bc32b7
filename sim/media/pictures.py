# SPDX-License-Identifier: Apache-2.0
"""Pictures for people: the scene in good light, before a plain warm wall.

Rendered at twice the size and reduced (Lanczos), which smooths all edges. Where the simulator sees
nothing there is a soft gradient instead of its white. The boards and the grain of the table are
laid over its plain colour afterwards, computed from the place in the world behind each pixel: as a
texture in the simulator they would slow every look of the robot. A part can be tinted, and words
written below; what is drawn into a picture is in `drawings`.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from functools import lru_cache, partial
from math import radians
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...ontology.errors import DataError, MissingExtraError
from ..physics.engine import PhysicsEngine
from ..physics.types import Light
from ..poses import Array
from ..vision.camera import Camera

Picture = NDArray[np.uint8]

ENDINGS = (".png", ".jpg", ".jpeg")
PICTURE_LIGHT = Light(direction=(0.5, -0.9, 1.6), shadow=True)
SUPERSAMPLING = 2.0
TABLE_TOP = ("table", "top")
CAPTION_PAPER, CAPTION_INK = (252, 250, 246), (52, 44, 38)
BOARD_WIDTH = 0.16  # [m]
SEAM = 0.0018  # [m], half the width of the dark line between two boards
TINT = (0.10, 0.45, 1.0)  # red, green, blue of a part that is pointed out
WALL_TOP, WALL_BOTTOM = (250, 247, 242), (232, 224, 213)  # warm white

OVERVIEW = Camera("overview", (1.60, -1.02, 0.86), (0.34, 0.0, 0.26), radians(41), 960, 720)


def closeup(target: tuple[float, float, float], *, width: int = 960, height: int = 720) -> Camera:
    """A camera that looks at a point on the table from near [m]."""
    x, y, z = target
    return Camera("closeup", (x + 0.42, y - 0.40, z + 0.34), target, radians(36), width, height)


def take_picture(
    engine: PhysicsEngine,
    camera: Camera = OVERVIEW,
    *,
    light: Light = PICTURE_LIGHT,
    smoothing: float = SUPERSAMPLING,
    tint: tuple[str, str] | None = None,
) -> Picture:
    """A picture of the world as it is now, (height, width, 3).

    Args:
        engine: where the world is.
        camera: from where.
        light: how it is lit.
        smoothing: how many times as large it is rendered; 1 is fastest and has jagged edges.
        tint: a body and the part of it that is pointed out.
    """
    large = replace(
        camera, width=round(camera.width * smoothing), height=round(camera.height * smoothing)
    )
    with engine.rendering.tinted(*tint, TINT) if tint else nullcontext():
        view = large.capture(engine, light=light)
    picture = view.colour.copy()
    if TABLE_TOP[0] in engine.bodies.names:
        table = view.mask(*TABLE_TOP)
        shades = _boards(large)[table] * picture[table]
        picture[table] = np.minimum(shades, 255).astype(np.uint8)
    background = ~np.isin(view.labels, np.fromiter(view.names, dtype=np.int32))
    picture[background] = _wall(large)[background]
    return picture if smoothing == 1 else _reduced(picture, camera)


@lru_cache(maxsize=4)
def _boards(camera: Camera) -> NDArray[np.float32]:
    """How much darker or lighter the table is where each pixel meets it, (height, width, 3)."""
    height, width = camera.height, camera.width
    columns, rows = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    ahead = np.full(columns.shape, -camera.focal)
    rays = np.stack([columns - width / 2, height / 2 - rows, ahead], axis=-1)
    rays = rays @ camera.world_from_camera[:3, :3].T
    down = np.minimum(rays[..., 2], -1e-3)  # rays that never come down are not of the table
    far = (-camera.eye[2] / down)[..., None]
    places = np.array(camera.eye[:2]) + far * rays[..., :2]
    return _grain(places).astype(np.float32)


def _grain(places: Array) -> Array:
    """How much darker or lighter wood is at places (..., 2) of the table, (..., 3) factors."""
    x, y = places[..., 0], places[..., 1]
    board = np.floor(y / BOARD_WIDTH)
    across = y / BOARD_WIDTH - board
    tone = np.sin(board * 12.9898) * 43758.5453 % 1.0  # one number in [0, 1] a board
    # Rings of a trunk cut lengthwise: lines along the board that wander slowly.
    wander = 0.35 * np.sin(3.1 * x + 40 * tone) + 0.15 * np.sin(7.7 * x + 90 * tone)
    rings = np.sin(2 * np.pi * (across * 5 + wander + 9 * tone))
    fibre = np.sin(900 * y + 25 * np.sin(5 * x + 60 * tone)) * np.sin(31 * x + 500 * y)
    seam = np.clip(np.minimum(across, 1 - across) * BOARD_WIDTH / SEAM, 0, 1)
    light = (0.93 + 0.12 * tone + 0.025 * rings + 0.012 * fibre) * (0.72 + 0.28 * seam)
    return light[..., None] ** np.array([0.8, 1.0, 1.25])  # dark wood is redder


@lru_cache(maxsize=4)
def _wall(camera: Camera) -> Picture:
    share = np.linspace(0, 1, camera.height)[:, None, None]
    shades = (1 - share) * np.array(WALL_TOP) + share * np.array(WALL_BOTTOM)
    return np.broadcast_to(shades.astype(np.uint8), (camera.height, camera.width, 3))


def _reduced(picture: Picture, camera: Camera) -> Picture:
    image = pillow().fromarray(picture)
    return np.asarray(image.resize((camera.width, camera.height), pillow().Resampling.LANCZOS))


def refuse_unwritable(path: Path, endings: Sequence[str] = ENDINGS) -> None:
    """Tell at once that a file cannot be written, before anything is done for it.

    Raises:
        DataError: the ending of the path names none of these formats, or its folder takes no file.
    """
    if path.suffix.lower() not in endings:
        raise DataError(f"expected a file ending in {', '.join(endings)}.", source=str(path))
    with writing(path):
        is_new = not path.exists()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.open("ab").close()
        if is_new:
            path.unlink()


@contextmanager
def writing(path: Path) -> Generator[None]:
    """What goes wrong while a file is written in the block, as a `DataError`."""
    try:
        yield
    except OSError as error:
        problem = error.strerror or str(error)
        raise DataError(f"cannot be written: {problem}.", source=str(path)) from error


def save_picture(picture: Picture, path: Path) -> None:
    """Write a picture; the ending of the path names the format (PNG, JPEG, ...).

    Raises:
        DataError: it cannot be written.
    """
    with writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        pillow().fromarray(picture).save(path)


def captioned(picture: Picture, text: str, *, lines: int = 0) -> Picture:
    """The picture with a text below it.

    Args:
        picture: (height, width, 3).
        text: what to write; broken into lines at its line ends, and where it is too long.
        lines: how many lines there is room for; as many as the text needs when 0.
    """
    height, width = picture.shape[:2]
    size = caption_size(picture)
    broken = broken_caption(picture, text)
    bar = round(size * (1.35 * (lines or len(broken)) + 0.8))
    image = pillow().new("RGB", (width, height + bar), CAPTION_PAPER)
    image.paste(pillow().fromarray(picture), (0, 0))
    draw, font = _drawing(image, size)
    for number, line in enumerate(broken):
        draw.text((size, height + size * (0.3 + 1.35 * number)), line, font=font, fill=CAPTION_INK)
    return np.asarray(image)


def caption_size(picture: Picture) -> int:
    """The height of the letters below a picture, in pixels."""
    return max(12, round(picture.shape[0] / 25))


def broken_caption(picture: Picture, text: str) -> list[str]:
    """A text in lines that fit below a picture."""
    size = caption_size(picture)
    draw, font = _drawing(pillow().new("RGB", (1, 1)), size)
    length = partial(draw.textlength, font=font)
    return _wrapped(text, length, picture.shape[1] - 2 * size)


def _drawing(image: Any, size: int) -> tuple[Any, Any]:
    from PIL import ImageDraw, ImageFont

    return ImageDraw.Draw(image), ImageFont.load_default(size)


def _wrapped(text: str, length: Callable[[str], float], width: float) -> list[str]:
    """The text in lines that are no longer than `width`, in pixels."""
    lines: list[str] = []
    for paragraph in text.splitlines() or [""]:
        lines.append("")
        for word in paragraph.split():
            longer = f"{lines[-1]} {word}".strip()
            if length(longer) <= width or not lines[-1]:
                lines[-1] = longer
            else:
                lines.append(word)
    return lines


def pillow() -> ModuleType:
    """The image library.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        from PIL import Image
    except ImportError as error:
        raise MissingExtraError("sim", "pillow") from error
    return Image
