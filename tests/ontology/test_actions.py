"""Action trees from files: what is read, and what is refused."""

from pathlib import Path

import pytest

from hilt.ontology.actions import (
    Actions,
    ArgumentByAffordance,
    Loop,
    Precondition,
    Step,
    load_actions,
)
from hilt.ontology.errors import DataError, UnknownNameError

HEAD = "primitives:\n  findObject: [object]\n  raise: []\ntrees:\n"


def written(tmp_path: Path, trees: str) -> Path:
    """Return a file with these trees, which start in line 5."""
    path = tmp_path / "actions.yaml"
    path.write_text(HEAD + trees, encoding="utf-8")
    return path


def test_steps_of_pass_are_those_of_figure_3():
    """The pass tree finds, grasps, moves up and hands over."""
    steps = load_actions().tree("pass").steps

    assert [s.action for s in steps if isinstance(s, Step)] == [
        "findObject", "graspObject", "moveTo", "handOver",
    ]  # fmt: skip


def test_pound_has_a_default_for_its_tool():
    """A default of the tree supplies the argument, as in section 4.2."""
    pound = load_actions().tree("pound")

    assert pound.defaults["tool"] == ArgumentByAffordance("usedFor", "affordance:pounding")
    assert pound.steps[0] == Step("pickUp", {"object": "tool"})


def test_pound_repeats_until_the_nail_is_driven():
    """Raising and lowering is repeated up to a limit, until the end is sensed."""
    loop = load_actions().tree("pound").steps[-1]

    assert isinstance(loop, Loop)
    assert (loop.until, [step.action for step in loop.steps]) == ("driven", ["raise", "lower"])


def test_nodes_are_named_by_their_paths():
    """The nodes of a nested tree are named by their whole path."""
    assert "pound/pickUp/graspObject" in load_actions().nodes


def test_contexts_of_a_node_come_nearest_first():
    """The innermost tree comes before the trees around it."""
    assert load_actions().contexts("pound/pickUp/graspObject") == ("pickUp", "pound")


def test_unknown_tree_is_refused_with_the_known_names():
    """The error about a misspelt goal lists the known ones."""
    with pytest.raises(UnknownNameError, match=r'Did you mean "pickUp"\?'):
        load_actions().tree("pickup")


@pytest.mark.parametrize(
    ("tree", "message"),
    [
        ("  a: {steps: []}", 'the key "parameters" is missing'),
        ("  a: {parameters: [x], steps: [{findObjekt: x}]}", r'\(did you mean "findObject"'),
        ("  a: {parameters: [x], steps: [{findObject: y}]}", 'expected one of x, found "y"'),
        ("  a: {parameters: [x], steps: [{raise: x}]}", '"raise" takes no argument'),
        ("  a: {parameters: [x], steps: [{a: x}]}", 'the tree "a" contains itself'),
        ("  a: {parameters: [x], steps: [{repeat: 0, steps: []}]}", r"number in \[1, 100\]"),
        ("  a: {parameters: [x], steps: [], defaults: {y: speaker}}", 'unknown key "y"'),
        ("  a: {parameters: [x], steps: [], defaults: {x: me}}", "expected one of speaker"),
        ("  a: {parameters: [x], steps: [{raise: , lower: }]}", "expected one action"),
    ],
)
def test_wrong_tree_is_refused_with_its_line(tmp_path: Path, tree: str, message: str):
    """Each mistake in a user's action file is reported with its line."""
    with pytest.raises(DataError, match=rf"actions\.yaml:5:\d+: .*{message}"):
        load_actions(written(tmp_path, tree))


# --- Files of one's own --------------------------------------------------------------------

OWN = """primitives: {shake: [object]}
failures: [spilled]
trees:
  season:
    is_a: use
    parameters: [patient, tool]
    defaults: {tool: {affords: seasonWith, of: patient}}
    requires: [{sees: patient}, {holds: tool}]
    steps: [{pickUp: tool}, {shake: {object: tool}}]
    otherwise:
      - {after: [spilled], again: 2}
      - {after: [unreachable], next: tool}
      - {after: any, steps: [{pointTo: tool}]}
"""


def own(tmp_path: Path, text: str) -> Actions:
    """Return the actions of a file, added to those of Hilt."""
    path = tmp_path / "own.yaml"
    path.write_text(text, encoding="utf-8")
    return load_actions(path, added_to=load_actions())


def test_user_file_adds_actions_to_those_of_hilt(tmp_path: Path):
    """Its trees may use Hilt's actions, which remain."""
    actions = own(tmp_path, OWN)

    season = actions.tree("season")
    assert season.requires == (Precondition("sees", "patient"), Precondition("holds", "tool"))
    assert season.defaults["tool"] == ArgumentByAffordance("seasonWith", of="patient")
    assert [branch.again for branch in season.otherwise] == [2, 0, 0]
    assert season.otherwise[2].handles("anything at all")
    assert actions.kinds == {"season": "use"}
    assert {"season/pickUp/graspObject", "season/pointTo/pointAt"} <= set(actions.nodes)
    assert actions.tree("pass") == load_actions().tree("pass")


def test_tree_of_the_same_name_replaces_that_of_hilt(tmp_path: Path):
    """A user's file may define another way to pass objects."""
    text = "trees: {pass: {parameters: [object], steps: [{pointAt: object}]}}\n"

    assert own(tmp_path, text).tree("pass").parameters == ("object",)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("sees: patient", "sees: nail", r':8:23: expected one of patient, tool, found "nail"'),
        ("{sees", "{smells", r':8:17: expected one of holds, sees, found "smells"'),
        ("[spilled], again", "[split], again", r':11:18: expected one of .*found "split"'),
        ("again: 2", "again: 99", r":11:35: expected a number in \[1, 10\], found 99"),
        (", again: 2", "", r":11:9: expected one of next, again, steps, found none"),
        ("again: 2", "again: 2, next: tool", r":11:9: .*found next and again"),
        ("is_a: use", "is_a: sue", r':5:11: expected one of .*found "sue" \(did you mean "use"'),
        ("is_a: use", "is_a: season", r':5:11: expected one of .*found "season"'),
        ("of: patient", "of: salt", r':7:48: expected one of patient, tool, found "salt"'),
        ("affords: seasonWith", "afords: x", r':7:23: unknown key "afords"'),
        ("pickUp: tool", "season: tool", r':5:5: the tree "season" contains itself'),
        ("object: tool", "thing: tool", r':9:38: unknown key "thing"'),
    ],
)
def test_mistake_is_reported_with_line_column_and_caret(
    tmp_path: Path, before: str, after: str, message: str
):
    """The message has what was expected, what was found and a suggestion."""
    with pytest.raises(DataError, match=r"own\.yaml" + message) as told:
        own(tmp_path, OWN.replace(before, after))

    line, caret = told.value.excerpt().splitlines()
    assert line == OWN.replace(before, after).splitlines()[told.value.line - 1]
    assert caret.index("^") == told.value.column - 1


def test_cycle_of_kinds_is_refused(tmp_path: Path):
    """Two actions that are kinds of each other are refused."""
    tree = "{is_a: %s, parameters: [object], steps: [{pointAt: object}]}"
    text = f"trees:\n  show: {tree % 'present'}\n  present: {tree % 'show'}\n"

    with pytest.raises(DataError, match='the tree "show" would be a kind of itself'):
        own(tmp_path, text)
