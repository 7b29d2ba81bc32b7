# SPDX-License-Identifier: Apache-2.0
"""Recordings: what happens in a world as an animation or a strip of pictures.

A `Recorder` watches a world while its `with` block runs and takes a picture every so often; the
ending of the file decides what becomes of them: GIF and MP4 move, PNG shows some moments side by
side. A world that nobody watches does not even ask whether it should take pictures.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from ...ontology.errors import MissingExtraError
from ..physics.engine import TIME_STEP
from ..poses import Array
from ..scene.world import World
from ..vision.camera import Camera
from .drawings import GraspMark, with_grasps
from .pictures import (
    OVERVIEW,
    PICTURE_LIGHT,
    Picture,
    broken_caption,
    captioned,
    closeup,
    refuse_unwritable,
    save_picture,
    take_picture,
    writing,
)

ENDINGS = (".gif", ".mp4", ".png")
RECORDING_CAMERA = replace(OVERVIEW, width=480, height=360)
LIGHT = replace(PICTURE_LIGHT, shadow=False)  # shadows would double the time of a picture
RATE = 8  # pictures a second of the recording
PACE = 2.0  # seconds of the world in one second of the recording
SMOOTHING = 1.5  # edges without teeth, for half the price of twice
HOLD = 1.2  # [s], how long an animation rests on its last picture
COLOURS = 256  # all that a GIF can hold
STRIP_COLUMNS, STRIP_ROWS = 4, 2


class Recorder:
    """Records a world into one file.

    Args:
        world: what is watched.
        path: the file; its ending is .gif, .mp4 or .png.
        camera: from where.
        rate: pictures a second of the recording.
        pace: how much faster than the world the recording runs.

    Attributes:
        caption: what stands below the pictures from now on; nothing when empty.
        tint: a body and the part of it that is pointed out from now on; None for nothing.
        grasps: what is drawn into the pictures from now on.
    """

    def __init__(
        self,
        world: World,
        path: Path,
        *,
        camera: Camera = RECORDING_CAMERA,
        rate: float = RATE,
        pace: float = PACE,
    ) -> None:
        refuse_unwritable(path, ENDINGS)
        _refuse_missing_encoder(path)
        self.caption = ""
        self.tint: tuple[str, str] | None = None
        self.grasps: Sequence[GraspMark] = ()
        self._world, self._path, self._camera, self._rate = world, path, camera, rate
        self._interval = max(1, round(pace / rate / TIME_STEP))  # steps
        self._waiting = 0
        self._taken: list[tuple[Picture, str]] = []
        self._last: tuple[int, str] | None = None
        self._rests: list[int] = []  # where it rests on one of them

    def __enter__(self) -> Recorder:
        self._world.watcher = self._watch
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._world.watcher = None
        if error is None:
            if self._last != self._moment:
                self.take()
            self._write()

    @property
    def _moment(self) -> tuple[int, str]:
        """The time in the world, and what is written about it."""
        return self._world.engine.steps, self.caption

    def _watch(self) -> None:
        if self._waiting == 0:
            self.take()
            self._waiting = self._interval
        self._waiting -= 1

    def take(self, at: Array | None = None) -> None:
        """Take one picture now; with a place (3,) in the world [m] a picture from near it."""
        camera = self._camera if at is None else self._near(at)
        picture = take_picture(
            self._world.engine, camera, light=LIGHT, smoothing=SMOOTHING, tint=self.tint
        )
        if self.grasps:
            picture = with_grasps(picture, camera, self.grasps)
        self._taken.append((picture, self.caption))
        self._last = self._moment

    def pause(self, seconds: float, at: Array | None = None) -> None:
        """Take a picture and let the recording rest on it, while no time passes in the world."""
        self._rests.append(len(self._taken))
        self.take(at)
        self._taken += self._taken[-1:] * (round(seconds * self._rate) - 1)

    def _near(self, at: Array) -> Camera:
        x, y, z = (float(each) for each in at)
        return closeup((x, y, z), width=self._camera.width, height=self._camera.height)

    @property
    def pictures(self) -> list[Picture]:
        """What has been taken so far, with captions, all of one size."""
        return _captioned(self._taken)

    def _strip(self) -> Picture:
        """Moments side by side, among them all on which the recording rests."""
        kept: list[tuple[Picture, str]] = []
        rests: list[int] = []
        for index, each in enumerate(self._taken):
            rests += [len(kept)] if index in self._rests else []
            kept += [each] if not kept or each is not kept[-1] else []
        return strip(_captioned(kept), rests)

    def _write(self) -> None:
        with writing(self._path):
            match self._path.suffix.lower():
                case ".png":
                    save_picture(self._strip(), self._path)
                case ".gif":
                    _write_gif(self.pictures, self._path, self._rate)
                case _:
                    _write_mp4(self.pictures, self._path, self._rate)


def _captioned(taken: Sequence[tuple[Picture, str]]) -> list[Picture]:
    lines = max((len(broken_caption(*each)) for each in taken if each[1]), default=0)
    if not lines:
        return [picture for picture, _ in taken]
    return [captioned(picture, text, lines=lines) for picture, text in taken]


def caption(
    *,
    utterance: str = "",
    node: str = "",
    constraint: str = "",
    interval: tuple[float, float] | None = None,
) -> str:
    """What to write below a picture of one moment.

    Args:
        utterance: what was said.
        node: where in the action tree this is, "pass/graspObject".
        constraint: what must be kept to, "knife by the blade".
        interval: how certain that is.

    >>> print(caption(utterance="Pass me the knife.", node="pass/findObject", constraint="knife",
    ...               interval=(0.9, 1.0)))
    "Pass me the knife."
    pass/findObject: knife [0.90, 1.00]
    """
    certain = f"[{interval[0]:.2f}, {interval[1]:.2f}]" if interval else ""
    kept = " ".join(filter(None, (constraint, certain)))
    moment = ": ".join(filter(None, (node, kept)))
    return "\n".join(filter(None, (f'"{utterance}"' if utterance else "", moment)))


def _refuse_missing_encoder(path: Path) -> None:
    if path.suffix.lower() == ".mp4" and not find_spec("imageio_ffmpeg"):
        raise MissingExtraError("sim", "imageio-ffmpeg")


def strip(pictures: Sequence[Picture], always: Sequence[int] = ()) -> Picture:
    """Some of the pictures, evenly spaced in time, row by row in one.

    Args:
        pictures: all of one size.
        always: which of them must be among these, as far as there is room.
    """
    most = min(len(pictures), STRIP_COLUMNS * STRIP_ROWS)
    must = sorted(always)[:most]
    others = [index for index in range(len(pictures)) if index not in must]
    places = np.linspace(0, max(len(others) - 1, 0), most - len(must)).round().astype(int)
    chosen = [pictures[i] for i in sorted([*must, *(others[place] for place in places)])]
    columns = min(most, STRIP_COLUMNS)
    blank = np.full_like(chosen[0], 255)
    chosen += [blank] * (-len(chosen) % columns)
    rows = [np.hstack(chosen[i : i + columns]) for i in range(0, len(chosen), columns)]
    return np.vstack(rows)


def _write_gif(pictures: list[Picture], path: Path, rate: float) -> None:
    from PIL import Image

    # One palette for all keeps still things still: their colours do not flicker.
    palette = Image.fromarray(strip(pictures)).quantize(
        COLOURS, method=Image.Quantize.MAXCOVERAGE, kmeans=2
    )
    frames = [
        Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE)
        for picture in pictures
    ]
    durations = [round(1000 / rate)] * (len(frames) - 1) + [round(1000 * HOLD)]
    frames[0].save(
        path, save_all=True, append_images=frames[1:], duration=durations, loop=0, optimize=False
    )


def _write_mp4(pictures: list[Picture], path: Path, rate: float) -> None:
    import imageio.v2 as imageio

    writer: Any = imageio.get_writer(path, fps=rate, macro_block_size=2)
    with writer:
        for picture in pictures + [pictures[-1]] * round(HOLD * rate):
            writer.append_data(picture)
