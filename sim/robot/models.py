"""Robot models: arm and gripper, read from `robots.yaml`, whose head describes its entries.

Joint limits and the spheres of collision checks come from the robot's URDF file.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cache, cached_property
from pathlib import Path

import numpy as np

from ...ontology.errors import UnknownNameError
from ...ontology.part_shapes import read_point, read_turn
from ...ontology.plugins import call_plugin, plugin_names
from ...ontology.yaml_reader import YamlNode, read_yaml
from .. import poses
from ..models.urdf import HandFile, robot_file
from ..poses import Array
from .kinematics import KinematicChain, read_chain
from .link_spheres import fit_spheres

ROBOTS_FILE = Path(__file__).with_name("robots.yaml")
OWN_FILE = ".yaml"
_LIMITS = ("speeds", "accelerations")


@dataclass(frozen=True)
class Gripper:
    """A parallel gripper with two fingers, as `robots.yaml` describes it.

    The grip frame lies midway between the pads: x along their width, y the closing direction, z out
    of the hand. Lengths are in [m], the force is that of each finger [N].
    """

    joints: tuple[str, ...]
    links: tuple[str, ...]
    grip: float
    opening: float
    force: float
    pad_width: float
    finger_width: float
    pad_length: float
    tip: float
    finger_thickness: float
    root_thickness: float
    root: float
    palm: float
    palm_size: tuple[float, float]

    @property
    def hand_from_grip(self) -> Array:
        """The grip frame in the hand frame (4, 4)."""
        return poses.translation(0.0, 0.0, self.grip)


_LENGTHS = [each.name for each in fields(Gripper) if each.type is float and each.name != "force"]


@dataclass(frozen=True)
class RobotType:
    """A type of robot."""

    name: str  #: name in settings
    label: str  #: name for people
    urdf: Path  #: URDF file of the arm
    hand: str  #: name of the link at the end of the arm
    home: Array  #: posture (k,) in which the arm waits [rad]
    turns: tuple[float, ...]  #: angles of the first joint in more starts for solutions [rad]
    gripper: Gripper | None  #: the gripper; None for an arm without one
    attachment: HandFile | None = None  #: the hand, when it comes from another file
    speeds: tuple[float, ...] = ()  #: limits of the joints; none for those of the URDF [rad/s]
    accelerations: tuple[float, ...] = ()  #: limits of the joints; none when empty [rad/s^2]

    @cached_property
    def file(self) -> Path:
        """The URDF file of arm and hand together."""
        return robot_file(self.name, self.urdf, attachment=self.attachment)

    @cached_property
    def arm(self) -> KinematicChain:
        """The kinematic chain from the base to the hand."""
        chain = read_chain(self.file, self.hand)
        speed = np.array(self.speeds or chain.speed)
        acceleration = np.array(self.accelerations or chain.acceleration)
        return replace(chain, speed=speed, acceleration=acceleration)

    @cached_property
    def spheres(self) -> Mapping[str, Array]:
        """Spheres that contain the links of the arm but not the fingers, as of `fit_spheres`."""
        fingers = self.gripper.links if self.gripper else ()
        return fit_spheres(self.file, self.arm.links, apart=fingers)

    @cached_property
    def starts(self) -> Array:
        """Starting postures (s, k) of inverse kinematics; `home` is the first."""
        starts = np.tile(self.home, (1 + len(self.turns), 1))
        starts[1:, 0] += self.turns
        return starts


def load_robots(path: Path = ROBOTS_FILE) -> dict[str, RobotType]:
    """Read all robots of a file, by name; DataError if an entry is missing or wrong."""
    return {name: _read_robot(name, field) for name, field in read_yaml(path).entries().items()}


def find_robot(name: str) -> RobotType:
    """Return a robot that comes with Hilt or a plug-in, or one of a file like `robots.yaml`.

    A file is named as "mine.yaml", or as "mine.yaml:NAME" when it has several robots.
    UnknownNameError if there is no such robot; DataError if an entry is missing or wrong.
    """
    file, mark, inside = name.partition(OWN_FILE)
    robots = load_robots(Path(file + mark)) if mark else _shipped()
    if not mark and name not in robots and name in plugin_names("hilt.robots"):
        robots = load_robots(Path(call_plugin("hilt.robots", name)))
    wanted = inside.removeprefix(":") if mark else name
    if mark and not wanted and len(robots) == 1:
        return next(iter(robots.values()))
    if wanted not in robots:
        known = robots if mark else (*robots, *plugin_names("hilt.robots"))
        raise UnknownNameError("robot", wanted or name, known)
    return robots[wanted]


_shipped = cache(load_robots)


def _read_robot(name: str, field: YamlNode) -> RobotType:
    entries = field.entries(
        required=("label", "urdf", "hand", "home"),
        optional=("turns", "gripper", "attached", *_LIMITS),
    )
    robot = RobotType(
        name=name,
        label=entries["label"].text(),
        urdf=_find_urdf(entries["urdf"]),
        hand=entries["hand"].text(),
        home=np.array(entries["home"].numbers(low=-np.pi * 2, high=np.pi * 2)),
        turns=entries["turns"].numbers() if "turns" in entries else (),
        gripper=_read_gripper(entries["gripper"]) if "gripper" in entries else None,
        attachment=_read_attachment(entries["attached"]) if "attached" in entries else None,
        **{key: entries[key].numbers(low=0.01, high=100.0) for key in _LIMITS if key in entries},
    )
    count = len(robot.arm.names)
    for key in ("home", *_LIMITS):
        if key in entries and (found := len(entries[key].items())) != count:
            raise entries[key].fail(f"expected {count} joints, found {found}.")
    return robot


def _read_attachment(field: YamlNode) -> HandFile:
    keys = field.entries(required=("urdf", "link", "carrier", "at"), optional=("turn_deg",))
    turn = read_turn(keys["turn_deg"]) if "turn_deg" in keys else (0.0, 0.0, 0.0)
    link, carrier = keys["link"].text(), keys["carrier"].text()
    return HandFile(_find_urdf(keys["urdf"]), link, carrier, read_point(keys["at"]), turn)


def _find_urdf(field: YamlNode) -> Path:
    if not (path := Path(field.source).parent / field.text()).is_file():
        from importlib.util import find_spec

        # Only the folder of this package is needed, and importing it costs time.
        found = find_spec("pybullet_data")
        path = Path(found.origin or "").parent / field.text() if found else path
    if not path.is_file():
        raise field.fail(f'there is no file "{path}".')
    return path


def _read_gripper(field: YamlNode) -> Gripper:
    keys = field.entries(required=(*_LENGTHS, "joints", "links", "force", "palm_size"), optional=())
    along_x, along_y = keys["palm_size"].numbers(count=2, low=0.0, high=1.0)
    return Gripper(
        joints=keys["joints"].texts(count=2),
        links=keys["links"].texts(count=2),
        force=keys["force"].number(low=0.0, high=1000.0),
        palm_size=(along_x, along_y),
        **{key: keys[key].number(low=-1.0, high=1.0) for key in _LENGTHS},
    )
