# SPDX-License-Identifier: Apache-2.0
"""Drawings: what is laid over a picture, at the places in the world where it belongs.

Grasps are drawn as small hands: two fingers, what joins them, and the way they come. Those that
were ruled out are thin and red, good ones green, the one that was taken thick. Names are written
on little cards above what they name.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from .. import poses
from ..poses import Array
from ..vision.camera import Camera
from .pictures import CAPTION_INK, CAPTION_PAPER, Picture, pillow

FINGER, STEM = 0.035, 0.075  # [m], from the tips back to the palm and to the end of the wrist
REJECTED, ACCEPTED, CHOSEN = (205, 40, 30, 130), (20, 150, 80, 220), (0, 110, 50, 255)
FINENESS = 2  # drawn so many times as large, then reduced: lines without teeth
CARD_LIFT = 0.03  # [m], of a card above what it names
CARD_PAD = 4 * FINENESS  # pixels of the finer picture round a name

Card: TypeAlias = tuple[float, float, float, float]  # left, top, right, bottom in pixels


@dataclass(frozen=True, eq=False)
class GraspMark:
    """A grasp to be drawn.

    Attributes:
        world_from_grip: (4, 4), origin between the pads, y along the closing, z ahead.
        opening: between the fingers [m].
        accepted: whether it was good enough.
        chosen: whether it is the one that was taken.
    """

    world_from_grip: Array
    opening: float
    accepted: bool
    chosen: bool = False


def with_grasps(picture: Picture, camera: Camera, marks: Sequence[GraspMark]) -> Picture:
    """A picture with grasps drawn into it.

    Args:
        picture: what the camera showed (height, width, 3).
        camera: from where.
        marks: the grasps; the good ones come to lie over the others.
    """
    size = max(1, round(picture.shape[0] / 360))
    overlay, draw = _sheet(picture)
    for mark in sorted(marks, key=lambda mark: (mark.chosen, mark.accepted)):
        colour = CHOSEN if mark.chosen else ACCEPTED if mark.accepted else REJECTED
        width = round(FINENESS * size * (3 if mark.chosen else 1.2))
        for line in _hand(mark):
            at = camera.pixels(line) * FINENESS
            if np.isfinite(at).all():
                draw.line([tuple(point) for point in at], fill=colour, width=width, joint="curve")
    return _laid_over(picture, overlay)


def _hand(mark: GraspMark) -> tuple[Array, Array]:
    """The fingers with the palm, and the wrist, as lines of points (n, 3) [m]."""
    half = mark.opening / 2
    fingers = np.array([[0, -half, 0], [0, -half, -FINGER], [0, half, -FINGER], [0, half, 0]])
    wrist = np.array([[0, 0, -FINGER], [0, 0, -STEM]])
    return (
        poses.transform(mark.world_from_grip, fingers),
        poses.transform(mark.world_from_grip, wrist),
    )


def with_names(picture: Picture, camera: Camera, places: Mapping[str, Array]) -> Picture:
    """A picture with names written above places.

    Args:
        picture: what the camera showed (height, width, 3).
        camera: from where.
        places: name -> the place (3,) in the world [m].
    """
    from PIL import ImageFont

    overlay, draw = _sheet(picture)
    font: Any = ImageFont.load_default(max(11, picture.shape[0] // 42) * FINENESS)
    cards: list[Card] = []
    for name, (at, foot) in _ends(camera, places):
        card = _free_card(draw.textbbox(tuple(at), name, font=font, anchor="mb"), cards)
        cards.append(card)
        middle, bottom = (card[0] + card[2]) / 2, card[3]
        draw.line([(middle, bottom), tuple(foot)], fill=(*CAPTION_INK, 150), width=FINENESS)
        draw.rounded_rectangle(card, CARD_PAD, fill=(*CAPTION_PAPER, 225))
        draw.text(
            (middle, bottom - CARD_PAD), name, font=font, anchor="mb", fill=(*CAPTION_INK, 255)
        )
    return _laid_over(picture, overlay)


def _ends(camera: Camera, places: Mapping[str, Array]) -> Iterable[tuple[str, tuple[Array, Array]]]:
    """Where each card and its foot are in the finer picture, the nearest first."""
    for name in sorted(places, key=lambda name: float(np.linalg.norm(places[name] - camera.eye))):
        ends = np.array([places[name] + (0, 0, CARD_LIFT), places[name]])
        card, foot = camera.pixels(ends) * FINENESS
        if np.isfinite([card, foot]).all():
            yield name, (card, foot)


def _free_card(text: Card, others: Sequence[Card]) -> Card:
    """A card round a text (left, top, right, bottom), moved up until it covers no other."""
    left, top, right, bottom = text
    card = (left - CARD_PAD, top - CARD_PAD, right + CARD_PAD, bottom + CARD_PAD)
    while blocking := [other for other in others if _overlap(card, other)]:
        up = card[3] - min(other[1] for other in blocking) + FINENESS
        card = (card[0], card[1] - up, card[2], card[3] - up)
    return card


def _overlap(one: Card, other: Card) -> bool:
    across = one[0] < other[2] and other[0] < one[2]
    return across and one[1] < other[3] and other[1] < one[3]


def _sheet(picture: Picture) -> tuple[Any, Any]:
    from PIL import ImageDraw

    height, width = picture.shape[:2]
    sheet = pillow().new("RGBA", (width * FINENESS, height * FINENESS), (0, 0, 0, 0))
    return sheet, ImageDraw.Draw(sheet, "RGBA")


def _laid_over(picture: Picture, sheet: Any) -> Picture:
    height, width = picture.shape[:2]
    small = sheet.resize((width, height), pillow().Resampling.LANCZOS)
    base = pillow().fromarray(picture).convert("RGBA")
    return np.asarray(pillow().alpha_composite(base, small).convert("RGB"))
