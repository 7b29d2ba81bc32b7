"""Grasps of an object in a point cloud: from any camera, for a real robot, without a simulator."""

from collections import Counter
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...ontology.errors import DataError, SimulationError, UnknownNameError
from .. import poses
from ..poses import Array, voxel_downsample
from ..robot.models import RobotType, find_robot
from ..robot.path_planner import FINGERS_EXCHANGED, RETREAT, Grasp
from .context import LabelledPointCloud, PointLabel
from .planner import COARSE_CELL, EFFORTS, FINE_CELL, MIN_POINTS, RankedGrasps, plan_grasps

MAX_EXTENT = 10.0  # [m] of what one camera sees in a room; more are other units
SOLID = 0.02  # [m] above the table, what is lower goes down to it: one view shows no undersides
RIGID = 1e-3  # by which the axes of a pose may be oblique


def grasps_on_cloud(
    points: Array,
    *,
    labels: Sequence[str] | None = None,
    part: str | None = None,
    others: Collection[str] = (),
    base_from_camera: Array | None = None,
    table: float | None = None,
    mass: float = 0.2,
    robot: str = "panda",
    seed: int = 0,
) -> RankedGrasps:
    """Plan grasps of an object by those of its points (n, 3) [m] that have the label `part`.

    Labels (n,) are names of parts; without a part any may be touched. `others` are labels of what
    is not the object's. It has a mass [kg] and stands on a table of that height [m]. Where the pose
    `base_from_camera` (4, 4) of the points is known, grasps are within reach, in the frame of the
    base; else in that of the points, where z is up. DataError for points that are too few, not
    finite or not in metres, UnknownNameError for labels without points and for robots,
    SimulationError for a robot without gripper.
    """
    if (kind := find_robot(robot)).gripper is None:
        raise SimulationError(f"The {kind.label} has no gripper.")
    at = np.eye(4) if base_from_camera is None else base_from_camera
    _check("points", points, (*points.shape[:1], 3))
    _check("base_from_camera", at, (4, 4))
    names = np.array([""] * len(points) if labels is None else labels)
    if len(names) != len(points):
        raise DataError(f"{len(names)} for {len(points)} points.", source="labels")
    seen, kinds = poses.transform(at, points), _sort(names, part, others)
    own = seen[kinds != PointLabel.NEIGHBOUR]
    centre = own[voxel_downsample(own, COARSE_CELL)].mean(axis=0)
    floor = -np.inf if table is None else table
    layers = seen - np.arange(0.0, SOLID, FINE_CELL)[:, None, None] * (0, 0, 1)  # (l, n, 3)
    kept = (layers[..., 2] > floor) & (seen[:, 2] < floor + SOLID)
    kept[0] = True
    kinds = np.broadcast_to(kinds, kept.shape)[kept]
    cloud = LabelledPointCloud(layers[kept], kinds, floor, centre, mass)
    rng, rejected, best = np.random.default_rng(seed), Counter[str](), tuple[Grasp, ...]()
    for effort, enough in EFFORTS.items():
        plan = plan_grasps(cloud, kind.gripper, rng=rng, effort=effort)
        is_placed, grip = base_from_camera is not None, kind.gripper.hand_from_grip
        found = _within_reach(plan.grasps, kind, grip) if is_placed else plan.grasps
        rejected.update(plan.rejected, unreachable=len(plan.grasps) - len(found))
        best = max(best, found, key=lambda grasps: grasps[0].score if grasps else 0.0)
        if best and best[0].score >= enough:
            break
    return RankedGrasps(best, dict((+rejected).most_common()))


def read_cloud(path: str | Path, pose: str | Path | None = None) -> dict[str, Array | list[str]]:
    """Read what `grasps_on_cloud` takes from an .npz file with these arrays, or from a .ply file.

    The points are always there, their `labels` and the pose `base_from_camera` maybe. Labels are
    text, or numbers with an array of `names`; in a .ply file they are the property `label`. A text
    file of 16 numbers may give the pose. DataError if a file cannot be read.
    """
    path = Path(path)
    try:
        found = _read_ply(path) if path.suffix.lower() == ".ply" else dict(np.load(path))
        if pose is not None:
            found["base_from_camera"] = np.loadtxt(pose).reshape(4, 4)
        numeric = [key for key in ("points", "base_from_camera") if key in found]
        arrays: dict[str, Array | list[str]] = {key: found[key].astype(float) for key in numeric}
    except Exception as error:  # readers have errors of their own for each way to be broken
        problem = str(error).rstrip(".")
        raise DataError(f"cannot be read as .npz or .ply: {problem}.", source=str(path)) from error
    if "points" not in arrays:
        raise DataError(f'has no "points". It has: {", ".join(found)}.', source=str(path))
    if "labels" in found:
        names = dict(enumerate(np.ravel(found.get("names", ())).tolist()))
        labels = np.ravel(found["labels"]).tolist()
        arrays["labels"] = [str(names.get(each, each)) for each in labels]
    return arrays


def _read_ply(path: Path) -> dict[str, Any]:
    import trimesh

    mesh: Any = trimesh.load(path, process=False)
    vertex = mesh.metadata["_ply_raw"]["vertex"]
    columns = {key: np.ravel(vertex["data"][key]) for key in vertex["properties"]}
    points = np.column_stack([columns[axis] for axis in "xyz"])
    return {"points": points, **({"labels": columns["label"]} if "label" in columns else {})}


def _check(name: str, array: Array, shape: tuple[int, ...]) -> None:
    problem = ""
    if array.shape != shape:
        problem = f"has the shape {array.shape}; expected {shape}."
    elif wrong := int(np.count_nonzero(~np.isfinite(array).all(axis=1))):
        problem = f"{wrong} of {len(array)} rows are not finite; leave them out."
    elif (extent := np.abs(array - array[:1]).max(initial=0.0)) > MAX_EXTENT:
        problem = f"spans {extent:.4g} m; expected at most {MAX_EXTENT:g} m. Is it in millimetres?"
    elif shape == (4, 4):
        one = np.linalg.det(array) * poses.inverse(array) @ array
        problem = "" if np.allclose(one, np.eye(4), atol=RIGID) else "is not a rigid motion."
    if problem:
        raise DataError(problem, source=name)


def _sort(names: np.ndarray, part: str | None, others: Collection[str]) -> np.ndarray:
    known = set(names.tolist()) - {""}
    if missing := [name for name in (*others, part) if name is not None and name not in known]:
        raise UnknownNameError("label", missing[0], known)
    result = np.where((names == part) | (part is None), PointLabel.TARGET, PointLabel.OTHER_PART)
    result[np.isin(names, list(others))] = PointLabel.NEIGHBOUR
    if (count := int(np.count_nonzero(result == PointLabel.TARGET))) < MIN_POINTS:
        raise DataError(f"{count} to grasp at; expected at least {MIN_POINTS}.", source="points")
    return result


def _within_reach(grasps: Sequence[Grasp], kind: RobotType, grip: Array) -> tuple[Grasp, ...]:
    """Those grasps for which inverse kinematics finds the pose, and the one before it."""
    at = np.array([g.world_from_grip for g in grasps]).reshape(-1, 1, 4, 4) @ FINGERS_EXCHANGED
    ends = np.stack([at, at @ poses.translation(0, 0, -RETREAT)], axis=2)  # (g, 2, 2, 4, 4)
    targets = ends.reshape(-1, 4, 4) @ poses.inverse(grip)
    found = kind.arm.solve(targets, kind.starts).found.reshape(-1, 2, 2)
    return tuple(g for g, both in zip(grasps, found, strict=True) if both.all(axis=1).any())
