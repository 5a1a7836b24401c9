"""An arm from a URDF: the one chain of turning joints from its root to its end effector.

Read are joints (``revolute``, ``continuous``, ``fixed``) with origin, axis and limits, and of
``collision`` shapes cylinders, spheres and boxes; no mesh, no file that it names. The end effector
is the one link at the end of the chain, its z the way it points; fingers and other branches beside
the longest chain are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.arm.arm import Arm, Capsule, Joint
from models.arrays import Floats
from models.errors import DatasetError
from models.pose import RigidTransform
from models.reading.shown import shown
from models.reading.xml_file import parse_xml

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

KINDS = ("revolute", "continuous", "fixed")
CONTINUOUS_RAD = np.pi  # either way: a posture is one, however many turns led to it
LARGEST_M, LARGEST_RAD = 50.0, 1e3
LINK_RADIUS_M = 0.05  # of a link without a shape that is read


@dataclass(frozen=True, eq=False)
class _Jointed:
    """A joint of the file: its element, and which links it joins."""

    element: Element
    name: str
    kind: str
    parent: str
    child: str


def arm_of_urdf(text: str, where: Path | str, chaser_from_base: RigidTransform) -> Arm:
    """Return the arm of a URDF.

    Parameters
    ----------
    text : str
    where : Path or str
        The file, for messages.
    chaser_from_base : RigidTransform
        Where its root link stands.

    Raises
    ------
    DatasetError
        If it is no URDF, its joints are no chain, or one of them does not turn.
    """
    root = parse_xml(text, where)
    if root.tag != "robot":
        raise DatasetError(
            f"{where}: expected a URDF, whose root is <robot>, got <{shown(root.tag)[1:-1]}>"
        )
    links = {_named(link, where): link for link in root.findall("link")}
    path = _longest_chain([_jointed(e, where) for e in root.findall("joint")], list(links), where)
    joints: list[Joint] = []
    capsules: list[Capsule] = []
    before = RigidTransform.identity()
    first = path[0].parent
    capsules += _shapes(links[first], 0, before, where)
    for jointed in path:
        before = before @ _origin(jointed.element, where)
        if jointed.kind != "fixed":
            turned = _z_onto(_axis(jointed.element, where, jointed.name))
            limits = _limits(jointed, where)
            try:
                joints.append(Joint(jointed.name, before @ turned, *limits))
            except ValueError as error:
                raise DatasetError(f"{where}: {error}") from error
            before = turned.inverse()
        capsules += _shapes(links[jointed.child], len(joints), before, where)
    try:
        bare = Arm(root.get("name") or "arm", chaser_from_base, tuple(joints), before, ())
    except ValueError as error:
        raise DatasetError(f"{where}: {error}") from error
    told = {capsule.link for capsule in capsules}
    capsules += [each for each in _plain_links(bare) if each.link not in told]
    capsules.sort(key=lambda each: each.link)
    return Arm(bare.name, chaser_from_base, bare.joints, before, tuple(capsules))


def _plain_links(arm: Arm) -> Iterator[Capsule]:
    """Yield a straight link from each joint to the next."""
    for link, end in enumerate(arm.fixed[:, :3, 3]):
        if np.linalg.norm(end) > 0.0:
            yield Capsule(link, f"link {link}", np.zeros(3), end, LINK_RADIUS_M)


def _longest_chain(joints: list[_Jointed], links: list[str], where: Path | str) -> list[_Jointed]:
    """Return the joints from the root to the link that most turning joints lead to."""
    into = {joint.child: joint for joint in joints}
    unknown = [n for j in joints for n in (j.parent, j.child) if n not in links]
    if unknown or len(into) < len(joints):
        what = f"the link {unknown[0]!r}" if unknown else "a link with two joints before it"
        raise DatasetError(f"{where}: expected joints between links of the file, got {what}")
    best: list[_Jointed] = []
    for link in links:
        path: list[_Jointed] = []
        while link in into and len(path) <= len(joints):
            path.insert(0, into[link])
            link = into[link].parent
        if len(path) > len(joints):
            raise DatasetError(f"{where}: expected a chain of links, got a ring through {link!r}")
        order = (sum(each.kind != "fixed" for each in path), len(path))
        if order > (sum(each.kind != "fixed" for each in best), len(best)):
            best = path
    if not best:
        raise DatasetError(f"{where}: expected joints that turn, got none")
    return best


def _jointed(element: Element, where: Path | str) -> _Jointed:
    name, kind = _named(element, where), element.get("type") or ""
    if kind not in KINDS or element.find("mimic") is not None:
        what = "one that mimics another" if kind in KINDS else shown(kind)
        raise DatasetError(
            f"{where}: expected the joint {name!r} as one of {', '.join(KINDS)}, got {what}"
        )
    ends = []
    for tag in ("parent", "child"):
        end = element.find(tag)
        if end is None or not end.get("link"):
            raise DatasetError(f"{where}: expected the joint {name!r} with a {tag} link, got none")
        ends.append(str(end.get("link")))
    return _Jointed(element, name, kind, *ends)


def _limits(jointed: _Jointed, where: Path | str) -> tuple[float, float]:
    if jointed.kind == "continuous":
        return -CONTINUOUS_RAD, CONTINUOUS_RAD
    limit = jointed.element.find("limit")
    if limit is None:
        raise DatasetError(f"{where}: expected the joint {jointed.name!r} with a <limit>, got none")
    lower, upper = (
        _numbers(limit, key, 1, LARGEST_RAD, where, "0")[0] for key in ("lower", "upper")
    )
    return float(lower), float(upper)


def _shapes(
    link: Element, number: int, link_from_here: RigidTransform, where: Path | str
) -> Iterator[Capsule]:
    """Yield the capsules about a link's collision shapes."""
    name = _named(link, where)
    for collision in link.findall("collision"):
        for shape in collision.findall("geometry/*"):
            half_m, radius_m, turned = _about(shape, where)
            if radius_m == 0.0:
                continue
            stands = link_from_here @ _origin(collision, where)
            end = turned * half_m
            yield Capsule(number, name, stands @ -end, stands @ end, radius_m)


def _about(shape: Element, where: Path | str) -> tuple[float, float, Floats]:
    """Return half the length, the radius and the direction of a capsule about a shape.

    Radius 0: a shape that is not read.
    """
    upright = np.array([0.0, 0.0, 1.0])
    if shape.tag == "sphere":
        return 0.0, float(_numbers(shape, "radius", 1, LARGEST_M, where)[0]), upright
    if shape.tag == "cylinder":
        radius = float(_numbers(shape, "radius", 1, LARGEST_M, where)[0])
        return 0.5 * float(_numbers(shape, "length", 1, LARGEST_M, where)[0]), radius, upright
    if shape.tag == "box":
        size = np.abs(_numbers(shape, "size", 3, LARGEST_M, where))
        longest = int(np.argmax(size))
        section = 0.5 * float(np.linalg.norm(np.delete(size, longest)))
        return 0.5 * float(size[longest]), section, np.eye(3)[longest]
    return 0.0, 0.0, upright


def _origin(element: Element, where: Path | str) -> RigidTransform:
    from scipy.spatial.transform import Rotation

    origin = element.find("origin")
    if origin is None:
        return RigidTransform.identity()
    place = _numbers(origin, "xyz", 3, LARGEST_M, where, "0 0 0")
    rpy = _numbers(origin, "rpy", 3, LARGEST_RAD, where, "0 0 0")
    return RigidTransform(Rotation.from_euler("xyz", rpy).as_matrix(), place)


def _axis(element: Element, where: Path | str, name: str) -> Floats:
    axis = element.find("axis")
    along = np.array([1.0, 0.0, 0.0]) if axis is None else _numbers(axis, "xyz", 3, 1e3, where)
    length = float(np.linalg.norm(along))
    if length < 1e-6:
        raise DatasetError(
            f"{where}: expected the joint {name!r} with an axis, got {along.tolist()}"
        )
    return along / length


def _z_onto(axis: Floats) -> RigidTransform:
    """Return a frame whose z is an axis."""
    from scipy.spatial.transform import Rotation

    turn, _ = Rotation.align_vectors(axis[None], np.array([[0.0, 0.0, 1.0]]))
    return RigidTransform(turn.as_matrix(), np.zeros(3))


def _named(element: Element, where: Path | str) -> str:
    name = element.get("name") or ""
    if not name or not name.isprintable() or len(name) > 200:
        raise DatasetError(
            f"{where}: expected each <{element.tag}> with a printable name, got {shown(name)}"
        )
    return name


def _numbers(
    element: Element, key: str, count: int, most: float, where: Path | str, default: str = ""
) -> Floats:
    text = element.get(key, default)
    try:
        numbers = np.array([float(word) for word in text.split()])
    except ValueError:
        numbers = np.array([])
    if len(numbers) != count or not (np.abs(numbers) <= most).all():
        raise DatasetError(
            f"{where}: expected {key} of <{element.tag}> as {count} numbers up to {most:g}, "
            f"got {shown(text)}"
        )
    return numbers
