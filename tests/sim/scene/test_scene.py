"""Scenes: what `--scene` may say, and where things are put."""

from math import radians
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from hilt.ontology.errors import DataError, SimulationError, UnknownNameError
from hilt.ontology.objects import load_objects
from hilt.sim.models.object_models import object_model
from hilt.sim.scene.placement import LIMITS, REACH, DropPose, place_objects
from hilt.sim.scene.scene import CLUTTER, GAP, Placement, Scene, graspable, parse_scene

OBJECTS = load_objects()


def arranged(scene: Scene) -> tuple[DropPose, ...]:
    """Where the objects of a scene are put."""
    return place_objects(scene, {name: object_model(OBJECTS[name]) for name in scene.types})


def write_scene(folder: Path, text: str) -> str:
    """A file that `--scene` can name."""
    path = folder / "scene.yaml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_all_names_what_can_be_grasped():
    """`all` puts the eight household objects on the table, and no fixtures."""
    scene = parse_scene("all", seed=7, objects=OBJECTS)

    assert scene.types == graspable(OBJECTS)
    assert len(scene.types) == 8
    assert scene.seed == 7


def test_objects_named_twice_get_their_own_names():
    """Two mugs are told apart."""
    scene = parse_scene("objects:mug, knife,mug", seed=0, objects=OBJECTS)

    assert [placement.name for placement in scene.placements] == ["mug", "knife", "mug 2"]
    assert [placement.object for placement in scene.placements] == ["mug", "knife", "mug"]


@given(st.integers(0, 2**31 - 1))
def test_random_scene_depends_on_its_seed_only(seed: int):
    """`random:SEED` is the same scene whatever other seed is given."""
    scene = parse_scene(f"random:{seed}", seed=1, objects=OBJECTS)

    assert scene == parse_scene(f"random:{seed}", seed=2, objects=OBJECTS)
    assert 1 <= len(scene.placements) <= 8


def test_file_says_what_it_wants_and_leaves_the_rest_open(tmp_path: Path):
    """In a file, place, turn and rest may be given for each object."""
    spec = write_scene(
        tmp_path,
        "seed: 5\nobjects:\n- knife\n"
        "- {object: mug, name: my mug, at: [0.5, 0.1], yaw_deg: 90, rest: upside down}\n",
    )

    scene = parse_scene(spec, seed=0, objects=OBJECTS)

    mug = Placement("my mug", "mug", (0.5, 0.1), radians(90), "upside down")
    assert scene == Scene((Placement("knife", "knife"), mug), 5)


@pytest.mark.parametrize("spec", ["objects:knife,sabre", "objects:", "objects:table"])
def test_unknown_object_is_refused(spec: str):
    """What is no object to put on a table is refused with those that are."""
    with pytest.raises(UnknownNameError, match="Known: block, glass"):
        parse_scene(spec, seed=0, objects=OBJECTS)


@pytest.mark.parametrize(
    "spec",
    ["random:x", "random:-1", "random:9999999999", "random:1:0", "random:1:13", "kitchen", ""],
)
def test_text_that_is_no_scene_is_refused(spec: str):
    """Anything else says what was expected."""
    with pytest.raises(DataError, match="expected a"):
        parse_scene(spec, seed=0, objects=OBJECTS)


@pytest.mark.parametrize(
    ("text", "line", "problem"),
    [
        ("objects: [knive]", 1, 'did you mean "knife"'),
        ("objects: [knife]\nsede: 1", 2, 'unknown key "sede"'),
        ("objects:\n- {object: mug, rest: flat}", 2, "expected one of on its side, upright"),
        ("objects:\n- {object: mug, at: [0.5]}", 2, "expected 2 numbers, found 1"),
        ("objects:\n- mug\n- {object: knife, name: mug}", 3, 'the name "mug" is taken'),
        ("objects:\n- {object: knife, name: table}", 2, 'the name "table" is taken'),
    ],
)
def test_mistake_in_a_file_is_told_with_its_line(
    tmp_path: Path, text: str, line: int, problem: str
):
    """A wrong scene file is told with the line where it is wrong."""
    with pytest.raises(DataError, match=problem) as caught:
        parse_scene(write_scene(tmp_path, text), seed=0, objects=OBJECTS)

    assert caught.value.line == line


@pytest.mark.parametrize("seed", range(5))
def test_no_two_objects_are_near_each_other(seed: int):
    """All eight objects find places with a gap between each two, within reach."""
    spots = arranged(parse_scene("all", seed=seed, objects=OBJECTS))

    low, high = np.array(LIMITS).T
    for i, spot in enumerate(spots):
        corners = shapely.get_coordinates(spot.footprint)
        assert ((corners >= low) & (corners <= high)).all()
        assert (np.linalg.norm(corners, axis=1) <= REACH).all()
        assert all(shapely.distance(spot.footprint, other.footprint) >= GAP for other in spots[:i])


def test_the_same_seed_gives_the_same_places():
    """An arrangement depends on nothing but the scene and its seed."""
    first, second, other = (
        np.array(
            [
                spot.world_from_object
                for spot in arranged(parse_scene("all", seed=seed, objects=OBJECTS))
            ]
        )
        for seed in (3, 3, 4)
    )

    assert (first == second).all()
    assert (first != other).any()


def test_fixed_place_is_kept():
    """An object whose place is given stands there."""
    (spot,) = arranged(Scene((Placement("mug", "mug", (0.5, 0.1), 0.3, "upright"),), 0))

    assert spot.world_from_object[:2, 3] == pytest.approx((0.5, 0.1))
    assert np.arctan2(spot.world_from_object[1, 0], spot.world_from_object[0, 0]) == pytest.approx(
        0.3
    )


def test_two_things_at_one_place_are_refused():
    """Fixed places that overlap are told, with the name of the second object."""
    places = [Placement(name, "mug", (0.5, 0.0), 0.0) for name in ("mug", "mug 2")]

    with pytest.raises(SimulationError, match=r'"mug 2" is less than 0.02 m'):
        arranged(Scene(tuple(places), 0))


def test_full_table_is_told():
    """When nothing more fits, that is said instead of tried for ever."""
    many = tuple(Placement(f"shoe {i}", "shoe") for i in range(30))

    with pytest.raises(SimulationError, match="no room on the table for 30 objects"):
        arranged(Scene(many, 0))


def test_nail_brings_its_block():
    """A scene that names a nail has a block for it to stand in, and so does each further nail."""
    scene = parse_scene("objects:hammer,nail,nail", seed=0, objects=OBJECTS)

    within = {placement.name: placement.within for placement in scene.placements}
    assert within == {
        "hammer": None,
        "nail": "block",
        "nail 2": "block 2",
        "block": None,
        "block 2": None,
    }


def test_nail_stands_in_the_block_that_is_there(tmp_path: Path):
    """A block that the scene names serves the nail, and a nail with a rest lies loose."""
    spec = write_scene(
        tmp_path,
        "objects:\n- {object: block, at: [0.5, 0.1]}\n- nail\n- {object: nail, rest: flat}",
    )

    scene = parse_scene(spec, seed=0, objects=OBJECTS)

    assert [placement.within for placement in scene.placements] == [None, "block", None]


def test_place_of_a_nail_is_that_of_its_block(tmp_path: Path):
    """The place given for a nail is where its block stands, upright and in the middle."""
    spec = write_scene(tmp_path, "objects: [{object: nail, at: [0.5, 0.1]}]")

    nail, block = arranged(parse_scene(spec, seed=0, objects=OBJECTS))

    assert block.placement.at == (0.5, 0.1)
    assert nail.world_from_object[:2, 3] == pytest.approx((0.5, 0.1))
    assert nail.world_from_object[2, 2] == pytest.approx(1.0)


def test_nail_and_block_cannot_both_have_places(tmp_path: Path):
    """A place for a nail whose block has one of its own is refused."""
    spec = write_scene(tmp_path, "objects:\n- block\n- {object: nail, at: [0.5, 0.1]}")

    with pytest.raises(DataError, match=r'"nail" stands in "block"\. Give the position of that'):
        parse_scene(spec, seed=0, objects=OBJECTS)


@given(st.integers(0, 10_000), st.integers(1, 12))
def test_random_scene_has_as_many_objects_as_asked(seed: int, count: int):
    """`random:SEED:COUNT` has that many objects, and none twice before all are there."""
    scene = parse_scene(f"random:{seed}:{count}", seed=0, objects=OBJECTS)

    assert len(scene.placements) == count
    assert len(scene.types) == min(count, 8)


@pytest.mark.parametrize("level", CLUTTER)
def test_clutter_adds_other_objects_at_its_distance(tmp_path: Path, level: str):
    """A cluttered scene has so many more objects, of other types first, and room between them."""
    spec = write_scene(tmp_path, f"clutter: {level}\nobjects: [knife]")

    scene = parse_scene(spec, seed=3, objects=OBJECTS)

    assert len(scene.types) == len(scene.placements) == 1 + CLUTTER[level][0]
    assert scene == parse_scene(spec, seed=3, objects=OBJECTS)
    spots = arranged(scene)
    for i, spot in enumerate(spots):
        others = spots[:i]
        assert all(
            shapely.distance(spot.footprint, o.footprint) >= CLUTTER[level][1] for o in others
        )


@pytest.mark.parametrize("seed", range(12))
def test_cluttered_tables_have_room(tmp_path: Path, seed: int):
    """Whatever the seed, seven more objects find their places."""
    spec = write_scene(tmp_path, "clutter: high\nobjects: [knife, nail]")

    assert len(arranged(parse_scene(spec, seed=seed, objects=OBJECTS))) == 10


def test_unknown_clutter_is_refused(tmp_path: Path):
    """A level that there is not is told with those that there are."""
    with pytest.raises(DataError, match="expected one of high, low, medium"):
        parse_scene(write_scene(tmp_path, "clutter: huge\nobjects: [mug]"), seed=0, objects=OBJECTS)


@pytest.mark.parametrize("name", ["robot", "table"])
def test_names_of_the_room_and_the_robot_are_not_given_to_things(name: str, tmp_path: Path):
    """A thing cannot be called like what every world has."""
    (tmp_path / "it.yaml").write_text(f"objects: [{{object: mug, name: {name}}}]")

    with pytest.raises(DataError, match=f'the name "{name}" is taken'):
        parse_scene(str(tmp_path / "it.yaml"), seed=0, objects=OBJECTS)


def test_negative_seed_is_refused():
    """Before anything is drawn from it."""
    with pytest.raises(DataError, match=r"--seed: expected 0 to \d+, found -1"):
        parse_scene("all", seed=-1, objects=OBJECTS)
