# SPDX-License-Identifier: Apache-2.0
"""Models: object types as files that the simulator loads, built once and kept.

Each part becomes one link of a URDF, named after the part and fixed to the first one; all links
share the frame of the object. A model is kept in a folder named after a hash of all it depends on,
written under another name first and renamed when complete, so that processes that build the same
model at the same time cannot spoil each other's files.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from ..ontology.objects import ObjectType, PartType
from ..ontology.solids import Colour, MeshFile
from .poses import Array

_CORNERS_FILE = "corners.npz"
_URDF_FILE = "model.urdf"
_SOURCES = ("convex.py", "meshes.py", "models.py", "poses.py", "shapes.py")


@dataclass(frozen=True)
class Model:
    """An object type as the simulator knows it.

    Attributes:
        kind: the object type.
        urdf: its description, with meshes beside it.
        corners: part -> corners of all its convex pieces (n, 3), in the object's frame [m].
    """

    kind: ObjectType
    urdf: Path
    corners: Mapping[str, Array]

    @property
    def points(self) -> Array:
        """Corners of all parts together (n, 3), in the object's frame [m]."""
        return np.vstack(list(self.corners.values()))


def cache_folder() -> Path:
    """Where models are kept: HILT_CACHE, or a folder in the user's cache directory."""
    chosen = os.environ.get("HILT_CACHE")
    if chosen:
        return Path(chosen)
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(base) if base else Path.home() / ".cache") / "hilt"


def model_of(kind: ObjectType, *, cache: Path | None = None) -> Model:
    """The model of an object type, built when it is not kept yet.

    Args:
        kind: the object type.
        cache: folder where models are kept; `cache_folder()` when None.
    """
    folder = (cache or cache_folder()) / f"{kind.name.replace(' ', '_')}-{_digest(kind)}"
    if not folder.is_dir():
        _publish(kind, folder)
    with np.load(folder / _CORNERS_FILE) as kept:
        corners = {name: kept[name] for name in kind.parts}
    return Model(kind, folder / _URDF_FILE, corners)


def _digest(kind: ObjectType) -> str:
    here = Path(__file__).parent
    ingredients = [repr(kind.parts).encode(), *((here / name).read_bytes() for name in _SOURCES)]
    for part in kind.parts.values():
        files = (solid.form.path for solid in part.shape if isinstance(solid.form, MeshFile))
        ingredients += [file.read_bytes() for file in files]
    return sha256(b"\0".join(ingredients)).hexdigest()[:16]


def _publish(kind: ObjectType, folder: Path) -> None:
    folder.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(prefix=".draft-", dir=folder.parent))
    try:
        write_model(kind, draft)
        try:
            draft.rename(folder)
        except OSError:
            if not folder.is_dir():  # else another process was first: its files are the same
                raise
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def write_model(kind: ObjectType, folder: Path) -> None:
    """Build a model and write its files into a folder."""
    links = [_write_link(part, f"part{i}", folder) for i, part in enumerate(kind.parts.values())]
    first, *others = kind.parts
    joints = [
        f"  <joint name={quoteattr(f'{first} to {name}')} type='fixed'>"
        f"<parent link={quoteattr(first)}/><child link={quoteattr(name)}/></joint>"
        for name in others
    ]
    lines = ["<?xml version='1.0'?>", f"<robot name={quoteattr(kind.name)}>"]
    lines += [link for link, _ in links] + joints + ["</robot>", ""]
    (folder / _URDF_FILE).write_text("\n".join(lines), encoding="utf-8")
    corners = {name: points for name, (_, points) in zip(kind.parts, links, strict=True)}
    np.savez_compressed(folder / _CORNERS_FILE, allow_pickle=False, **corners)


def _write_link(part: PartType, stem: str, folder: Path) -> tuple[str, Array]:
    """Write the meshes of one part; its URDF link and the corners of its pieces."""
    from . import convex, meshes, shapes  # scipy's geometry costs 0.2 s: only when building

    built = [shapes.build(solid) for solid in part.shape]
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
        *visuals,
        f"    <collision><geometry><mesh filename='{stem}_felt.obj'/></geometry></collision>",
        "  </link>",
    ]
    return "\n".join(lines), np.vstack(pieces)


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
