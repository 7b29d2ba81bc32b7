"""Objects from URDF and MJCF files, which MuJoCo's compiler reads: each link or geom is a part."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from trimesh import Trimesh, creation

from ...ontology.errors import DataError, UnknownNameError, extra_required
from ...ontology.yaml_reader import read_text

with extra_required("sim", "mujoco-core"):
    mujoco: Any = __import__("mujoco")  # which has no types

COLOURS = ("#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#b07aa1")  # of what is grey in the file
FRICTION = {1.0: 0.6}  # MuJoCo's, where the file has none: as of plastic


def import_object(
    path: Path, out: Path, links: Mapping[str, str], roles: Mapping[str, str], **kind: Any
) -> None:
    """Write the object of a URDF or MJCF file as a file of objects; `kind` is its name and is_a.

    `links` has the part of a link, body or geom; all others are the part "body". When it is empty,
    each is a part; a part's role is "base" by default. Shapes become OBJ files in a folder beside
    `out`, in the object's frame, with joints at zero. What can only be seen is left out. DataError
    for what cannot be used; UnknownNameError for a name that is not there.
    """
    spec, data = _compiled(path)
    known = {each.name for each in (*spec.bodies, *spec.geoms)} - {""}
    for link in links.keys() - known:
        raise UnknownNameError("link, body or geom", link, known)
    (meshes := out.with_name(f"{out.stem}_meshes")).mkdir(parents=True, exist_ok=True)
    materials, parts = dict[str, Any](), dict[str, Any]()
    for geom, surface, mass in _solids(spec, data):
        named = [links[each] for each in (geom.name, geom.parent.name) if each in links]
        own = geom.parent.name if path.suffix == ".urdf" else geom.name or geom.parent.name
        name = (named or ["body"])[0] if links else " ".join(re.findall(r"[^\W_]+", own)).lower()
        friction = round(FRICTION.get(geom.friction[0], float(geom.friction[0])), 3)
        materials[f"friction {friction}"] = {"friction": friction, "shine": 0.3}
        rgba = (255 * (spec.material(geom.material) or geom).rgba[:3]).astype(int).tolist()
        colour = "#" + bytes(rgba).hex() if len({*rgba}) > 1 else COLOURS[len(parts) % 5]
        new = {"role": roles.get(name, "base"), "material": f"friction {friction}"}
        part = parts.setdefault(name, {**new, "colour": colour, "mass": 0.0, "shape": []})
        part["mass"] = round(part["mass"] + mass, 6)
        part["shape"].append({"mesh": {"file": f"{meshes.name}/{geom.id}.obj"}})
        surface.export(meshes / f"{geom.id}.obj", header=None)
    for name in roles.keys() - parts:
        raise UnknownNameError("part", name, parts)
    kind |= {"parts": parts, "rests": {"as imported": {"turn_deg": [0, 0, 0]}}}
    document = {"materials": materials, "objects": {kind.pop("name"): kind}}
    out.write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")


def _compiled(path: Path) -> tuple[Any, Any]:
    text = read_text(path)
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        for mesh in spec.meshes:
            file = mesh.file.removeprefix("package://")
            above = (each / file for each in path.absolute().parents)
            mesh.file = str(next((each for each in above if each.is_file()), file))
        spec.compiler.fusestatic, spec.compiler.balanceinertia = False, True
        spec.compiler.boundmass = spec.compiler.boundinertia = 1e-9  # links may have no mass
        data = mujoco.MjData(spec.compile())
    except (ValueError, mujoco.FatalError) as error:
        problem, rows = " ".join(str(error).split()), enumerate(text.splitlines(), start=1)
        told, name = re.search(r"ine (?:number=)?(\d+)", problem), re.search("'(.+?)'", problem)
        lines = [int(told[1])] if told else [n for n, row in rows if name and name[1] in row]
        raise DataError(f"{problem}.", source=str(path), line=[*lines, 0][0]) from error
    mujoco.mj_kinematics(data.model, data)
    return spec, data


def _solids(spec: Any, data: Any) -> list[tuple[Any, Trimesh, float]]:
    """Return each geom with its surface, and its mass [kg] as a share in that of its body."""
    geoms = [g for g in spec.geoms if (g.contype or g.conaffinity) and g.type.value > 1]  # no plane
    solids = [(geom, _surface(data, geom.id)) for geom in geoms]
    weights = [g.density * abs(s.volume) if np.isnan(g.mass) else g.mass for g, s in solids]
    bodies, weights = np.array([g.parent.id for g in geoms], int), np.maximum(weights, 1e-9)
    masses = data.model.body_mass[bodies] * weights / np.bincount(bodies, weights)[bodies]
    return [(*solid, float(mass)) for solid, mass in zip(solids, masses, strict=True)]


def _surface(data: Any, number: int) -> Trimesh:
    model, kind = data.model, mujoco.mjtGeom(data.model.geom_type[number]).name
    size = model.geom_size[number]
    if kind == "mjGEOM_MESH":
        mesh = model.mesh(model.geom_dataid[number])
        corners, faces = model.mesh_vert[mesh.vertadr[0] :], model.mesh_face[mesh.faceadr[0] :]
        found = Trimesh(corners[: mesh.vertnum[0]], faces[: mesh.facenum[0]])
    elif kind == "mjGEOM_BOX":
        found = creation.box(2 * size)
    elif kind == "mjGEOM_CYLINDER":
        found = creation.cylinder(size[0], 2 * size[1])
    elif kind == "mjGEOM_CAPSULE":
        found = creation.capsule(2 * size[1], size[0])
    else:  # a sphere has one radius, an ellipsoid three
        found = creation.icosphere().apply_scale(np.where(size, size, size[0]))
    turned = found.vertices @ data.geom_xmat[number].reshape(3, 3).T
    found.vertices = turned + data.geom_xpos[number] - data.xpos[:2][-1]
    return found
