"""A scene as a binary glTF file (GLB), in which every link that can be seen is one node.

The meshes stand in the frames of their links, and the nodes at the origin: where they are in the
world is told by `pose_frames`. The axes are those of the world, z up. Meshes of many triangles,
those of arms, are reduced by quadric error metrics (Garland and Heckbert 1997).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...ontology.disk_cache import cache_folder, cached, content_key
from ...ontology.errors import extra_required
from ..models import meshes
from ..physics.engine import PhysicsEngine
from ..physics.rendering import VisualShape
from ..poses import Array

with extra_required("sim", "trimesh"):
    import trimesh
    from trimesh import Trimesh
    from trimesh.exchange.gltf import export_glb
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

MOST_FACES = 2500  # of one mesh
GRID = 2.0**-16  # [m], to which corners are rounded, so that they compress
NORMAL_GRID = 2.0**-8
LEAST_SIZE = 1e-4  # [m]; the simulator's invisible specks are smaller
ROUGHNESS, METALLIC = 0.65, 0.05
_VERSION = b"1"  # of the files that this module writes


@dataclass(frozen=True)
class SceneModel:
    """The shapes of all bodies of a scene.

    Attributes:
        file: the GLB file, in the cache.
        key: a digest of all it is made from.
        nodes: body and link of each node; a node is named "body/link".
    """

    file: Path
    key: str
    nodes: tuple[tuple[str, str], ...]

    @property
    def node_names(self) -> tuple[str, ...]:
        """The names of the nodes, in their order."""
        return tuple(f"{body}/{link}" for body, link in self.nodes)


def scene_model(engine: PhysicsEngine) -> SceneModel:
    """Return the shapes of all bodies, written into the cache when they are not there yet.

    `SimulationError` where the cache cannot be written.
    """
    shapes = list(_visible_shapes(engine))
    nodes = tuple(dict.fromkeys((body, shape.link) for body, shape in shapes))
    key = _key(shapes)
    path = cache_folder() / "scenes" / f"{key}.glb"
    return SceneModel(cached(path, lambda draft: _write(shapes, draft)), key, nodes)


def _visible_shapes(engine: PhysicsEngine) -> Iterator[tuple[str, VisualShape]]:
    for body in engine.bodies.names:
        for shape in engine.rendering.visual_shapes(body):
            if shape.kind != "plane" and max(shape.size) > LEAST_SIZE:
                yield body, shape


def _key(shapes: Sequence[tuple[str, VisualShape]]) -> str:
    files = sorted({shape.file for _, shape in shapes if shape.kind == "mesh"})
    what = [(body, shape, shape.link_from_shape.tobytes()) for body, shape in shapes]
    return content_key(_VERSION, repr(what).encode(), *(path.read_bytes() for path in files))


def _write(shapes: Sequence[tuple[str, VisualShape]], path: Path) -> None:
    scene = trimesh.Scene()
    for number, (body, shape) in enumerate(shapes):
        node = f"{body}/{shape.link}"
        scene.graph.update(frame_to=node, matrix=np.eye(4))
        scene.add_geometry(_mesh(shape), node_name=f"{node}#{number}", parent_node_name=node)
    path.write_bytes(export_glb(scene, include_normals=True))


def _mesh(shape: VisualShape) -> Trimesh:
    mesh = _reduced(_surface(shape).apply_transform(shape.link_from_shape))
    smooth: Trimesh = trimesh.graph.smooth_shade(mesh, angle=meshes.CREASE, facet_minarea=None)
    return Trimesh(
        vertices=_rounded(smooth.vertices, GRID),
        faces=smooth.faces,
        vertex_normals=_rounded(smooth.vertex_normals, NORMAL_GRID),
        visual=TextureVisuals(material=_material(shape.colour)),
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


def _reduced(mesh: Trimesh) -> Trimesh:
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    if len(mesh.faces) <= MOST_FACES:
        return mesh
    return mesh.simplify_quadric_decimation(face_count=MOST_FACES)


def _rounded(numbers: Array, grid: float) -> Array:
    return np.round(numbers / grid) * grid


def _material(colour: Sequence[float]) -> PBRMaterial:
    screen = np.array(colour[:3])  # sRGB; glTF has linear colours
    linear = np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)
    return PBRMaterial(
        baseColorFactor=[*linear, colour[3]], roughnessFactor=ROUGHNESS, metallicFactor=METALLIC
    )
