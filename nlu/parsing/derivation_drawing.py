# SPDX-License-Identifier: Apache-2.0
"""A derivation as a picture: the words on top, what they become below, the whole at the bottom."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from xml.sax.saxutils import escape

from .derivation import DerivationStep

LETTER = 6.6  # [px], the width of a letter of the monospaced font below
ROW = 46.0  # [px], from one level to the next
GAP = 18.0  # [px], between neighbours
MARGIN = 16.0  # [px]
MAX_TERM = 60  # letters of a lambda term that are shown; the whole is in the tooltip

_STYLE = (
    "text{font:11px monospace;text-anchor:middle;fill:#222}"
    ".word{font-weight:bold;font-size:13px}.term{fill:#666}.rule{fill:#a33}"
    "line{stroke:#888;stroke-width:1}"
)


@dataclass(frozen=True)
class _Box:
    """A step with its place: `left` and `width` in [px], `level` counted from the words."""

    step: DerivationStep
    left: float
    width: float
    level: int
    parts: tuple[_Box, ...]

    def __iter__(self) -> Iterator[_Box]:
        yield self
        for part in self.parts:
            yield from part


def svg_of(step: DerivationStep) -> str:
    """The derivation as an SVG document."""
    root = _box(step, MARGIN)
    width, height = root.width + 2 * MARGIN, (root.level + 2) * ROW
    drawn = "\n".join(line for box in root for line in _drawn(box))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}">\n<title>{escape(step.words)}</title>\n'
        f'<style>{_STYLE}</style>\n<rect width="100%" height="100%" fill="white"/>\n'
        f"{drawn}\n</svg>\n"
    )


def _box(step: DerivationStep, left: float) -> _Box:
    parts: list[_Box] = []
    for part in step.parts:
        start = parts[-1].left + parts[-1].width + GAP if parts else left
        parts.append(_box(part, start))
    below = parts[-1].left + parts[-1].width - left if parts else 0.0
    own = LETTER * max(len(step.words) * 1.2 if not parts else 0, *map(len, _texts(step)))
    level = max((part.level for part in parts), default=-1) + 1
    return _Box(step, left, max(own, below), level, tuple(parts))


def _texts(step: DerivationStep) -> tuple[str, str]:
    term = step.term if len(step.term) <= MAX_TERM else f"{step.term[: MAX_TERM - 1]}…"
    return step.category, term


def _drawn(box: _Box) -> Iterator[str]:
    middle, top = box.left + box.width / 2, MARGIN + (box.level + 1) * ROW
    category, term = _texts(box.step)
    if not box.parts:
        yield _text("word", middle, top - 18, box.step.words)
    else:
        end = box.left + box.width
        yield f'<line x1="{box.left:.1f}" y1="{top - 12:.1f}" x2="{end:.1f}" y2="{top - 12:.1f}"/>'
        yield _text("rule", end, top - 16, _mark(box.step.rule))
    yield _text("category", middle, top, category)
    yield _text("term", middle, top + 13, term, title=box.step.term)


def _mark(rule: str) -> str:
    """The sign of the rule; a change of category shows in its result."""
    return rule if len(rule) <= 2 else "⇒"


def _text(kind: str, x: float, y: float, text: str, *, title: str = "") -> str:
    hint = f"<title>{escape(title)}</title>" if title else ""
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}">{hint}{escape(text)}</text>'
