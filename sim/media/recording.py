"""Recordings of a world: GIF or MP4 animations, or some moments side by side in a PNG.

A `WorldRecorder` takes a picture of a world at regular intervals while its `with` block runs; the
suffix of the file names the format. A world that is not recorded has no cost of it.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from ...ontology.errors import MissingExtraError
from ..physics.engine import TIME_STEP
from ..poses import Array
from ..robot.path_planner import Grasp
from ..scene.world import World
from ..vision.camera import Camera
from . import pictures
from .pictures import Pen, Picture

RECORDING_SUFFIXES = (".gif", ".mp4", ".png")
RECORDING_CAMERA = replace(pictures.OVERVIEW, width=480, height=360)
LIGHT = replace(pictures.PICTURE_LIGHT, shadow=False)  # shadows would double the rendering time
FRAME_RATE = 8  # [1/s] pictures of the recording
SPEED = 2.0  # seconds of the world in one second of the recording
SMOOTHING = 1.5  # smooth edges at half the cost of 2
LAST_FRAME_TIME = 1.2  # [s]
COLOURS = 256  # limit of the GIF format
STRIP_COLUMNS, STRIP_ROWS = 4, 2


class WorldRecorder:
    """Records a world into one file, .gif, .mp4 or .png."""

    def __init__(self, world: World, path: Path, *, camera: Camera = RECORDING_CAMERA) -> None:
        pictures.check_writable(path, RECORDING_SUFFIXES)
        if path.suffix.lower() == ".mp4" and not find_spec("imageio_ffmpeg"):
            raise MissingExtraError("sim", "imageio-ffmpeg")
        self.caption = ""  #: text below the pictures from now on; none when empty
        #: a body and the part of it that is highlighted from now on; None for nothing
        self.tint: tuple[str, str] | None = None
        #: drawn into the pictures from now on; see `draw_grasps`
        self.grasps: Mapping[Pen, Iterable[Grasp]] = {}
        self._world, self._path, self._camera = world, path, camera
        self._waiting = 0
        self._taken: list[tuple[Picture, str]] = []
        self._last: tuple[int, str] | None = None
        self._freezes: dict[int, int] = {}  # index of a picture -> how often it is shown

    def __enter__(self) -> "WorldRecorder":
        self._world.engine.watchers.append(self._watch)
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self._world.engine.watchers.remove(self._watch)
        if kind is None:
            if self._last != self._moment:
                self.take()
            self._write()

    @property
    def _moment(self) -> tuple[int, str]:
        return self._world.engine.steps, self.caption

    def _watch(self) -> None:
        if self._waiting == 0:
            self.take()
            self._waiting = round(SPEED / FRAME_RATE / TIME_STEP)  # steps
        self._waiting -= 1

    def take(self, at: Array | None = None) -> None:
        """Take one picture now, from near a place (3,) in the world [m] when it is given."""
        camera = self._camera
        if at is not None:
            camera = pictures.closeup(at, width=camera.width, height=camera.height)
        picture = pictures.take_picture(
            self._world.engine, camera, light=LIGHT, smoothing=SMOOTHING, tint=self.tint
        )
        if self.grasps:
            picture = pictures.draw_grasps(picture, camera, self.grasps)
        self._taken.append((picture, self.caption))
        self._last = self._moment

    def pause(self, seconds: float, at: Array | None = None) -> None:
        """Take a picture and freeze the recording on it, while no time passes in the world."""
        self._freezes[len(self._taken)] = max(1, round(seconds * FRAME_RATE))
        self.take(at)

    @property
    def pictures(self) -> list[Picture]:
        """The pictures taken so far, with captions, all of one size."""
        shown = enumerate(self._with_captions())
        return [each for i, each in shown for _ in range(self._freezes.get(i, 1))]

    def _with_captions(self) -> list[Picture]:
        broken = (pictures.wrap_caption(*each) for each in self._taken if each[1])
        if not (lines := max(map(len, broken), default=0)):
            return [picture for picture, _ in self._taken]
        return [pictures.add_caption(*each, lines=lines) for each in self._taken]

    def _write(self) -> None:
        if self._path.suffix.lower() == ".png":
            pictures.save_picture(strip(self._with_captions(), [*self._freezes]), self._path)
            return
        write = _write_gif if self._path.suffix.lower() == ".gif" else _write_mp4
        with pictures.reporting_write_errors(self._path):
            write(self.pictures, self._path)


def strip(pictures: Sequence[Picture], always: Sequence[int] = ()) -> Picture:
    """Return some pictures of one size in rows, evenly spaced in time, with those in `always`."""
    most = min(len(pictures), STRIP_COLUMNS * STRIP_ROWS)
    must = sorted(always)[:most]
    others = [index for index in range(len(pictures)) if index not in must]
    places = np.linspace(0, max(len(others) - 1, 0), most - len(must)).round().astype(int)
    chosen = [pictures[i] for i in sorted([*must, *(others[place] for place in places)])]
    columns = min(most, STRIP_COLUMNS)
    chosen += [np.full_like(chosen[0], 255)] * (-len(chosen) % columns)
    return np.vstack([np.hstack(chosen[i : i + columns]) for i in range(0, len(chosen), columns)])


def _write_gif(pictures: list[Picture], path: Path) -> None:
    # One palette for all pictures keeps the colours of still objects from flickering.
    palette = Image.fromarray(strip(pictures)).quantize(
        COLOURS, method=Image.Quantize.MAXCOVERAGE, kmeans=2
    )
    images = map(Image.fromarray, pictures)
    frames = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in images]
    durations = [round(1000 / FRAME_RATE)] * (len(frames) - 1) + [round(1000 * LAST_FRAME_TIME)]
    frames[0].save(
        path, save_all=True, append_images=frames[1:], duration=durations, loop=0, optimize=False
    )


def _write_mp4(pictures: list[Picture], path: Path) -> None:
    import imageio.v2 as imageio

    writer: Any = imageio.get_writer(path, fps=FRAME_RATE, macro_block_size=2)
    with writer:
        for picture in pictures + [pictures[-1]] * round(LAST_FRAME_TIME * FRAME_RATE):
            writer.append_data(picture)
