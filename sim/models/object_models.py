"""Object models: the files by which the simulator knows an object type, built once and cached.

Each part becomes one link of a URDF, named after the part and fixed to the first one; all links
share the frame of the object. A model is kept in a folder named after a hash of all it depends on.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely

from ...ontology.disk_cache import cache_folder, cached, content_key
from ...ontology.objects import ObjectType, PartType
from ...ontology.part_shapes import MeshFile
from .. import poses
from ..poses import Array
from . import urdf

if TYPE_CHECKING:
    from .solids import SolidGeometry

_NUMBERS_FILE = "numbers.npz"
_URDF_FILE, _MOUNTED_FILE = "model.urdf", "mounted.urdf"
_ELEVATION = np.radians(40)  # of a camera above the table
_DIRECTIONS = 8  # of equal distance round the object
_SOURCES = ("meshes.py", "object_models.py", "solids.py", "urdf.py", "../poses.py")


@dataclass(frozen=True)
class ObjectModel:
    """An object type as the simulator knows it."""

    kind: ObjectType
    urdf: Path  #: its URDF file, with the meshes beside it
    corners: Mapping[str, Array]  #: of each part's pieces (n, 3), in the object's frame [m]
    silhouette: float  #: mean area that it shows to a camera above the table [m^2]

    @property
    def mounted(self) -> Path:
        """Its description as it stands in another object, on a joint that lets it go deeper."""
        return self.urdf.with_name(_MOUNTED_FILE)

    @property
    def points(self) -> Array:
        """Corners of all parts together (n, 3), in the object's frame [m]."""
        return np.vstack(list(self.corners.values()))


def object_model(kind: ObjectType, *, cache: Path | None = None) -> ObjectModel:
    """Return the model of an object type, from the cache (a folder), or built; errors as there."""
    here = Path(__file__).parent
    forms = [solid.form for part in kind.parts.values() for solid in part.shape]
    files = [form.path for form in forms if isinstance(form, MeshFile)]
    # Only what the files depend on: a set, as of properties, reads differently in each process.
    parts = [(p.name, p.material, p.colour, p.mass, p.shape) for p in kind.parts.values()]
    what = repr((kind.name, parts, kind.rests, kind.mount))
    read = (path.read_bytes() for path in (*(here / name for name in _SOURCES), *files))
    stem = re.sub(r"[^A-Za-z0-9]+", "_", kind.name)  # a user's name need not be a file name
    name = f"{stem}-{content_key(what.encode(), *read)}"
    folder = (cache or cache_folder()) / "objects" / name
    cached(folder, lambda draft: write_model(kind, draft))
    with np.load(folder / _NUMBERS_FILE) as kept:
        corners = {name: kept[f"part{i}"] for i, name in enumerate(kind.parts)}
        silhouette = float(kept["silhouette"])
    return ObjectModel(kind, folder / _URDF_FILE, corners, silhouette)


def write_model(kind: ObjectType, folder: Path) -> None:
    """Build a model and write its files into a new folder."""
    from . import solids  # with scipy and trimesh, which take a second to import

    folder.mkdir()
    parts = kind.parts.values()
    built = {part.name: [solids.build_solid(solid) for solid in part.shape] for part in parts}
    links = [_write_link(p, built[p.name], f"part{i}", folder) for i, p in enumerate(parts)]
    first, *others = kind.parts
    joints = [urdf.fixed_joint(first, name) for name in others]
    urdf.write_urdf(kind.name, [*links, *joints], folder / _URDF_FILE)
    if kind.mount is not None:
        socket = urdf.socket(first, kind.mount.deepest - kind.mount.depth)
        urdf.write_urdf(kind.name, [*socket, *links, *joints], folder / _MOUNTED_FILE)
    numbers = {
        f"part{i}": np.vstack([piece for each in geometries for piece in each.collision])
        for i, geometries in enumerate(built.values())
    }
    visible = [each for geometries in built.values() for each in geometries if each.visual]
    turn = poses.rotation_from_rpy(*kind.rests[0].turn)
    pieces = [piece @ turn.T for each in visible for piece in each.collision]
    numbers["silhouette"] = np.array(_mean_silhouette(pieces))
    np.savez_compressed(folder / _NUMBERS_FILE, allow_pickle=False, **numbers)


def _write_link(part: PartType, built: "Sequence[SolidGeometry]", stem: str, folder: Path) -> str:
    import trimesh

    from . import meshes

    pieces = [piece for geometry in built for piece in geometry.collision]
    shrunk = (trimesh.convex.convex_hull(meshes.shrink(each, meshes.MARGIN)) for each in pieces)
    collision = f"{stem}_collision.obj"
    trimesh.Scene(list(shrunk)).export(str(folder / collision), digits=7, header=None)
    visuals: list[str] = []
    for number, (solid, geometry) in enumerate(zip(part.shape, built, strict=True)):
        if geometry.visual is not None:
            file, material = f"{stem}_visual{number}.obj", f"{stem} {number}"
            (folder / file).write_text(meshes.shaded_obj(geometry.visual), encoding="ascii")
            colour = solid.colour or part.colour
            visuals.append(urdf.visual(file, material, colour, shine=part.material.shine))
    centre, inertia = meshes.mass_properties(pieces, part.mass)
    return urdf.part_link(part, collision, visuals, centre=centre, inertia=inertia)


def _mean_silhouette(pieces: Sequence[Array]) -> float:
    """Return the area that convex pieces (n, 3) show, averaged over directions from above [m^2]."""
    areas: list[float] = []
    for azimuth in np.arange(_DIRECTIONS) * 2 * np.pi / _DIRECTIONS:
        ahead = poses.rotation_from_rpy(0, _ELEVATION - np.pi / 2, azimuth)
        shadows = [shapely.MultiPoint((piece @ ahead)[:, :2]).convex_hull for piece in pieces]
        areas.append(shapely.union_all(shadows).area)
    return float(np.mean(areas))
