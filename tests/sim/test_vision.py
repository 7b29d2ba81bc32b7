"""Vision sensors are interchangeable and agree on the names of objects."""

from collections.abc import Iterator

import numpy as np
import pytest

from hilt.ontology.errors import UnknownNameError
from hilt.ontology.objects import load_objects
from hilt.sim.body import VISIONS, open_vision
from hilt.sim.scene.scene import parse_scene
from hilt.sim.scene.world import World
from hilt.sim.vision.perception_noise import NoiseLevels, NoisyDetector

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
ALL = [f"object:{name}" for name in OBJECTS]


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    """Two mugs, a knife, and a nail in its block."""
    scene = parse_scene("objects:mug,mug,knife,nail", seed=6, objects=OBJECTS)
    with World.build(scene, OBJECTS) as made:
        yield made


@pytest.mark.parametrize("source", VISIONS)
def test_every_source_names_objects_as_the_world_does(world: World, source: str):
    """Each percept has the name of the object at its place."""
    percepts = open_vision(world, source=source).search(ALL)

    assert {percept.name for percept in percepts} == set(world.kinds)
    for percept in percepts:
        assert percept.object == world.kinds[percept.name].name
        assert np.linalg.norm((world.top(percept.name) - percept.centre)[:2]) < 0.03


@pytest.mark.parametrize("noise", [NoiseLevels(depth_m=0.001, seed=1), NoiseLevels(camera=1)])
@pytest.mark.parametrize("source", VISIONS)
def test_every_source_works_with_noise(world: World, source: str, noise: NoiseLevels):
    """With such noise all objects are detected, but perhaps not a nail."""
    seen = open_vision(world, source=source, noise=noise)
    percepts = NoisyDetector(seen.search, noise, OBJECTS).search(ALL)

    assert {"mug", "mug 2", "knife", "block"} <= {percept.name for percept in percepts}


def test_unknown_source_is_an_error(world: World):
    """The error lists the known sources."""
    with pytest.raises(UnknownNameError, match=r'source of vision "crystal".*learned'):
        open_vision(world, source="crystal")
