"""Placement of the objects of a scene on the table, so that none touches another.

An object covers a convex footprint on the table. Positions are drawn at random until each footprint
is clear of the others, the longest objects first; when one object finds no free position, all are
drawn again. The same scene and seed always give the same placement.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely import Geometry

from ...ontology.errors import SimulationError
from .. import poses
from ..models.object_models import ObjectModel
from ..poses import Array
from .scene import Placement, Scene

DROP = 0.0005  # [m], height above the table from which an object is dropped
AREA = ((0.32, 0.68), (-0.40, 0.40))  # [m], range of x and y of the middle of an object
REACH = 0.80  # [m] from the robot at the origin; a hand that points down can lift 1 cm nearer
LIMITS = ((0.24, 0.78), (-0.50, 0.50))  # [m], range of x and y of all its points
MAX_TRIES = 60  # positions of one object
MAX_ROUNDS = 300  # times that all are drawn again
_ALLOWED = shapely.box(*np.transpose(LIMITS).ravel()) & shapely.Point(0, 0).buffer(REACH, 64)


@dataclass(frozen=True)
class DropPose:
    """The pose at which one object of a scene is dropped."""

    placement: Placement  #: the placement, with all that the scene left open filled in
    world_from_object: Array  #: pose (4, 4) of the object
    footprint: Geometry  #: the area that it covers on the table, a convex polygon [m]


def place_objects(scene: Scene, models: Mapping[str, ObjectModel]) -> tuple[DropPose, ...]:
    """Return a spot for every object of a scene; `SimulationError` without room for all."""
    spots = _place_loose(scene, models, np.random.default_rng(scene.seed))
    for placement in scene.placements:
        mount = models[placement.object].kind.mount
        if placement.within is not None and mount is not None:
            support = spots[placement.within]
            at, yaw = support.placement.at, support.placement.yaw
            filled = replace(placement, at=at, yaw=yaw, rest="mounted")
            x, y, z = mount.at
            pose = support.world_from_object @ poses.translation(x, y, z - mount.depth)
            spots[placement.name] = DropPose(filled, pose, support.footprint)
    return tuple(spots[placement.name] for placement in scene.placements)


def _place_loose(
    scene: Scene, models: Mapping[str, ObjectModel], rng: np.random.Generator
) -> dict[str, DropPose]:
    laid = [_lay(each, models[each.object], rng) for each in scene.placements if not each.within]
    corners = ((each, shapely.get_coordinates(each.footprint)) for each in laid)
    sizes = {each.placement.name: float(np.linalg.norm(np.ptp(at, axis=0))) for each, at in corners}
    pieces = sorted(laid, key=lambda e: (e.placement.at is None, -sizes[e.placement.name]))
    for _ in range(MAX_ROUNDS):
        spots: dict[str, DropPose] = {}
        for piece in pieces:
            if (spot := _find_spot(piece, spots.values(), scene.gap, rng)) is None:
                break
            spots[piece.placement.name] = spot
        else:
            return spots
    raise SimulationError(f"There is no room on the table for {len(pieces)} objects.")


def _lay(placement: Placement, model: ObjectModel, rng: np.random.Generator) -> DropPose:
    usual = [rest.name for rest in model.kind.rests if rest.usual]
    drawn = usual[int(rng.integers(len(usual)))]  # always drawn, to keep the other draws the same
    rest = model.kind.rest(placement.rest or drawn)
    rotation = poses.rotation_from_rpy(*rest.turn)
    points = model.points @ rotation.T
    hull = shapely.MultiPoint(points[:, :2]).convex_hull
    pose = poses.pose(rotation, (0, 0, DROP - float(points[:, 2].min())))
    return DropPose(replace(placement, rest=rest.name), pose, hull)


def _find_spot(
    laid: DropPose, taken: Collection[DropPose], gap: float, rng: np.random.Generator
) -> DropPose | None:
    fixed = laid.placement.at is not None
    for _ in range(MAX_TRIES):
        spot = _draw_spot(laid, rng)
        within = fixed or shapely.covers(_ALLOWED, spot.footprint)
        if within and all(shapely.distance(spot.footprint, o.footprint) >= gap for o in taken):
            return spot
        if fixed and laid.placement.yaw is not None:
            name = laid.placement.name
            raise SimulationError(f'"{name}" is less than {gap:g} m from another object. Move it.')
    return None


def _draw_spot(laid: DropPose, rng: np.random.Generator) -> DropPose:
    placement = laid.placement
    yaw = placement.yaw if placement.yaw is not None else float(rng.uniform(-np.pi, np.pi))
    about_vertical = poses.rotation_from_rpy(0, 0, yaw)
    corners = shapely.get_coordinates(laid.footprint) @ about_vertical[:2, :2].T
    if placement.at is None:
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        at = np.array([rng.uniform(*AREA[0]), rng.uniform(*AREA[1])]) - middle
    else:
        at = np.array(placement.at)
    world_from_object = poses.pose(about_vertical, (*at, 0)) @ laid.world_from_object
    filled = replace(placement, at=(float(at[0]), float(at[1])), yaw=yaw)
    return DropPose(filled, world_from_object, shapely.Polygon(corners + at))
