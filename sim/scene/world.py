"""The simulated world: a table, the objects of a scene, and time.

A `World` loads the room and the objects of a scene into an engine and lets them settle. The robot
is not part of it: `robot` loads it into the engine, whose watchers are called at every step.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

import numpy as np

from ...ontology.errors import UnknownNameError
from ...ontology.objects import ObjectType
from .. import poses
from ..models.object_models import ObjectModel, object_model
from ..models.urdf import SOCKET_JOINT
from ..physics.engine import TIME_STEP, PhysicsEngine
from ..poses import Array
from .placement import DropPose, place_objects
from .scene import Scene, unknown_objects

FLOOR, TABLE = "floor", "table"
FLOOR_HEIGHT = -0.72  # [m], lower end of the legs of the table
TABLE_CENTRE = (0.40, 0.0, 0.0)  # [m], so that the robot stands on the table near its edge
SPINNING_FRICTION = 0.002  # [m]; a contact patch of a few millimetres resists turning
# [m]; lets round objects come to rest. The table has it, not the objects, which would otherwise
# resist rolling between the fingers too, where it does not help and slows the solver down.
ROLLING_FRICTION = 0.0003

MOUNT_FORCE = 20_000.0  # [N], holds the socket of a nail in its block: more than any blow

SETTLE_LIMIT = 3.0  # [s]
STILL_STEPS = 24  # between compared poses; the speeds of light objects jitter, also at rest
STILL_SHIFT = 1e-4  # [m]
STILL_TURN = 0.004  # [rad]


@dataclass(repr=False)
class World(AbstractContextManager["World"]):
    """The room with the objects of one scene.

    Use it in a `with` block, or `close` it.
    """

    scene: Scene
    engine: PhysicsEngine
    objects: Mapping[str, ObjectType]
    kinds: Mapping[str, ObjectType]  #: type of each object on the table, by the object's name
    models: Mapping[str, ObjectModel]
    #: name of the object that an object stands in; loose ones are not in it
    supports: dict[str, str] = field(default_factory=dict[str, str])

    @classmethod
    def build(cls, scene: Scene, objects: Mapping[str, ObjectType], *, gui: bool = False) -> World:
        """Return a world in which a scene has settled; `SimulationError` without room for it."""
        objects = {**objects, **unknown_objects(scene.unknown)}
        models = {name: object_model(objects[name]) for name in (FLOOR, TABLE, *scene.types)}
        spots = place_objects(scene, models)
        kinds = {spot.placement.name: objects[spot.placement.object] for spot in spots}
        world = cls(scene, PhysicsEngine(gui=gui), objects, kinds, models)
        for name, at in ((FLOOR, (0, 0, FLOOR_HEIGHT)), (TABLE, TABLE_CENTRE)):
            world.engine.bodies.load(name, models[name].urdf, poses.translation(*at), fixed=True)
        world.engine.bodies.set_friction(TABLE, rolling=ROLLING_FRICTION)
        for spot in sorted(spots, key=lambda spot: spot.placement.within is not None):
            world._add(spot)
        world.settle()
        return world

    def _add(self, spot: DropPose) -> None:
        name, model = spot.placement.name, self.models[spot.placement.object]
        mount, support = model.kind.mount, spot.placement.within
        if mount is None or support is None:
            self.engine.bodies.load(name, model.urdf, spot.world_from_object)
        else:
            self.supports[name] = support
            self.engine.bodies.load(name, model.mounted, spot.world_from_object)
            self.engine.bodies.ignore_contacts(name, support)
            self.engine.joints.fix_bodies(name, support, force=MOUNT_FORCE)
            # A motor with target speed 0 and limited force acts as dry friction.
            self.engine.joints.drive_at(name, SOCKET_JOINT, 0.0, force=mount.resistance)
        self.engine.bodies.set_friction(name, spinning=SPINNING_FRICTION)

    def close(self) -> None:
        """Stop the simulator."""
        self.engine.close()

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def time(self) -> float:
        """The time that has passed in the world [s]."""
        return self.engine.steps * TIME_STEP

    def settle(self) -> bool:
        """Step until all objects are still, at most `SETTLE_LIMIT`; return whether they are."""
        before = self._poses()
        for _ in range(round(SETTLE_LIMIT / TIME_STEP / STILL_STEPS)):
            self.engine.step(STILL_STEPS)
            after = self._poses()
            shifts = np.linalg.norm(after[:, :3, 3] - before[:, :3, 3], axis=1)
            turns = poses.angle_between(before[:, :3, :3], after[:, :3, :3])
            if (shifts < STILL_SHIFT).all() and (turns < STILL_TURN).all():
                return True
            before = after
        return False

    def let_sleep(self) -> None:
        """Put the loose objects to sleep; the engine computes each again once it is touched."""
        for name in self.loose:
            self.engine.bodies.put_to_sleep(name)

    def _poses(self) -> Array:
        return np.array([self.pose(name) for name in self.kinds] or [np.eye(4)])

    def pose(self, name: str) -> Array:
        """`world_from_object` of an object."""
        # The first part has the frame of the object, also where the base is a socket.
        return self.engine.bodies.pose(name, next(iter(self.kinds[name].parts)))

    def depth(self, name: str) -> float:
        """Return how deep an object stands in another one [m]; UnknownNameError if it does not."""
        mount = self.kinds[name].mount if name in self.supports else None
        if mount is None:
            raise UnknownNameError("object that stands in another", name, self.supports)
        return mount.depth + float(self.engine.joints.positions(name, [SOCKET_JOINT])[0])

    @property
    def loose(self) -> tuple[str, ...]:
        """The objects that stand in no other one, and that nothing stands in."""
        taken = {*self.supports, *self.supports.values()}
        return tuple(name for name in self.kinds if name not in taken)

    def points(self, name: str) -> Array:
        """Return the corners of an object's hull where it is now (n, 3), in the world [m]."""
        return poses.transform(self.pose(name), self.models[self.kinds[name].name].points)

    def top(self, name: str) -> Array:
        """Return the point above the middle of an object at the height of its top (3,) [m]."""
        points = self.points(name)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        return np.array([middle[0], middle[1], points[:, 2].max()])
