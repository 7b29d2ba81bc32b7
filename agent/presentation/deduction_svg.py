"""Derivations of utterances and proofs of decisions in SVG, as deductions in the form of Gentzen.

Premises stand above a line and what follows from them below it, so that the root is at the bottom.
"""

from collections.abc import Callable, Sequence
from io import StringIO
from textwrap import wrap
from typing import NamedTuple

from ...inference.proof import Proof
from ...kb.rule import Rule
from ...nlu.generation.templates import proper_name
from ...nlu.parsing.chart import DerivationStep
from ...ontology.errors import extra_required

MAX_TERM = 60  # characters of a lambda term
COLUMNS, MOST_LINES = 32, 3  # of the text about a step of a proof
_LETTER, _LINE = 0.09, 0.16  # [inch]
_GAP = 3  # between two premises [characters]
_EVIDENCE = {
    "told": "#fdf1d6",
    "seen": "#dcecf7",
    "given": "#e3f1de",
    "unknown": "#eeeeee",
    "experienced": "#eadff2",
}


class Deduction(NamedTuple):
    """A step as it is drawn: the lines of its text, its premises, and the sign of its rule."""

    lines: Sequence[str]
    premises: "Sequence[Deduction]"
    rule: str = ""
    colour: str = "none"


class _Box(NamedTuple):
    """A step with its place: `left` and `right` in characters, `level` counted from the leaves."""

    step: Deduction
    left: float
    right: float
    level: int


def from_derivation(step: DerivationStep) -> Deduction:
    """Return a derivation with the category and the lambda term of each step."""
    term = step.term if len(step.term) <= MAX_TERM else f"{step.term[: MAX_TERM - 1]}…"
    lines = (step.category, term) if step.parts else (step.words, step.category, term)
    # The result shows what a unary rule, whose name is long, has changed.
    rule = step.rule if len(step.rule) <= 2 else "⇒"
    return Deduction(lines, [from_derivation(part) for part in step.parts], rule)


def from_proof(proof: Proof, describe: Callable[[Rule], str]) -> Deduction:
    """Return a proof with intervals and, in colour, evidence; `describe` puts a rule in words."""
    rule = proof.rule
    told = f"{proper_name(rule.speaker)}: {describe(rule)}" if rule else proof.about
    about = wrap(told, COLUMNS, max_lines=MOST_LINES, placeholder=" …")
    lines = (f"{proof.interval}  {proof.step}", *about)
    colour = _EVIDENCE.get(proof.step, "none")
    return Deduction(lines, [from_proof(each, describe) for each in proof.inputs], colour=colour)


def draw_svg(deductions: Sequence[Deduction]) -> str:
    """Return deductions side by side as an SVG document; MissingExtraError without matplotlib."""
    with extra_required("report", "matplotlib"):
        from matplotlib import rc_context
        from matplotlib.figure import Figure
    boxes: list[_Box] = []
    _place(deductions, 0, boxes)
    width = max((box.right for box in boxes), default=0) + _GAP
    levels = max((box.level for box in boxes), default=0) + 1
    row = _LINE * (1.5 + max((len(box.step.lines) for box in boxes), default=0))
    figure = Figure(figsize=(_LETTER * (width + _GAP), row * levels))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(-_GAP, width), ylim=(levels, 0))
    axes.set_axis_off()
    for step, left, right, level in boxes:
        if step.premises:
            axes.plot([left, right], [level, level], "gray", lw=1)
            axes.text(right, level, step.rule, color="brown", va="center")
        axes.text(
            (left + right) / 2, level + 0.5, "\n".join(step.lines),
            bbox={"facecolor": step.colour, "edgecolor": "none"},
            ha="center", va="center", family="monospace", size=9,
        )  # fmt: skip
    drawing = StringIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "deductions"}):
        figure.savefig(drawing, format="svg", metadata={"Date": None})
    return drawing.getvalue()


def _place(steps: Sequence[Deduction], left: float, boxes: list[_Box]) -> tuple[float, int]:
    right, below = left - _GAP, 0
    for step in steps:
        start = right + _GAP
        end, level = _place(step.premises, start, boxes)
        right = max(end, start + max(map(len, step.lines)))
        below = max(below, level + 1)
        boxes.append(_Box(step, start, right, level))
    return right, below
