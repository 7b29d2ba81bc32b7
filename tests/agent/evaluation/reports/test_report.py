"""Reports of evaluations: the page, the files, and two runs compared."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from hilt.agent.cli import main
from hilt.agent.evaluation.experiment import Case, CaseResult, TimedResult
from hilt.agent.evaluation.experiments.decisions import PaperExperiment
from hilt.agent.evaluation.experiments.noise_robustness import NoiseExperiment
from hilt.agent.evaluation.reports.report import (
    COLOURS,
    EvaluationReport,
    plot_curve,
    render_page,
    write_report,
)
from hilt.agent.evaluation.runners.runner import run_experiment

ROOT = Path(__file__).parents[4]
POINTS = [
    {"x": 0.0, "accuracy": 1.0, "lower": 0.9, "upper": 1.0},
    {"x": 0.5, "accuracy": 0.5, "lower": 0.4, "upper": 0.6},
]


class Links(HTMLParser):
    """What a page links to, has anchors for, and loads."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.targets: list[str] = []
        self.anchors: set[str] = set()
        self.sources: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        """Take down what a tag links to, names or loads."""
        found = dict(attrs)
        self.anchors.add(found.get("id") or "")
        self.targets += [found["href"]] if "href" in found else []
        self.sources += [found["src"]] if "src" in found else []


@pytest.fixture(scope="module")
def paper():
    """Two scenes of the paper's run: the experiment, its cases and their report."""
    experiment = PaperExperiment(scenes=2)
    cases = experiment.cases()
    return (
        experiment,
        cases,
        EvaluationReport.from_runs(experiment, run_experiment(experiment, cases)),
    )


def test_every_case_links_to_its_explanation(paper):
    """Each row has a link to a section that stands in the page, with rules and proofs."""
    _, cases, _ = paper

    text = render_page(*paper)

    links = Links(text)
    assert len(links.targets) == len(cases)
    assert all(target.removeprefix("#") in links.anchors for target in links.targets)
    assert "modus ponens" in text and "said sam in utterance" in text
    assert {case.key for case in cases} <= links.anchors


def test_page_needs_nothing_else(paper):
    """No script, and nothing that is loaded from elsewhere."""
    text = render_page(*paper, pictures=[("scene 1", "AAAA")])

    assert Links(text).sources == ["data:image/jpeg;base64,AAAA"]
    assert "<script" not in text and "http" not in text


def test_page_shows_what_is_wrong_and_escapes_it(paper):
    """A wrong case stands out, and its texts are text."""
    experiment, cases, _ = paper
    result = CaseResult("A/<b>", False, "unique", 1, "<i>mug</i>", "knife", {"why": ["1 < 2"]})
    wrong = EvaluationReport("paper", {}, (TimedResult(result, 0.1),))

    text = render_page(experiment, [Case("paper", "A/<b>", cases[0].spec)], wrong)

    assert 'class="wrong"' in text and "&lt;i&gt;mug&lt;/i&gt;" in text and "1 &lt; 2" in text


def test_plot_has_a_line_with_a_band_for_each_name():
    """A plot is well-formed SVG whose lines have colours of their own and a legend."""
    svg = plot_curve("share & more", {"one": POINTS, "two": POINTS})

    root = ET.fromstring(svg)  # noqa: S314 - our own
    texts = {each.text for each in root.iter("{http://www.w3.org/2000/svg}text")}
    assert {"share & more", "one", "two", "100%"} <= texts
    assert all(f"fill: {colour}" in svg for colour in COLOURS[:2])


def test_page_of_noise_has_its_curves():
    """The curves of a run stand in its page, with their figures."""
    experiment = NoiseExperiment(trials=1)
    cases = [case for case in experiment.cases() if case.key.startswith("missed/default/0/")]

    text = render_page(
        experiment, cases, EvaluationReport.from_runs(experiment, run_experiment(experiment, cases))
    )

    assert text.count("<svg") == 1
    assert "<th>accuracy</th>" in text


def test_csv_and_json_hold_every_case(paper, tmp_path):
    """A line a case; the counts and the results."""
    _, cases, report = paper
    write_report(tmp_path / "r.csv", *paper)
    write_report(tmp_path / "r.json", *paper)

    with (tmp_path / "r.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    document = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    assert [row["key"] for row in rows] == [case.key for case in cases]
    assert document["runs"] == len(document["results"]) == len(report.results)


def test_unknown_form_is_refused_before_the_run():
    """The end of the file's name must say a form."""
    with pytest.raises(SystemExit) as ended:
        main(["evaluate", "paper", "--report", "out.txt"])

    assert ended.value.code == 2


def test_equal_runs_do_not_differ(paper, tmp_path):
    """Times are not compared."""
    experiment, cases, report = paper
    slower = EvaluationReport.from_runs(
        experiment, [TimedResult(each.result, each.cpu_s + 1) for each in report.runs]
    )
    write_report(tmp_path / "a.json", *paper)
    write_report(tmp_path / "b.json", experiment, cases, slower)

    assert compared(tmp_path) == (0, "No difference.\n")


def compared(folder: Path) -> tuple[int, str]:
    """The exit code of the comparison of a.json with b.json, and what it prints."""
    command = [sys.executable, ROOT / "examples" / "compare_runs.py", "a.json", "b.json"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    return ended.returncode, ended.stdout


def test_comparison_tells_which_cases_came_out_otherwise(paper, tmp_path):
    """Counts and cases that differ are named; the exit code says that there are some."""
    experiment, cases, report = paper
    (first, *others) = report.runs
    worse = TimedResult(CaseResult(first.result.key, False, "tie", 3, "shoe", "mug"), 0.0)
    write_report(tmp_path / "a.json", *paper)
    write_report(
        tmp_path / "b.json",
        experiment,
        cases,
        EvaluationReport.from_runs(experiment, [worse, *others]),
    )

    code, out = compared(tmp_path)

    assert code == 1
    assert f"right: {len(cases)} | {len(cases) - 1}\n" in out
    assert f"{first.result.key}: right: {first.result.found} | wrong: shoe\n" in out


@pytest.mark.sim
def test_page_of_a_simulated_run_has_pictures(tmp_path):
    """Each scene stands there as a picture, and what the robot saw explains its choice."""
    experiment = PaperExperiment(scenes=1, sim=True)
    cases = [case for case in experiment.cases() if case.key == "A/0/pointTo/cutting"]
    done = run_experiment(experiment, cases)

    write_report(
        tmp_path / "r.html", experiment, cases, EvaluationReport.from_runs(experiment, done)
    )

    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert len(Links(text).sources) == 1
    assert done[0].result.facts["why"]
