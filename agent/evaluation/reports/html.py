# SPDX-License-Identifier: Apache-2.0
"""The report of a run as one page of HTML that needs nothing else: no script, font or picture file.

Counts and principles, curves, pictures of scenes where a robot was simulated, every case, and the
explanation of every case, to which its row links. Equal explanations stand there once.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import cast

from ...execution.outcome import Json
from ..case import Case, Result
from ..experiment import Experiment
from .plots import curve_svg
from .summary import EvaluationReport

COUNTS = ("runs", "right", "unique", "ties", "none", "executed", "succeeded", "grasps")
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1c2430; max-width: 76rem; margin: 2rem auto;
  padding: 0 1.5rem }
h1 { margin-bottom: 0 } h2 { margin-top: 2.2rem; border-bottom: 1px solid #d5dbe3 }
.sub { color: #5b6675 }
table { border-collapse: collapse; margin: .8rem 0 } th { text-align: left; background: #eef1f5 }
th, td { padding: .25rem .7rem; border-bottom: 1px solid #e3e7ed; vertical-align: top }
td.n { text-align: right; font-variant-numeric: tabular-nums }
tr.wrong td { background: #fdeceb } .yes { color: #00724d } .no { color: #b3261e; font-weight: 600 }
.curve { display: inline-block; vertical-align: top; margin-right: 1rem }
figure { display: inline-block; margin: .5rem .8rem .5rem 0; vertical-align: top; max-width: 560px }
figure:has(img) { width: 330px } figcaption { color: #5b6675 }
svg text { font: 11px system-ui, sans-serif; fill: #3d4755 } svg .grid { stroke: #e3e7ed }
pre { background: #f6f7f9; padding: .8rem; overflow-x: auto; font-size: 12.5px }
section.why:target pre { outline: 2px solid #0072b2 }
"""


@dataclass(frozen=True)
class EmbeddedPicture:
    """A picture in a page.

    Attributes:
        caption: what it shows.
        data: PNG or JPEG, in base64.
        kind: "png" or "jpeg".
    """

    caption: str
    data: str
    kind: str = "png"


def page(
    experiment: Experiment,
    cases: Sequence[Case],
    report: EvaluationReport,
    pictures: Iterable[EmbeddedPicture] = (),
) -> str:
    """The whole page.

    Args:
        experiment: what was run.
        cases: all of its cases.
        report: what came of them, in the same order.
        pictures: of its scenes.
    """
    reasons = _Reasons()
    counts = report.as_json()
    parts = [
        f"<h1>{escape(report.name)}</h1>",
        f'<p class="sub">{escape(_options(report))}</p>',
        *_counted(counts),
        *_summed(report.summary),
        *_curves(report.summary.get("curves")),
        *_pictures(pictures),
        *_cases(experiment, cases, report.results, reasons),
        *reasons.sections(),
    ]
    body = "\n".join(parts)
    return (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>Hilt: {escape(report.name)}</title>\n<style>{STYLE}</style>\n</head>\n"
        f"<body>\n{body}\n</body>\n</html>\n"
    )


@dataclass
class _Reasons:
    """Explanations, each once, with a number to link to."""

    numbers: dict[str, int] = field(default_factory=dict[str, int])

    def link(self, text: str) -> str:
        """A link to an explanation; nothing where there is none."""
        if not text:
            return ""
        number = self.numbers.setdefault(text, len(self.numbers) + 1)
        return f'<a href="#why-{number}">why</a>'

    def sections(self) -> Iterator[str]:
        if self.numbers:
            yield "<h2>Explanations</h2>"
        for text, number in self.numbers.items():
            yield f'<section class="why" id="why-{number}"><pre>{escape(text)}</pre></section>'


def _options(report: EvaluationReport) -> str:
    return ", ".join(f"{name} {json.dumps(value)}" for name, value in report.options.items())


def _counted(counts: Json) -> Iterator[str]:
    yield "<h2>Counts</h2>"
    shown = [name for name in COUNTS if counts[name] or name in {"runs", "right"}]
    yield _table(shown, [[str(counts[name]) for name in shown]], numeric=True)
    principles = cast("dict[str, dict[str, int]]", counts["by_principle"])
    if principles:
        rows = [[n, str(each["runs"]), str(each["right"])] for n, each in principles.items()]
        yield "<h3>By principle of section 4.1</h3>"
        yield _table(["principle", "runs", "right"], rows, numeric=True)


def _summed(summary: Mapping[str, object]) -> Iterator[str]:
    rows = [[name, _words(value)] for name, value in summary.items() if name != "curves"]
    if rows:
        yield "<h2>Summary</h2>"
        yield _table(["what", "value"], rows)


def _words(value: object) -> str:
    """A value as a person reads it."""
    if isinstance(value, dict):
        pairs = cast("Json", value).items()
        return "; ".join(f"{name.replace('_', ' ')}: {_words(each)}" for name, each in pairs)
    if isinstance(value, list):
        return ", ".join(map(_words, cast("list[object]", value))) or "none"
    return f"{value:,}" if type(value) is int else str(value)


def _curves(curves: object) -> Iterator[str]:
    if not curves:
        return
    yield "<h2>Curves</h2>"
    for curve in cast("list[Json]", curves):
        lines = cast("dict[str, list[Json]]", curve["lines"])
        yield f'<div class="curve"><h3>{escape(str(curve["curve"]))}</h3>'
        yield f"<figure>{curve_svg(str(curve['label']), lines)}</figure>"
        names = ["x", "accuracy", "lower", "upper", "decisions", "right", "wrong", "declined"]
        rows = [
            [line, *(str(point[name]) for name in names)]
            for line, points in lines.items()
            for point in points
        ]
        figures = _table(["line", *names], rows)
        yield f"<details><summary>figures</summary>{figures}</details></div>"


def _pictures(pictures: Iterable[EmbeddedPicture]) -> Iterator[str]:
    found = list(pictures)
    if found:
        yield "<h2>Scenes</h2>"
    for each in found:
        source = f"data:image/{each.kind};base64,{each.data}"
        caption = escape(each.caption)
        yield f'<figure><img src="{source}" alt="{caption}" width="330">'
        yield f"<figcaption>{caption}</figcaption></figure>"


def _cases(
    experiment: Experiment, cases: Sequence[Case], results: Sequence[Result], reasons: _Reasons
) -> Iterator[str]:
    yield "<h2>Cases</h2>"
    yield "<table><tr><th>case</th><th>found</th><th>expected</th><th>right</th><th></th></tr>"
    for case, result in zip(cases, results, strict=True):
        texts = "".join(f"<td>{escape(t)}</td>" for t in (case.key, result.found, result.expected))
        mark = '<span class="yes">yes</span>' if result.right else '<span class="no">no</span>'
        link = reasons.link(experiment.explain(case, result))
        row = f'<tr id="{escape(case.key)}"' + ("" if result.right else ' class="wrong"')
        yield f"{row}>{texts}<td>{mark}</td><td>{link}</td></tr>"
    yield "</table>"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], *, numeric: bool = False) -> str:
    kind = ' class="n"' if numeric else ""
    top = "".join(f"<th>{escape(name)}</th>" for name in head)
    body = "".join(
        f"<tr>{''.join(f'<td{kind}>{escape(cell)}</td>' for cell in row)}</tr>\n" for row in rows
    )
    return f"<table><tr>{top}</tr>\n{body}</table>"
