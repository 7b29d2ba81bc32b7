"""Pictures of a scene for people: rendering, tints, drawn grasps, name labels and captions.

A picture is rendered at twice the size and reduced (Lanczos), which smooths all edges, and a soft
gradient replaces the white background. Grasps are drawn as small hands: two fingers, what joins
them, and the wrist; rejected ones thin and red, accepted ones green, the chosen one thick.
"""

from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from math import radians
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import translate

from ...ontology.errors import DataError, extra_required
from .. import poses
from ..physics.engine import PhysicsEngine
from ..physics.rendering import Lighting
from ..poses import Array
from ..robot.path_planner import Grasp
from ..vision.camera import Camera

with extra_required("sim", "pillow"):
    from PIL import Image, ImageDraw, ImageFont

Picture = NDArray[np.uint8]

PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg")
PICTURE_LIGHT = Lighting(direction=(0.5, -0.9, 1.6), shadow=True)
SUPERSAMPLING = 2.0
CAPTION_BACKGROUND, CAPTION_COLOUR = (252, 250, 246), (52, 44, 38)
TINT = (0.10, 0.45, 1.0)  # red, green, blue of a highlighted part
WALL_TOP, WALL_BOTTOM = (250, 247, 242), (232, 224, 213)  # warm white

FINGER, STEM = 0.035, 0.075  # [m], from the tips back to the palm and to the end of the wrist
OVERSAMPLING = 2  # drawn so many times as large, then reduced: lines without teeth
LABEL_LIFT = 0.03  # [m], of a label above what it names
LABEL_PAD = 4 * OVERSAMPLING  # pixels of the finer picture round a name


class Pen(NamedTuple):
    """How lines are drawn: red, green, blue and opacity in 0..255, and a relative width."""

    colour: tuple[int, int, int, int]
    width: float


REJECTED, ACCEPTED = Pen((205, 40, 30, 130), 1.2), Pen((20, 150, 80, 220), 1.2)
CHOSEN = Pen((0, 110, 50, 255), 3.0)


OVERVIEW = Camera("overview", (1.60, -1.02, 0.86), (0.34, 0.0, 0.26), radians(41), 960, 720)


def closeup(target: Array, *, width: int = 960, height: int = 720) -> Camera:
    """Return a camera that looks at a point (3,) on the table from near [m]."""
    x, y, z = target.tolist()
    return Camera("closeup", (x + 0.42, y - 0.40, z + 0.34), (x, y, z), radians(36), width, height)


def take_picture(
    engine: PhysicsEngine,
    camera: Camera = OVERVIEW,
    *,
    light: Lighting = PICTURE_LIGHT,
    smoothing: float = SUPERSAMPLING,
    tint: tuple[str, str] | None = None,
) -> Picture:
    """Return a picture of the world as it is now, (height, width, 3).

    It is rendered `smoothing` times as large; 1 is fastest and has jagged edges. `tint` is a body
    and the part of it that is highlighted.
    """
    large = replace(
        camera, width=round(camera.width * smoothing), height=round(camera.height * smoothing)
    )
    with engine.rendering.tinted(*tint, TINT) if tint else nullcontext():
        view = large.capture(engine, light=light)
    picture = view.colour.copy()
    background = ~np.isin(view.labels, np.fromiter(view.names, dtype=np.int32))
    share = np.linspace(0, 1, large.height)[:, None]
    shades = ((1 - share) * WALL_TOP + share * WALL_BOTTOM).astype(np.uint8)
    picture[background] = shades[np.nonzero(background)[0]]
    size, lanczos = (camera.width, camera.height), Image.Resampling.LANCZOS
    return picture if smoothing == 1 else np.asarray(Image.fromarray(picture).resize(size, lanczos))


def check_writable(path: Path, suffixes: Sequence[str] = PICTURE_SUFFIXES) -> None:
    """Check that a file with one of these suffixes can be written; otherwise a `DataError`."""
    if path.suffix.lower() not in suffixes:
        raise DataError(f"expected a file ending in {', '.join(suffixes)}.", source=str(path))
    with reporting_write_errors(path):
        is_new = not path.exists()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.open("ab").close()
        if is_new:
            path.unlink()


@contextmanager
def reporting_write_errors(path: Path) -> Generator[None]:
    """Raise an OSError in this block as a `DataError` about the file."""
    try:
        yield
    except OSError as error:
        problem = error.strerror or str(error)
        raise DataError(f"cannot be written: {problem}.", source=str(path)) from error


def save_picture(picture: Picture, path: Path) -> None:
    """Write a picture in the format of the suffix (PNG, JPEG, ...); `DataError` if it cannot."""
    with reporting_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(picture).save(path)


def add_caption(picture: Picture, text: str, *, lines: int = 0) -> Picture:
    """Return the picture with a text below it, broken, with room for `lines`, or all with 0."""
    height, width = picture.shape[:2]
    size = caption_size(picture)
    broken = wrap_caption(picture, text)
    bar = round(size * (1.35 * (lines or len(broken)) + 0.8))
    image = Image.new("RGB", (width, height + bar), CAPTION_BACKGROUND)
    image.paste(Image.fromarray(picture), (0, 0))
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(size)
    for number, line in enumerate(broken):
        place = (size, height + size * (0.3 + 1.35 * number))
        draw.text(place, line, font=font, fill=CAPTION_COLOUR)
    return np.asarray(image)


def caption_size(picture: Picture) -> int:
    """Return the height of the letters below a picture, in pixels."""
    return max(12, round(picture.shape[0] / 25))


def wrap_caption(picture: Picture, text: str) -> list[str]:
    """Return a text in lines that fit below a picture."""
    size = caption_size(picture)
    font: Any = ImageFont.load_default(size)
    width = picture.shape[1] - 2 * size
    lines: list[str] = []
    for paragraph in text.splitlines() or [""]:
        lines.append("")
        for word in paragraph.split():
            longer = f"{lines[-1]} {word}".strip()
            if font.getlength(longer) <= width or not lines[-1]:
                lines[-1] = longer
            else:
                lines.append(word)
    return lines


def draw_grasps(picture: Picture, camera: Camera, grasps: Mapping[Pen, Iterable[Grasp]]) -> Picture:
    """Return a picture that a camera took with grasps drawn into it, one pen over the other."""
    size = max(1, round(picture.shape[0] / 360))
    overlay, draw = _overlay(picture)
    for pen, grasp in ((pen, grasp) for pen, some in grasps.items() for grasp in some):
        width = round(OVERSAMPLING * size * pen.width)
        half = grasp.opening / 2
        fingers = [[0, -half, 0], [0, -half, -FINGER], [0, half, -FINGER], [0, half, 0]]
        for line in (fingers, [[0, 0, -FINGER], [0, 0, -STEM]]):  # which the palm joins, the wrist
            at = camera.pixels(poses.transform(grasp.world_from_grip, np.array(line)))
            at *= OVERSAMPLING
            if np.isfinite(at).all():
                corners = [tuple(point) for point in at]
                draw.line(corners, fill=pen.colour, width=width, joint="curve")
    return _composited(picture, overlay)


def draw_names(picture: Picture, camera: Camera, places: Mapping[str, Array]) -> Picture:
    """Return a picture that a camera took with names above their places (3,) in the world [m]."""
    overlay, draw = _overlay(picture)
    font: Any = ImageFont.load_default(max(11, picture.shape[0] // 42) * OVERSAMPLING)
    taken: Any = shapely.Polygon()
    for name in sorted(places, key=lambda name: float(np.linalg.norm(places[name] - camera.eye))):
        ends = camera.pixels(np.array([places[name] + (0, 0, LABEL_LIFT), places[name]]))
        if not np.isfinite(ends).all():
            continue
        at, foot = map(tuple, ends * OVERSAMPLING)
        text = shapely.box(*draw.textbbox(at, name, font=font, anchor="mb"))
        label: Any = text.buffer(LABEL_PAD, join_style="mitre")
        while label.intersects(taken):
            label = translate(label, yoff=-OVERSAMPLING)
        taken = taken.union(label)
        middle, bottom = label.centroid.x, label.bounds[3]
        draw.line([(middle, bottom), foot], fill=(*CAPTION_COLOUR, 150), width=OVERSAMPLING)
        draw.rounded_rectangle(label.bounds, LABEL_PAD, fill=(*CAPTION_BACKGROUND, 225))
        place, colour = (middle, bottom - LABEL_PAD), (*CAPTION_COLOUR, 255)
        draw.text(place, name, font=font, anchor="mb", fill=colour)
    return _composited(picture, overlay)


def _overlay(picture: Picture) -> tuple[Any, Any]:
    height, width = picture.shape[:2]
    sheet = Image.new("RGBA", (width * OVERSAMPLING, height * OVERSAMPLING), (0, 0, 0, 0))
    return sheet, ImageDraw.Draw(sheet, "RGBA")


def _composited(picture: Picture, sheet: Any) -> Picture:
    height, width = picture.shape[:2]
    small = sheet.resize((width, height), Image.Resampling.LANCZOS)
    base = Image.fromarray(picture).convert("RGBA")
    return np.asarray(Image.alpha_composite(base, small).convert("RGB"))
