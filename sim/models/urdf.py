"""URDF files: text for the models of objects, and robots assembled from an arm and a hand.

Arms and hands come in files of their own: one link of the hand's file is added to the arm, with all
that hangs on it. Soft contacts are removed (they let thin plates pop out of the fingers), and
meshes are named by whole paths, so that the file can stand anywhere. It is kept in the cache.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np

from ...ontology.disk_cache import cache_folder, cached, content_key
from ...ontology.errors import DataError
from ...ontology.objects import PartType
from ...ontology.part_shapes import Colour
from .. import poses
from ..poses import Array

SOCKET, SOCKET_JOINT = "socket", "into"  # link and joint of an object that stands in another one
_SOCKET_MASS = 0.05  # [kg], of the wood right round a nail: far less would make the solver soft
# A link without any visual would be drawn by its collision shape; a speck keeps it invisible.
_SPECK = "    <visual><geometry><box size='1e-5 1e-5 1e-5'/></geometry></visual>"
_VERSION = b"1"  # of the robot files that this module writes


def write_urdf(name: str, elements: Sequence[str], path: Path) -> None:
    """Write a URDF file of links and joints."""
    opening = ["<?xml version='1.0'?>", f"<robot name={quoteattr(name)}>"]
    path.write_text("\n".join([*opening, *elements, "</robot>", ""]), encoding="utf-8")


def part_link(
    part: PartType, collision: str, visuals: Sequence[str], *, centre: Array, inertia: Array
) -> str:
    """Return the link of a part, with its centre of mass (3,) [m] and inertia (3, 3) [kg m^2]."""
    lines = [
        f"  <link name={quoteattr(part.name)}>",
        f"    <contact><lateral_friction value='{part.material.friction:g}'/></contact>",
        _inertial(part.mass, centre, inertia),
        *(visuals or [_SPECK]),
        f"    <collision><geometry><mesh filename='{collision}'/></geometry></collision>",
        "  </link>",
    ]
    return "\n".join(lines)


def visual(file: str, name: str, colour: Colour, *, shine: float) -> str:
    """Return the visual element of a mesh file, in a material of this name."""
    return (
        f"    <visual><geometry><mesh filename='{file}'/></geometry><material name='{name}'>"
        f"<color rgba='{_numbers((*colour, 1.0))}'/><specular rgb='{_numbers([shine] * 3)}'/>"
        "</material></visual>"
    )


def fixed_joint(parent: str, child: str) -> str:
    """Return a fixed joint between two links that share a frame."""
    return (
        f"  <joint name={quoteattr(f'{parent} to {child}')} type='fixed'>"
        f"<parent link={quoteattr(parent)}/><child link={quoteattr(child)}/></joint>"
    )


def socket(part: str, travel: float) -> list[str]:
    """Return a link without a surface, and the joint by which a mounted part slides in it [m]."""
    inertia = np.eye(3) * _SOCKET_MASS * 1e-3  # as of a lump of 3 cm radius
    return [
        f"  <link name='{SOCKET}'>",
        _inertial(_SOCKET_MASS, np.zeros(3), inertia),
        _SPECK,
        "  </link>",
        f"  <joint name='{SOCKET_JOINT}' type='prismatic'>",
        f"    <parent link='{SOCKET}'/><child link={quoteattr(part)}/><axis xyz='0 0 -1'/>",
        f"    <limit lower='0' upper='{travel:g}' effort='1000' velocity='10'/>",
        "  </joint>",
    ]


def _inertial(mass: float, centre: Array, inertia: Array) -> str:
    terms = " ".join(
        f"i{'xyz'[i]}{'xyz'[j]}='{inertia[i, j]:.9g}'" for i in range(3) for j in range(i, 3)
    )
    return (
        f"    <inertial><origin xyz='{_numbers(centre)}'/><mass value='{mass:g}'/>"
        f"<inertia {terms}/></inertial>"
    )


def _numbers(values: Sequence[float] | Array) -> str:
    return " ".join(f"{value:.6g}" for value in values)


@dataclass(frozen=True)
class HandFile:
    """A hand from another file."""

    urdf: Path
    link: str  #: link in that file that is attached, with all links below it
    carrier: str  #: link of the arm that carries the hand
    at: tuple[float, float, float]  #: position x, y, z on the carrier [m]
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)  #: roll, pitch and yaw on the carrier [rad]


def robot_file(name: str, urdf: Path, *, attachment: HandFile | None = None) -> Path:
    """Return the cached URDF of an arm with its hand; `DataError` where a file or link is wrong."""
    sources = [urdf, *([attachment.urdf] if attachment else [])]
    what = repr((sources, attachment)).encode()
    key = content_key(_VERSION, what, *(path.read_bytes() for path in sources))

    def assemble(draft: Path) -> None:
        root = _read(urdf)
        if attachment:
            root.extend(_attached_elements(_read(attachment.urdf), attachment))
        ElementTree.ElementTree(root).write(draft, encoding="utf-8")

    return cached(cache_folder() / "robots" / f"{name}-{key}.urdf", assemble)


def read_urdf(path: Path) -> ElementTree.Element:
    """Return the root element of a URDF file; a `DataError` when it is none."""
    try:
        return ElementTree.parse(path).getroot()  # noqa: S314 - a robot file of the installation
    except (OSError, ElementTree.ParseError) as error:
        raise DataError(f"expected a URDF file: {error}.", source=str(path)) from error


def _read(path: Path) -> ElementTree.Element:
    root = read_urdf(path)
    for contact in root.iter("contact"):
        for element in [*contact.findall("stiffness"), *contact.findall("damping")]:
            contact.remove(element)
    for mesh in root.iter("mesh"):
        mesh.set("filename", str(path.parent / mesh.get("filename", "").removeprefix("package://")))
    return root


def _attached_elements(root: ElementTree.Element, hand: HandFile) -> list[ElementTree.Element]:
    wanted, joints = {hand.link}, list[ElementTree.Element]()
    for joint in root.findall("joint"):  # a URDF lists parents before their children
        if child_attribute(joint, "parent", "link") in wanted:
            joints.append(joint)
            wanted.add(child_attribute(joint, "child", "link"))
    links = [link for link in root.findall("link") if link.get("name") in wanted]
    if len(links) != len(wanted):
        raise DataError(f'expected a link "{hand.link}".', source=str(hand.urdf))
    carrier = ElementTree.Element("joint", name=f"{hand.link} on the arm", type="fixed")
    ElementTree.SubElement(carrier, "parent", link=hand.carrier)
    ElementTree.SubElement(carrier, "child", link=hand.link)
    at, turn = map(_numbers, (hand.at, hand.turn))
    ElementTree.SubElement(carrier, "origin", xyz=at, rpy=turn)
    return [*links, carrier, *joints]


def child_attribute(element: ElementTree.Element, child: str, key: str) -> str:
    """Return an attribute of the first child of that name; empty without one."""
    return "" if (found := element.find(child)) is None else found.get(key, "")


def child_triple(
    element: ElementTree.Element, child: str, key: str, *, default: str = "0 0 0"
) -> tuple[float, float, float]:
    """Return the three numbers of an attribute of the first child of that name."""
    x, y, z = (float(word) for word in (child_attribute(element, child, key) or default).split())
    return x, y, z


def origin_pose(element: ElementTree.Element) -> Array:
    """Return the pose (4, 4) that the `origin` of a joint or a shape tells."""
    turn = poses.rotation_from_rpy(*child_triple(element, "origin", "rpy"))
    return poses.pose(turn, child_triple(element, "origin", "xyz"))
