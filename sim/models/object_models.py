# SPDX-License-Identifier: Apache-2.0
"""Models: object types as files that the simulator loads, built once and kept.

Each part becomes one link of a URDF, named after the part and fixed to the first one; all links
share the frame of the object. A model is kept in a folder named after a hash of all it depends on,
written under another name first and renamed when complete, so that processes that build the same
model at the same time cannot spoil each other's files.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np

from ...ontology.errors import SimulationError
from ...ontology.geometry import Colour, MeshFile
from ...ontology.objects import ObjectType, PartType
from .. import poses
from ..poses import Array
from .cache import cache_folder, content_key

if TYPE_CHECKING:
    from .solids import Shape

_NUMBERS_FILE = "numbers.npz"
_URDF_FILE, _MOUNTED_FILE = "model.urdf", "mounted.urdf"
SOCKET, INTO = "socket", "into"  # link and joint of a thing that stands in another one
_SOCKET_MASS = 0.05  # [kg], of the wood right round a nail: far less would make the solver soft
_ELEVATION = np.radians(40)  # of a camera above the table
_DIRECTIONS = 8  # of equal distance round the object
_CELL = 0.0015  # [m], small against any part
_MOST_POINTS = 300_000  # enough for all that fits into a hand
# A link without any visual would be drawn by what is felt of it; a speck keeps it unseen.
_SPECK = "    <visual><geometry><box size='1e-5 1e-5 1e-5'/></geometry></visual>"
_SOURCES = ("convex.py", "meshes.py", "object_models.py", "solids.py", "../poses.py")


@dataclass(frozen=True)
class Model:
    """An object type as the simulator knows it.

    Attributes:
        kind: the object type.
        urdf: its description, with meshes beside it.
        corners: part -> corners of all its convex pieces (n, 3), in the object's frame [m].
        silhouette: the area that it shows to a camera above the table, on average [m^2].
    """

    kind: ObjectType
    urdf: Path
    corners: Mapping[str, Array]
    silhouette: float

    @property
    def mounted(self) -> Path:
        """Its description as it stands in another object, on a joint that lets it go deeper."""
        return self.urdf.with_name(_MOUNTED_FILE)

    @property
    def points(self) -> Array:
        """Corners of all parts together (n, 3), in the object's frame [m]."""
        return np.vstack(list(self.corners.values()))


def model_of(kind: ObjectType, *, cache: Path | None = None) -> Model:
    """The model of an object type, built when it is not kept yet.

    Args:
        kind: the object type.
        cache: folder where models are kept; `cache_folder()` when None.
    """
    folder = (cache or cache_folder()) / "objects" / f"{_stem(kind.name)}-{_key(kind)}"
    if not folder.is_dir():
        _publish(kind, folder)
    with np.load(folder / _NUMBERS_FILE) as kept:
        corners = {name: kept[f"part{i}"] for i, name in enumerate(kind.parts)}
        silhouette = float(kept["silhouette"])
    return Model(kind, folder / _URDF_FILE, corners, silhouette)


def _stem(name: str) -> str:
    """A name as it may stand in a path: what a user calls an object need not be a file name."""
    return re.sub(r"[^A-Za-z0-9]+", "_", name)


def _key(kind: ObjectType) -> str:
    here = Path(__file__).parent
    files = (
        s.form.path for p in kind.parts.values() for s in p.shape if isinstance(s.form, MeshFile)
    )
    sources = [here / name for name in _SOURCES]
    # Only what the files depend on: a set, as of properties, reads differently in each process.
    parts = [(p.name, p.material, p.colour, p.mass, p.shape) for p in kind.parts.values()]
    what = repr((kind.name, parts, kind.rests, kind.mount))
    return content_key(what.encode(), *(path.read_bytes() for path in (*sources, *files)))


def _publish(kind: ObjectType, folder: Path) -> None:
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=".draft-", dir=folder.parent))
        try:
            write_model(kind, draft)
            _rename(draft, folder)
        finally:
            shutil.rmtree(draft, ignore_errors=True)
    except OSError as error:
        raise SimulationError(
            f"The cache {folder.parent} cannot be written: {error.strerror}. "
            "Set HILT_CACHE to a folder that can."
        ) from error


def _rename(draft: Path, folder: Path) -> None:
    try:
        draft.rename(folder)
    except OSError:
        if not folder.is_dir():  # else another process was first: its files are the same
            raise


def write_model(kind: ObjectType, folder: Path) -> None:
    """Build a model and write its files into a folder."""
    from . import solids  # scipy's geometry costs 0.2 s: only when building

    built = {name: [solids.build(s) for s in part.shape] for name, part in kind.parts.items()}
    parts = kind.parts.values()
    links = [
        _write_link(part, built[part.name], f"part{i}", folder) for i, part in enumerate(parts)
    ]
    first, *others = kind.parts
    joints = [
        f"  <joint name={quoteattr(f'{first} to {name}')} type='fixed'>"
        f"<parent link={quoteattr(first)}/><child link={quoteattr(name)}/></joint>"
        for name in others
    ]
    _write_urdf(kind, [*links, *joints], folder / _URDF_FILE)
    if kind.mount is not None:
        socket = _socket(first, kind.mount.deepest - kind.mount.depth)
        _write_urdf(kind, [*socket, *links, *joints], folder / _MOUNTED_FILE)
    _write_numbers(kind, built, folder)


def _write_urdf(kind: ObjectType, elements: Sequence[str], path: Path) -> None:
    opening = ["<?xml version='1.0'?>", f"<robot name={quoteattr(kind.name)}>"]
    path.write_text("\n".join([*opening, *elements, "</robot>", ""]), encoding="utf-8")


def _socket(part: str, travel: float) -> list[str]:
    """What a mounted thing slides in: a link without a surface, and the joint."""
    inertia = np.eye(3) * _SOCKET_MASS * 1e-3  # as of a lump of 3 cm radius
    return [
        f"  <link name='{SOCKET}'>",
        _inertial(_SOCKET_MASS, np.zeros(3), inertia),
        _SPECK,
        "  </link>",
        f"  <joint name='{INTO}' type='prismatic'>",
        f"    <parent link='{SOCKET}'/><child link={quoteattr(part)}/><axis xyz='0 0 -1'/>",
        f"    <limit lower='0' upper='{travel:g}' effort='1000' velocity='10'/>",
        "  </joint>",
    ]


def _write_numbers(kind: ObjectType, built: Mapping[str, Sequence[Shape]], folder: Path) -> None:
    rest = poses.rotation_from_rpy(*kind.rests[0].turn)
    surfaces = [each.surface for shapes in built.values() for each in shapes if each.surface]
    numbers = {
        f"part{i}": np.vstack([piece for shape in shapes for piece in shape.pieces])
        for i, shapes in enumerate(built.values())
    }
    numbers["silhouette"] = np.array(
        _mean_silhouette([m.vertices[m.faces] @ rest.T for m in surfaces])
    )
    np.savez_compressed(folder / _NUMBERS_FILE, allow_pickle=False, **numbers)


def _mean_silhouette(surfaces: Sequence[Array]) -> float:
    """The area that triangles (n, 3, 3) show, on average over directions from above [m^2]."""
    if not surfaces:
        return 0.0
    points = _spread_points(np.vstack(surfaces))
    areas: list[float] = []
    for azimuth in np.arange(_DIRECTIONS) * 2 * np.pi / _DIRECTIONS:
        ahead = poses.rotation_from_rpy(0, _ELEVATION - np.pi / 2, azimuth)
        cells = np.floor((points @ ahead)[:, :2] / _CELL).astype(np.int64)
        cells -= cells.min(axis=0)
        shown = np.zeros(cells.max(axis=0) + 1, dtype=bool)
        shown[tuple(cells.T)] = True
        areas.append(int(shown.sum()) * _CELL**2)
    return float(np.mean(areas))


def _spread_points(triangles: Array) -> Array:
    """Points (n, 3) all over triangles, about ten for each cell that they cover."""
    sides = triangles[:, 1:] - triangles[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    count = min(int(10 * areas.sum() / _CELL**2), _MOST_POINTS)
    rng = np.random.default_rng(0)  # the points only stand for the surface: any will do
    chosen = rng.choice(len(triangles), count, p=areas / areas.sum())
    shares = rng.random((count, 2))
    beyond = shares.sum(axis=1) > 1
    shares[beyond] = 1 - shares[beyond]
    return triangles[chosen, 0] + np.einsum("ns,nsc->nc", shares, sides[chosen])


def _write_link(part: PartType, built: Sequence[Shape], stem: str, folder: Path) -> str:
    """Write the meshes of one part; its URDF link."""
    from . import convex, meshes

    pieces = [piece for shape in built for piece in shape.pieces]
    shrunk = [convex.hull(convex.shrink(piece, convex.MARGIN)) for piece in pieces]
    (folder / f"{stem}_felt.obj").write_text(meshes.grouped_obj(shrunk), encoding="ascii")
    visuals: list[str] = []
    for number, (solid, shape) in enumerate(zip(part.shape, built, strict=True)):
        if shape.surface is not None:
            file = f"{stem}_seen{number}.obj"
            (folder / file).write_text(meshes.shaded_obj(shape.surface), encoding="ascii")
            visuals.append(_visual(part, file, solid.colour or part.colour, f"{stem} {number}"))
    centre, inertia = convex.mass_properties(pieces, part.mass)
    lines = [
        f"  <link name={quoteattr(part.name)}>",
        f"    <contact><lateral_friction value='{part.material.friction:g}'/></contact>",
        _inertial(part.mass, centre, inertia),
        *(visuals or [_SPECK]),
        f"    <collision><geometry><mesh filename='{stem}_felt.obj'/></geometry></collision>",
        "  </link>",
    ]
    return "\n".join(lines)


def _visual(part: PartType, file: str, colour: Colour, name: str) -> str:
    shine = part.material.shine
    return (
        f"    <visual><geometry><mesh filename='{file}'/></geometry><material name='{name}'>"
        f"<color rgba='{_numbers((*colour, 1.0))}'/><specular rgb='{_numbers([shine] * 3)}'/>"
        "</material></visual>"
    )


def _inertial(mass: float, centre: Array, inertia: Array) -> str:
    names = (
        ("ixx", 0, 0),
        ("ixy", 0, 1),
        ("ixz", 0, 2),
        ("iyy", 1, 1),
        ("iyz", 1, 2),
        ("izz", 2, 2),
    )
    terms = " ".join(f"{name}='{inertia[i, j]:.9g}'" for name, i, j in names)
    return (
        f"    <inertial><origin xyz='{_numbers(centre)}'/><mass value='{mass:g}'/>"
        f"<inertia {terms}/></inertial>"
    )


def _numbers(values: Sequence[float] | Array) -> str:
    return " ".join(f"{value:.6g}" for value in values)
