"""The objects of the household: their data, and the reports of mistakes in the file."""

from pathlib import Path

import pytest

from hilt.ontology.errors import DataError, UnknownNameError
from hilt.ontology.objects import OBJECTS_FILE, load_household, load_objects
from hilt.ontology.part_shapes import Lathe

PAPER = {
    "knife": ["handle", "blade"],
    "spatula": ["handle", "blade"],
    "spoon": ["handle", "bowl"],
    "shoe": ["upper", "sole"],
    "hammer": ["handle", "head"],
    "glass": ["bowl", "stem"],
    "mug": ["handle", "barrel"],
    "screwdriver": ["handle", "shaft"],
}
SMALL = """
classes: {artifact: null, tool: artifact}
roles: {grip: made for a hand}
properties: {long: several times longer than wide}
materials: {wood: {friction: 0.6, shine: 0.1}}
objects:
  stick:
    is_a: tool
    parts:
      shaft:
        role: grip
        material: wood
        colour: "#805030"
        mass: 0.1
        shape:
          - cylinder: {radius: 0.01, length: 0.3}
    rests:
      flat: {turn_deg: [0, 90, 0]}
"""


def load_changed(folder: Path, old: str, new: str):
    """Return the objects of the small file with one text replaced."""
    assert old in SMALL
    path = folder / "objects.yaml"
    path.write_text(SMALL.replace(old, new), encoding="utf-8")
    return load_objects(path)


def test_the_eight_objects_have_the_parts_of_the_paper():
    """Section 4.1 lists eight objects of two parts each."""
    objects = load_objects()

    graspable = {name: list(kind.parts) for name, kind in objects.items() if kind.graspable}
    assert graspable == PAPER


@pytest.mark.parametrize("affordance", ["cutting", "pounding", "containing", "rolling", "poking"])
def test_data_has_no_affordances(affordance: str):
    """What an object is used for is learned and not in the file."""
    text = OBJECTS_FILE.read_text(encoding="utf-8")

    assert affordance not in text


def test_mass_of_an_object_is_that_of_its_parts():
    """The mass of an object is the sum of the masses of its parts."""
    hammer = load_objects()["hammer"]

    assert hammer.mass == pytest.approx(hammer.part("handle").mass + hammer.part("head").mass)


def test_unknown_part_is_refused_with_the_known_ones():
    """The error about a part lists the parts of that object."""
    knife = load_objects()["knife"]

    with pytest.raises(UnknownNameError, match=r'no part of knife "bowl".*Known: blade, handle'):
        knife.part("bowl")


def test_every_class_leads_to_a_root():
    """The chain of is_a ends for every class."""
    household = load_household()

    above = dict(household.classes) | {n: kind.is_a for n, kind in household.objects.items()}

    for word in above:
        steps = 0
        while (word := above[word]) is not None:
            steps += 1
            assert steps < len(above)


def test_user_file_defines_an_object(tmp_path: Path):
    """An object in a user's file is loaded like those of Hilt."""
    stick = load_changed(tmp_path, "length: 0.3", "length: 0.4")["stick"]

    form = stick.part("shaft").shape[0].form
    assert isinstance(form, Lathe)
    assert form.profile == ((0.01, -0.2), (0.01, 0.2))


@pytest.mark.parametrize(
    ("old", "new", "line", "problem"),
    [
        ("is_a: tool", "is_a: toll", 8, 'found "toll" \\(did you mean "tool"'),
        ("is_a: tool", "is_a: stick", 8, "expected one of artifact, tool"),
        ("role: grip", "role: gripp", 11, "expected one of grip"),
        ("material: wood", "material: wool", 12, "expected one of wood"),
        ('"#805030"', '"brown"', 13, 'expected a colour as "#rrggbb"'),
        ("mass: 0.1", "mass: -1", 14, "expected a number in"),
        ("mass: 0.1", "weight: 0.1", 14, 'unknown key "weight"'),
        ("radius: 0.01", "radius: thin", 16, "expected a number in"),
        ("- cylinder: {", "- tube: {", 16, 'unknown key "tube"'),
        ("turn_deg: [0, 90, 0]}", "turn_deg: [0, 90]}", 18, "expected 3 numbers, found 2"),
        ("turn_deg: [0, 90, 0]}", "turn_deg: [0, 0, 0], usual: false}", 18, "that is usual"),
        ("{artifact: null,", "{artifact: tool,", 2, "is a kind of itself"),
    ],
)
def test_mistake_is_reported_with_its_line(
    tmp_path: Path, old: str, new: str, line: int, problem: str
):
    """A wrong value is reported with its line and what was expected."""
    with pytest.raises(DataError, match=problem) as caught:
        load_changed(tmp_path, old, new)

    assert caught.value.line == line


@pytest.mark.parametrize(
    ("form", "problem"),
    [
        ("lathe: {profile: [[0.1, 0], [0.1, 0]]}", "heights that grow"),
        ("lathe: {profile: [[-0.1, 0], [0.1, 1]]}", "a radius of 0 or more"),
        ("extrusion: {outline: [[0, 0], [0, 1], [1, 0]], thickness: 0.1}", "counter-clockwise"),
        ("extrusion: {outline: [[0, 0], [1, 0]], thickness: 0.1}", "at least 3 points"),
        ("sweep: {path: [[0, 0, 0]], sections: [[0.1, 0.1]]}", "at least 2 points"),
        (
            "sweep: {path: [[0, 0, 0], [1, 0, 0], [2, 0, 0]], sections: [[1, 1], [1, 1]]}",
            "1 section",
        ),
        ("box: {size: [1, 1, 0.01], bevel: 0.1}", "less than half"),
        ("mesh: {file: nowhere.stl}", "there is no file"),
    ],
)
def test_impossible_solid_is_refused(tmp_path: Path, form: str, problem: str):
    """A solid that cannot be made is refused when it is read."""
    with pytest.raises(DataError, match=problem):
        load_changed(tmp_path, "cylinder: {radius: 0.01, length: 0.3}", form)


def load_added(folder: Path, text: str):
    """Return Hilt's household with the objects of a text added."""
    path = folder / "mine.yaml"
    path.write_text(text, encoding="utf-8")
    return load_household(path, added_to=load_household())


ROD = SMALL[SMALL.index("objects:") :].replace("stick", "rod")


def test_objects_of_a_user_file_are_added_to_the_household(tmp_path: Path):
    """A file may have objects only, with the classes and materials of the household."""
    household = load_added(tmp_path, ROD)

    assert household.objects["rod"].is_a == "tool"
    assert {"rod", *PAPER} <= household.objects.keys()
    assert household.materials["wood"] == household.objects["rod"].parts["shaft"].material


def test_user_file_may_declare_classes_and_materials(tmp_path: Path):
    """A user's file may declare classes and materials that the household does not have."""
    words = "classes: {wand: tool}\nmaterials: {cork: {friction: 0.7, shine: 0}}\n"
    mine = ROD.replace("is_a: tool", "is_a: wand").replace("wood", "cork")

    household = load_added(tmp_path, words + mine)

    assert household.classes["wand"] == "tool"
    assert household.objects["rod"].parts["shaft"].material.name == "cork"


def test_object_with_the_name_of_another_is_refused(tmp_path: Path):
    """A user's file cannot replace an object of the household."""
    with pytest.raises(DataError, match='there already is an object "knife"'):
        load_added(tmp_path, ROD.replace("rod", "knife"))


def test_nail_stands_in_its_block():
    """The nail has a mount with its support, depth and resistance."""
    mount = load_objects()["nail"].mount

    assert mount is not None
    assert mount.support == "block"
    assert 0 < mount.depth < mount.deepest


@pytest.mark.parametrize(
    ("mount", "problem"),
    [
        ("{support: brick, at: [0, 0, 0], depth: 0, deepest: 1, resistance_N: 9}", "expected one"),
        ("{support: mug, at: [0, 0, 0], depth: 2, deepest: 1, resistance_N: 9}", "expected"),
        ("{support: mug, at: [0, 0, 0], depth: 1, deepest: 2}", 'key "resistance_N" is missing'),
    ],
)
def test_wrong_mount_is_refused(tmp_path: Path, mount: str, problem: str):
    """A mount needs an existing support and a possible depth."""
    with pytest.raises(DataError, match=problem):
        load_added(tmp_path, f"{ROD}    mount: {mount}\n")


@pytest.mark.parametrize("name", ["Rod", "a/b", "rod_1", "two  rods"])
def test_name_that_is_no_word_is_refused_with_its_line(name: str, tmp_path: Path):
    """A name that no sentence can have is reported with its line when the file is read."""
    with pytest.raises(DataError, match=r"mine\.yaml:\d+:\d+: .* is no name; expected lower-case"):
        load_added(tmp_path, ROD.replace("rod:", f'"{name}":', 1))
