"""The model of a scene for a live view, and the frames that say where its nodes are."""

import gzip
import struct
from collections.abc import Iterator

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.body import Body
from hilt.sim.media.gltf import SceneModel, pose_frame, scene_model
from hilt.sim.scene.scene import parse_scene

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
HEAD = struct.Struct("<BBHf")


@pytest.fixture(scope="module")
def body() -> Iterator[Body]:
    """A robot at a table with a knife and a mug."""
    scene = parse_scene("objects:knife,mug", seed=0, objects=OBJECTS)
    with Body(scene, OBJECTS, seed=0) as made:
        yield made


@pytest.fixture(scope="module")
def model(body: Body) -> SceneModel:
    """Its model."""
    return scene_model(body.world.engine)


def read_frame(frame: bytes) -> tuple[tuple[int, int, int, float], np.ndarray]:
    """The head of a frame, and its poses (n, 7)."""
    return HEAD.unpack_from(frame), np.frombuffer(frame, "<f4", offset=HEAD.size).reshape(-1, 7)


def test_model_has_one_node_for_each_link_that_can_be_seen(model: SceneModel):
    """Parts of objects and links of the arm are nodes; the floor, which is a speck, is none."""
    loaded = trimesh.load(model.file)

    assert {"table/top", "knife/blade", "mug/handle", "robot/panda_hand"} <= set(model.node_names)
    assert not any(name.startswith("floor/") for name in model.node_names)
    assert set(model.node_names) <= set(loaded.graph.nodes)


def test_model_shows_the_parts_in_their_true_sizes(body: Body, model: SceneModel):
    """The blade is as long in the file as in the world."""
    loaded = trimesh.load(model.file)
    shown = [
        loaded.geometry[loaded.graph[node][1]].extents
        for node in loaded.graph.nodes_geometry
        if node.startswith("knife/blade")
    ]
    corners = body.world.models["knife"].corners["blade"]

    assert np.max(shown, axis=0) == pytest.approx(np.ptp(corners, axis=0), abs=2e-3)


def test_colours_are_linear(model: SceneModel):
    """The screen's brown of the table, 0.788 of red, is a linear 0.584 in the file."""
    loaded = trimesh.load(model.file)
    top = next(node for node in loaded.graph.nodes_geometry if node.startswith("table/top"))

    colour = loaded.geometry[loaded.graph[top][1]].visual.material.baseColorFactor

    assert colour[0] == pytest.approx(0.584 * 255, abs=1)


def test_every_object_together_with_the_arm_takes_less_than_a_megabyte():
    """The arm's meshes are reduced, and the numbers rounded so that they compress."""
    scene = parse_scene("all", seed=0, objects=OBJECTS)
    with Body(scene, OBJECTS, seed=0) as crowded:
        model = scene_model(crowded.world.engine)

    assert len(gzip.compress(model.file.read_bytes())) < 1_000_000


def test_the_same_shapes_have_the_same_key(body: Body, model: SceneModel):
    """Where things stand is not in the file."""
    again = parse_scene("objects:knife,mug", seed=5, objects=OBJECTS)
    other = parse_scene("objects:knife", seed=0, objects=OBJECTS)

    with Body(again, OBJECTS, seed=5) as one, Body(other, OBJECTS, seed=0) as two:
        assert scene_model(one.world.engine) == model
        assert scene_model(two.world.engine).key != model.key


def test_frame_tells_where_each_node_is(body: Body, model: SceneModel):
    """Each pose is that of the link's frame in the world."""
    frame = pose_frame(body.world.engine, model.nodes, scene=65536 + 3)

    head, found = read_frame(frame)

    assert head == pytest.approx((1, 1, 3, body.world.time))
    for (name, link), (x, y, z, *quaternion) in zip(model.nodes, found.tolist(), strict=True):
        world_from_link = poses.pose(Rotation.from_quat(quaternion).as_matrix(), (x, y, z))
        expected = body.world.engine.bodies.pose(name, link)
        assert world_from_link == pytest.approx(expected, abs=1e-5)


def test_frame_leaves_the_world_alone(body: Body, model: SceneModel):
    """Taking a frame moves nothing and lets no time pass."""
    before = body.state_hash()

    pose_frame(body.world.engine, model.nodes, scene=1)

    assert body.state_hash() == before
