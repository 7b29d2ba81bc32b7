"""Spheres that contain the links of a robot, for collision checks, from its URDF file.

As in the engine, the convex hull of a collision shape counts. Spheres round points inside it stand
out of it by `BULGE`; some that cover its surface are chosen by greedy set cover: next comes the
place that the fewest spheres reach, and of these spheres the one that covers most of the rest.
"""

from collections.abc import Collection
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ...ontology.disk_cache import content_key, kept
from ...ontology.errors import DataError
from .. import poses
from ..models.urdf import child_attribute, origin_pose, read_urdf
from ..poses import Array, squared_distances, voxel_downsample

BULGE, SLACK = 0.014, 0.001  # [m] of a sphere over the hull; of that, for what is between places
SAMPLES = 1800  # in units of the square of the bulge, a larger surface has larger bulges
SPACING, STEP = 0.5, 0.7  # of places to cover and of centres, in units of the bulge
ROUND = 1.005  # polyhedra contain the round shapes that they stand for


def fit_spheres(file: Path, links: Collection[str], *, apart: Collection[str]) -> dict[str, Array]:
    """Return centres and radii (n, 4) [m] of spheres that contain each of the links, in its frame.

    What hangs on a link, with joints at zero, belongs to it, but for links `apart` and what hangs
    on those. They are kept in the cache; `DataError` where a shape cannot be read.
    """
    root = read_urdf(file)
    meshes = {Path(each.get("filename", "")) for each in root.iterfind("link/collision//mesh")}
    files = [file, Path(__file__), *filter(Path.is_file, meshes)]

    def fit() -> dict[str, Array]:
        above = {child_attribute(each, "child", "link"): each for each in root.findall("joint")}
        spheres = {link: [np.zeros((0, 4))] for link in links}
        for element in root.findall("link"):
            name, at = element.get("name", ""), np.eye(4)
            while name in above and name not in links and name not in apart:
                at = origin_pose(above[name]) @ at
                name = child_attribute(above[name], "parent", "link")
            for shape in element.findall("collision") if name in links else ():
                try:
                    corners = _corners(shape.findall("geometry/*")[0])
                    spheres[name].append(cover(poses.transform(at @ origin_pose(shape), corners)))
                except Exception as error:  # each of the readers of meshes has errors of its own
                    what = f'the collision shape of "{element.get("name")}" is of no use: {error}.'
                    raise DataError(what, source=str(file)) from error
        return {link: np.concatenate(found) for link, found in spheres.items()}

    return kept(f"spheres-{content_key(repr((links, apart)).encode())}", files, fit)


def cover(points: Array) -> Array:
    """Return centres and radii (n, 4) [m] of spheres that contain the hull of points (k, 3)."""
    from trimesh import convex, remesh  # here: they take 0.3 s to import

    hull = convex.convex_hull(points)
    bulge = max(BULGE, (hull.area / SAMPLES) ** 0.5)
    surface = remesh.subdivide_to_size(hull.vertices, hull.faces, SPACING * bulge, 30)[0]
    sample = surface[voxel_downsample(surface, SPACING * bulge)]
    counts = np.ceil(hull.extents / (STEP * bulge)).astype(int) + 2
    low, high = hull.bounds
    axes = [np.linspace(*each) for each in zip(low, high, counts, strict=True)]
    grid = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    offset = np.einsum("ij,ij->i", hull.face_normals, hull.triangles[:, 0])
    depth = (offset - grid @ hull.face_normals.T).min(axis=1)
    # Spheres round the places themselves reach what no other one does.
    centre = np.vstack([grid[depth > 0], sample])
    radius = np.concatenate([depth[depth > 0], np.zeros(len(sample))]) + bulge
    chosen = _chosen(squared_distances(centre, sample) <= (radius[:, None] - SLACK) ** 2)
    centre, radius = centre[chosen], radius[chosen]
    gaps = np.sqrt(squared_distances(surface, centre)) - radius
    return np.column_stack([centre, radius + max(0.0, gaps.min(axis=1).max())])


def _chosen(covers: np.ndarray) -> list[int]:
    """Return rows of a matrix (spheres, places) that together cover all places."""
    weight, rarity, chosen = covers.astype(np.float32), covers.sum(axis=0), list[int]()
    while (left := np.flatnonzero(~covers[chosen].any(axis=0))).size:
        rows = np.flatnonzero(covers[:, left[rarity[left].argmin()]])
        chosen.append(int(rows[weight[np.ix_(rows, left)].sum(axis=1).argmax()]))
    return chosen


def _corners(form: ElementTree.Element) -> Array:
    """Return points (n, 3) [m] whose hull contains the geometry of a collision shape."""
    import trimesh

    size = {k: np.array(v.split(), float) for k, v in form.items() if k != "filename"}
    radius, length = ROUND * size.get("radius", np.ones(1)), size.get("length", np.ones(1))
    match form.tag:
        case "box":
            mesh = trimesh.creation.box(size["size"])
        case "sphere":
            mesh = trimesh.creation.icosphere(3, *radius)
        case "cylinder":
            mesh = trimesh.creation.cylinder(*radius, *length)
        case "capsule":  # an extension of PyBullet's
            mesh = trimesh.creation.capsule(*length, *radius)
        case _:
            mesh = trimesh.load_mesh(form.get("filename", ""))
    return np.asarray(mesh.vertices) * size.get("scale", 1.0)
