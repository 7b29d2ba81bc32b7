# SPDX-License-Identifier: Apache-2.0
"""Action trees are data: what is read, and what is refused."""

from pathlib import Path

import pytest

from hilt.ontology.action_sheet import load_actions
from hilt.ontology.actions import Affords, Loop, Step
from hilt.ontology.errors import DataError, UnknownNameError

HEAD = "primitives:\n  findObject: [object]\n  raise: []\ntrees:\n"


def written(tmp_path: Path, trees: str) -> Path:
    """A file with these trees, which start in line 5."""
    path = tmp_path / "actions.yaml"
    path.write_text(HEAD + trees, encoding="utf-8")
    return path


def test_pass_is_walked_as_figure_3_shows():
    """The pass tree finds, grasps, moves up and hands over."""
    steps = load_actions().tree("pass").steps

    assert [s.action for s in steps if isinstance(s, Step)] == [
        "findObject", "graspObject", "moveTo", "handOver",
    ]  # fmt: skip


def test_pound_supplies_the_tool_that_nobody_named():
    """The argument review of section 4.2 is a default of the tree."""
    pound = load_actions().tree("pound")

    assert pound.defaults["tool"] == Affords("usedFor", "affordance:pounding")
    assert pound.steps[0] == Step("pickUp", {"object": "tool"})


def test_pound_repeats_until_the_nail_is_driven():
    """Raising and lowering is a bounded loop with an end that is sensed."""
    loop = load_actions().tree("pound").steps[-1]

    assert isinstance(loop, Loop)
    assert (loop.until, [step.action for step in loop.steps]) == ("driven", ["raise", "lower"])


def test_nodes_are_the_paths_of_every_walk():
    """A nested tree's nodes are named by their whole path."""
    assert "pound/pickUp/graspObject" in load_actions().nodes


def test_contexts_of_a_node_come_nearest_first():
    """The nearest tree goes before the trees above it."""
    assert load_actions().contexts("pound/pickUp/graspObject") == ("pickUp", "pound")


def test_unknown_tree_is_told_with_those_there_are():
    """A misspelt goal is answered with the known ones."""
    with pytest.raises(UnknownNameError, match=r'Did you mean "pickUp"\?'):
        load_actions().tree("pickup")


@pytest.mark.parametrize(
    ("tree", "message"),
    [
        ("  a: {steps: []}", 'the key "parameters" is missing'),
        ("  a: {parameters: [x], steps: [{findObjekt: x}]}", 'Did you mean "findObject"'),
        ("  a: {parameters: [x], steps: [{findObject: y}]}", 'There is no parameter "y"'),
        ("  a: {parameters: [x], steps: [{raise: x}]}", '"raise" takes no argument'),
        ("  a: {parameters: [x], steps: [{a: x}]}", 'the tree "a" contains itself'),
        ("  a: {parameters: [x], steps: [{repeat: 0, steps: []}]}", r"number in \[1, 100\]"),
        ("  a: {parameters: [x], steps: [], defaults: {y: speaker}}", 'unknown key "y"'),
        ("  a: {parameters: [x], steps: [], defaults: {x: me}}", "expected one of speaker"),
        ("  a: {parameters: [x], steps: [{raise: , lower: }]}", "expected one action"),
    ],
)
def test_wrong_tree_is_refused_with_its_place(tmp_path: Path, tree: str, message: str):
    """Each mistake in a user's action file is told with its line."""
    with pytest.raises(DataError, match=rf"actions\.yaml:5:\d+: .*{message}"):
        load_actions(written(tmp_path, tree))
