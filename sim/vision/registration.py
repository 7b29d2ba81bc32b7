"""Registration of two views of an object: how it moved between them.

Iterative closest points with distances to tangent planes (Chen and Medioni 1992), without the pairs
that are far apart, as views overlap in part (Chetverikov et al. 2002); a part pairs with itself.
"""

import numpy as np

from .. import poses
from ..poses import Array, voxel_downsample
from .percept import Percept

SPACING = 0.004  # [m], voxel size of the points that are paired
ROUNDS = 15
OVERLAP = 0.75  # share of the points of the later view that the earlier one shows, too
NEIGHBOURS = 10  # points round one whose plane is the tangent plane there
PART_GAP = 1.0  # [m] between parts in the space in which points are paired
LEVER = 0.05  # [m], where turns count as much as shifts
WORSE = 1.15  # times the mean gap between pairs, up to which a guess is hardly worse
DAMPING = 0.005  # of what the points hardly determine, such as the roll of a thin rod


def motion_between(before: Percept, after: Percept, guess: Array) -> Array:
    """The motion `after_from_before` (4, 4) of an object in the world, near a guess (4, 4).

    It is the guess where that explains the points hardly worse.
    """
    from scipy.spatial import KDTree  # here: it takes half a second to import

    shown = [name for name in before.parts if name in after.parts]
    old, new = (_labelled(each, shown) for each in (before, after))
    tree, before_from_after = KDTree(old), poses.inverse(guess)
    near = old[np.asarray(tree.query(old, min(NEIGHBOURS, len(old)))[1]), :3]
    normals = np.linalg.svd(near - near.mean(axis=1, keepdims=True), full_matrices=False)[2][:, 2]
    mean_gaps = list[float]()
    for _ in range(ROUNDS):
        moved = poses.transform(before_from_after, new[:, :3])
        gaps, index = map(np.asarray, tree.query(np.column_stack([moved, new[:, 3]])))
        kept = gaps <= np.quantile(gaps, OVERLAP)
        ahead, across = old[index[kept], :3] - moved[kept], normals[index[kept]]
        mean_gaps.append(float(gaps.mean()))
        before_from_after = _step(moved[kept], ahead, across) @ before_from_after
    return poses.inverse(before_from_after) if mean_gaps[0] > WORSE * mean_gaps[-1] else guess


def _labelled(percept: Percept, parts: list[str]) -> Array:
    clouds = [percept.parts[name] for name in parts]
    thinned = [cloud[voxel_downsample(cloud, SPACING)] for cloud in clouds]
    labels = np.repeat(np.arange(len(parts)) * PART_GAP, [len(each) for each in thinned])
    return np.insert(np.vstack(thinned), 3, labels, axis=1)


def _step(points: Array, ahead: Array, normals: Array) -> Array:
    """The small motion (4, 4) of points (n, 3) to planes through what is `ahead` of them (n, 3)."""
    middle = points.mean(axis=0)
    rows = np.hstack([np.cross(points - middle, normals) / LEVER, normals])
    moments = rows.T @ rows / len(rows) + DAMPING * np.eye(6)
    answer = np.linalg.solve(moments, rows.T @ (ahead * normals).sum(axis=1) / len(rows))
    turn = answer[:3] / LEVER
    angle = float(np.linalg.norm(turn))
    rotation = poses.rotation_about(turn / angle, angle) if angle else np.eye(3)
    return poses.pose(rotation, middle + answer[3:] - rotation @ middle)
