"""A scene for a live view: a binary glTF file (GLB) once, and then frames of poses.

Every link that can be seen is one node of the file. The meshes stand in the frames of their links,
and the nodes at the origin: where they are in the world is told by frames. The axes are those of
the world, z up. Large meshes are reduced by quadric error metrics (Garland and Heckbert 1997).

A frame is little-endian: `u8 kind = 1`, `u8 version = 1`, `u16 scene`, `f32 time` [s] of the world,
then `f32 x y z qx qy qz qw` in the world for each node, in their order.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...ontology.disk_cache import cache_folder, cached, content_key
from ...ontology.errors import extra_required
from ..models import meshes
from ..physics.engine import TIME_STEP, PhysicsEngine
from ..physics.rendering import VisualShape

with extra_required("sim", "trimesh"):
    import trimesh
    from trimesh import Trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

MOST_FACES = 2500  # of one mesh
GRID = 2.0**-16  # [m], to which corners are rounded, so that they compress
NORMAL_GRID = 2.0**-8
LEAST_SIZE = 1e-4  # [m]; the simulator's invisible specks are smaller
ROUGHNESS, METALLIC = 0.65, 0.05
KIND, VERSION = 1, 1  # of frames
_VERSION = b"1"  # of the files that this module writes
_HEAD = struct.Struct("<BBHf")


@dataclass(frozen=True)
class SceneModel:
    """The shapes of all bodies of a scene."""

    file: Path  # GLB, in the cache
    key: str  # a digest of all it is made from
    nodes: tuple[tuple[str, str], ...]  # body and link of each; it is named "body/link"

    @property
    def node_names(self) -> tuple[str, ...]:
        """The names of the nodes, in their order."""
        return tuple(f"{body}/{link}" for body, link in self.nodes)


def scene_model(engine: PhysicsEngine) -> SceneModel:
    """Return the shapes of all bodies, written into the cache when they are not there yet.

    `SimulationError` where the cache cannot be written.
    """
    shapes = [
        (body, shape)
        for body in engine.bodies.names
        for shape in engine.rendering.visual_shapes(body)
        if shape.kind != "plane" and max(shape.size) > LEAST_SIZE
    ]
    nodes = tuple(dict.fromkeys((body, shape.link) for body, shape in shapes))
    files = sorted({shape.file for _, shape in shapes if shape.kind == "mesh"})
    what = [(body, shape, shape.link_from_shape.tobytes()) for body, shape in shapes]
    key = content_key(_VERSION, repr(what).encode(), *(file.read_bytes() for file in files))
    path = cache_folder() / "scenes" / f"{key}.glb"
    return SceneModel(cached(path, lambda draft: _write(shapes, draft)), key, nodes)


def pose_frame(engine: PhysicsEngine, nodes: Sequence[tuple[str, str]], *, scene: int) -> bytes:
    """Return where links are now, in the order of `nodes` (body and link).

    `scene` is the number of the scene, modulo 65536. `UnknownNameError` for another body.
    """
    found = np.array([engine.bodies.place_of(*node) for node in nodes], dtype="<f4")
    return _HEAD.pack(KIND, VERSION, scene % 65536, engine.steps * TIME_STEP) + found.tobytes()


def _write(shapes: Sequence[tuple[str, VisualShape]], path: Path) -> None:
    scene: Any = trimesh.Scene()
    for number, (body, shape) in enumerate(shapes):
        node = f"{body}/{shape.link}"
        scene.graph.update(frame_to=node, matrix=np.eye(4))
        scene.add_geometry(_mesh(shape), node_name=f"{node}#{number}", parent_node_name=node)
    path.write_bytes(scene.export(file_type="glb", include_normals=True))


def _mesh(shape: VisualShape) -> Trimesh:
    mesh = _surface(shape).apply_transform(shape.link_from_shape)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    if len(mesh.faces) > MOST_FACES:
        mesh = mesh.simplify_quadric_decimation(face_count=MOST_FACES)
    smooth: Trimesh = trimesh.graph.smooth_shade(mesh, angle=meshes.CREASE, facet_minarea=None)
    screen = np.array(shape.colour[:3])  # sRGB; glTF has linear colours
    linear = np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)
    rgba = [*linear, shape.colour[3]]
    material = PBRMaterial(baseColorFactor=rgba, roughnessFactor=ROUGHNESS, metallicFactor=METALLIC)
    return Trimesh(
        vertices=np.round(smooth.vertices / GRID) * GRID,
        faces=smooth.faces,
        vertex_normals=np.round(smooth.vertex_normals / NORMAL_GRID) * NORMAL_GRID,
        visual=TextureVisuals(material=material),
        process=False,
    )


def _surface(shape: VisualShape) -> Trimesh:
    length, radius, _ = shape.size
    match shape.kind:
        case "box":
            return trimesh.creation.box(shape.size)
        case "sphere":
            return trimesh.creation.icosphere(subdivisions=3, radius=shape.size[0])
        case "cylinder":
            return trimesh.creation.cylinder(radius, length)
        case "capsule":
            return trimesh.creation.capsule(length, radius)
        case _:
            mesh: Any = trimesh.load(shape.file, force="mesh", process=False, skip_materials=True)
            return Trimesh(mesh.vertices, mesh.faces, process=False).apply_scale(shape.size)
