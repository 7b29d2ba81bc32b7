# SPDX-License-Identifier: Apache-2.0
"""Robot files made ready: an arm and the hand on it as one URDF, kept in the cache.

Arms and hands come in files of their own. What is added to an arm is one link of another file with
all that hangs on it. Soft contacts are taken out (they let thin plates pop out of the fingers), and
meshes are named by whole paths, so that the file can stand anywhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from ...ontology.errors import DataError
from .cache import content_key, keep_file

_VERSION = b"1"  # of what this module writes


@dataclass(frozen=True)
class Attachment:
    """A hand from another file.

    Attributes:
        urdf: that file.
        link: the link in it that is attached, with all that hangs on it.
        carrier: the link of the arm that carries it.
        at: where on that link [m].
        turn: roll, pitch and yaw there [rad].
    """

    urdf: Path
    link: str
    carrier: str
    at: tuple[float, float, float]
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)


def robot_file(
    name: str, urdf: Path, *, attachment: Attachment | None = None, speeds: Sequence[float] = ()
) -> Path:
    """The file of a robot, made when it is not in the cache yet.

    Args:
        name: of the robot.
        urdf: of its arm.
        attachment: what is attached to it.
        speeds: limits of its moving joints, instead of those in the file [rad/s].

    Raises:
        DataError: a file is no URDF, or lacks a link.
        SimulationError: the cache cannot be written.
    """
    sources = [urdf, *([attachment.urdf] if attachment else [])]
    what = repr((sources, attachment, tuple(speeds))).encode()
    key = content_key(_VERSION, what, *(path.read_bytes() for path in sources))
    return keep_file(f"robots/{name}-{key}.urdf", lambda: _assembled(urdf, attachment, speeds))


def _assembled(urdf: Path, attachment: Attachment | None, speeds: Sequence[float]) -> str:
    root = _read(urdf)
    moving = [joint for joint in root.findall("joint") if joint.get("type") != "fixed"]
    for joint, speed in zip(moving, speeds, strict=False):
        for limit in joint.findall("limit"):
            limit.set("velocity", f"{speed:g}")
    if attachment:
        root.extend(_hanging_on(_read(attachment.urdf), attachment))
    return ElementTree.tostring(root, encoding="unicode")


def _read(path: Path) -> ElementTree.Element:
    try:
        root = ElementTree.parse(path).getroot()  # noqa: S314 - a robot file of the installation
    except (OSError, ElementTree.ParseError) as error:
        raise DataError(f"expected a URDF file: {error}.", source=str(path)) from error
    for contact in root.iter("contact"):
        for element in [*contact.findall("stiffness"), *contact.findall("damping")]:
            contact.remove(element)
    for mesh in root.iter("mesh"):
        name = mesh.get("filename", "").removeprefix("package://")
        mesh.set("filename", str(path.parent / name))
    return root


def _hanging_on(root: ElementTree.Element, attachment: Attachment) -> list[ElementTree.Element]:
    """The attached link, the links and joints that hang on it, and the joint that carries it."""
    wanted, joints = {attachment.link}, list[ElementTree.Element]()
    for joint in root.findall("joint"):  # a URDF tells parents before their children
        if _end(joint, "parent") in wanted:
            joints.append(joint)
            wanted.add(_end(joint, "child"))
    links = [link for link in root.findall("link") if link.get("name") in wanted]
    if len(links) != len(wanted):
        raise DataError(f'expected a link "{attachment.link}".', source=str(attachment.urdf))
    carrier = ElementTree.Element("joint", name=f"{attachment.link} on the arm", type="fixed")
    ElementTree.SubElement(carrier, "parent", link=attachment.carrier)
    ElementTree.SubElement(carrier, "child", link=attachment.link)
    xyz, rpy = (" ".join(f"{v:.6g}" for v in each) for each in (attachment.at, attachment.turn))
    ElementTree.SubElement(carrier, "origin", xyz=xyz, rpy=rpy)
    return [*links, carrier, *joints]


def _end(joint: ElementTree.Element, which: str) -> str:
    found = joint.find(which)
    return "" if found is None else found.get("link", "")
