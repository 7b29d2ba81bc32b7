"""Experiments of one's own: what a file says is run, and what is wrong in it is told where."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hilt.agent.cli import main
from hilt.agent.evaluation.experiments.custom import CustomExperiment, load_custom
from hilt.ontology.errors import DataError

EXAMPLE = Path(__file__).parents[4] / "examples" / "experiment.yaml"
SMALL = """\
levels: [always, often]
affordances:
  cutting: {always: [knife], often: [spoon]}
  stirring: {often: [spoon]}
grasps:
  knife: {pass: blade}
mirrored: true
scenes:
  - all
  - [spoon]
  - [knife]
  - {random: 2}
actions: [pass]
"""


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """A file with two objects that Hilt has."""
    path = tmp_path / "small.yaml"
    path.write_text(SMALL, encoding="utf-8")
    return path


def test_file_says_what_is_taught_and_asked(small):
    """Two scenarios, five scenes and two commands of one action."""
    said = load_custom(small, seed=3)

    assert [scenario.name for scenario in said.scenarios] == ["A", "B"]
    assert said.scenarios[0].sentences()[0] == "a knife is always used for cutting"
    assert "To pass a knife always grab the knife by the blade" in said.scenarios[0].sentences()
    assert said.scenarios[1].best("cutting", ["knife", "spoon"]) == {"spoon"}
    assert said.scenes[:2] == (("knife", "spoon"), ("spoon",))
    assert len(said.scenes) == 5
    assert load_custom(small, seed=3).scenes == said.scenes


def test_custom_experiment_is_right(small):
    """The agent does what the file wants, in every scene."""
    experiment = CustomExperiment(file=str(small))

    results = [experiment.run(case) for case in experiment.cases()]

    assert len(results) == 2 * 5 * 2
    assert [result.key for result in results if not result.right] == []
    assert {result.kind for result in results} >= {"unique", "none"}


def test_example_has_five_new_objects(capsys):
    """`hilt evaluate custom` runs it from the command line, and all of it is right."""
    with pytest.raises(SystemExit) as ended:
        main(["evaluate", "custom", "--file", str(EXAMPLE), "--json"])

    counts = json.loads(capsys.readouterr().out)
    assert ended.value.code == 0
    assert (counts["runs"], counts["right"]) == (300, 300)
    assert set(load_custom(EXAMPLE).scenarios[0].grasps) == {
        "trowel", "brush", "bottle", "torch", "pruner",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "where", "problem"),
    [
        ("often: [spoon]}\n  stir", "often: [spork]}\n  stir", "3:38", 'found "spork"'),
        ("pass: blade", "pass: stem", "6:17", "expected one of blade, handle"),
        ("[always, often]", "[often, always]", "1:17", "not less certain"),
        ("[always, often]", "[always, blorply]", "1:18", "not understood"),
        ("[always, often]", "[always, rarely]", "1:18", "does not support"),
        ("[always, often]", "[]", "1:9", "at least one level"),
        ("often: [spoon]}\n  stir", "often: [knife]}\n  stir", "3:38", "has two levels"),
        ("actions: [pass]", "actions: [throw]", "13:11", "pickUp, pointTo"),
        ("  - [spoon]", "  - [spoon, spoon]", "10:5", "listed twice"),
        ("  - [spoon]", "  - [mug]", "10:6", 'found "mug"'),
        ("random: 2", "random: 0", "12:14", "found 0"),
        ("scenes:", "scene:", "8:1", 'did you mean "scenes"'),
    ],
)
def test_mistake_is_told_with_its_place(small, old, new, where, problem):
    """File, line and column, and what was expected."""
    assert old in SMALL
    small.write_text(SMALL.replace(old, new), encoding="utf-8")

    with pytest.raises(DataError) as raised:
        load_custom(small)

    assert f"small.yaml:{where}: " in str(raised.value)
    assert problem in str(raised.value)


def test_custom_needs_its_file():
    """Without --file it says so."""
    with pytest.raises(DataError, match="--file"):
        CustomExperiment().cases()


@pytest.mark.sim
def test_robot_hands_over_what_only_the_file_has():
    """A simulated robot takes an object of the example by the part that the file wants."""
    experiment = CustomExperiment(file=str(EXAMPLE), sim=True)
    case = next(case for case in experiment.cases() if case.key == "A/1/pass/digging")

    result = experiment.run(case)

    assert result.right
    assert result.facts["touched"] == ["scoop"]
