"""Derivation trees for people: as indented text, as JSON and as an SVG drawing.

Every step shows its words, its category and its lambda term in normal form.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from io import StringIO
from typing import NamedTuple

from ...ontology.errors import extra_required
from ..grammar.combinators import BinaryRule
from ..grammar.terms import quote
from ..lexicon.lexicon import Entry
from .chart import Derivation

MAX_TERM = 60
"""A longer lambda term is cut off in the drawing [characters]."""

_COLUMN, _ROW = 0.09, 0.64  # [inch], the width of a character and the height of a level


@dataclass(frozen=True)
class DerivationStep:
    """One step of a derivation; `str()` gives it and all steps below it as indented text.

    Attributes:
        term: the lambda term of its span, in normal form.
        rule: `>`, `<`, `>B`, `<B`, a unary rule, or empty for a word.
    """

    words: str
    category: str
    term: str
    rule: str
    parts: tuple[DerivationStep, ...]

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self, depth: int = 0) -> Iterator[str]:
        """One line for each step, parents before children, indented by depth."""
        mark = f'"{self.words}"' if not self.parts else self.rule
        yield f"{'  ' * depth}{self.category} : {self.term}    {mark}"
        for part in self.parts:
            yield from part.lines(depth + 1)

    def as_json(self) -> dict[str, object]:
        """The tree as a JSON object."""
        return {**vars(self), "parts": [part.as_json() for part in self.parts]}


def derivation_step(derivation: Derivation, words: tuple[str, ...]) -> DerivationStep:
    """Return the root step of a derivation of the words of an utterance."""
    rule = derivation.rule
    shown = rule.value if isinstance(rule, BinaryRule) else str(rule)
    return DerivationStep(
        " ".join(words[derivation.start : derivation.end]),
        str(derivation.category),
        str(quote(derivation.value)),
        "" if isinstance(rule, Entry) else shown,
        tuple(derivation_step(part, words) for part in derivation.parts),
    )


def subderivations(derivation: Derivation) -> Iterator[Derivation]:
    """The derivation and all that it consists of, from the root down and from left to right."""
    yield derivation
    for part in derivation.parts:
        yield from subderivations(part)


def lexical_entries(derivation: Derivation) -> list[Entry]:
    """Return the lexical entries that a derivation uses, from left to right."""
    rules = (each.rule for each in subderivations(derivation))
    return [rule for rule in rules if isinstance(rule, Entry)]


def draw_svg(step: DerivationStep) -> str:
    """Return the derivation as SVG, the root at the bottom; `MissingExtraError` says the extra."""
    with extra_required("report", "matplotlib"):
        from matplotlib import rc_context
        from matplotlib.figure import Figure
    root = _box(step, 0)
    figure = Figure(figsize=(_COLUMN * (root.width + 4), _ROW * (root.level + 2)))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(-2, root.width + 2), ylim=(root.level + 1.5, -0.5))
    axes.set_axis_off()
    for box in root.boxes():
        middle, bottom = box.left + box.width / 2, box.level + 0.5
        lines = [box.step.category, _shortened(box.step.term)]
        if box.step.parts:
            axes.plot([box.left, box.left + box.width], [box.level, box.level], "gray", lw=1)
            # The result shows what a unary rule, whose name is long, has changed.
            sign = box.step.rule if len(box.step.rule) <= 2 else "⇒"
            axes.text(box.left + box.width, box.level, sign, color="brown", va="center")
        else:
            lines.insert(0, box.step.words)
        shown = "\n".join(lines)
        axes.text(middle, bottom, shown, ha="center", va="bottom", family="monospace", size=9)
    drawing = StringIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": step.words}):
        figure.savefig(drawing, format="svg", metadata={"Date": None, "Title": step.words})
    return drawing.getvalue()


class _Box(NamedTuple):
    """A step with its place: `left` and `width` in characters, `level` counted from the words."""

    step: DerivationStep
    left: float
    width: float
    level: int
    parts: tuple[_Box, ...]

    def boxes(self) -> Iterator[_Box]:
        yield self
        for part in self.parts:
            yield from part.boxes()


def _box(step: DerivationStep, left: float) -> _Box:
    parts: list[_Box] = []
    end = left
    for part in step.parts:
        parts.append(_box(part, end))
        end = parts[-1].left + parts[-1].width + 3
    own = max(map(len, (step.category, _shortened(step.term), "" if parts else step.words)))
    level = max((part.level for part in parts), default=-1) + 1
    return _Box(step, left, max(own, end - left - 3), level, tuple(parts))


def _shortened(term: str) -> str:
    return term if len(term) <= MAX_TERM else f"{term[: MAX_TERM - 1]}…"
