"""How an arm looks: tubes in white thermal paint, joints as drums across or collars about them.

Made of the same capsules that must stay clear: a tube is a capsule's own, and a joint's housing no
thicker than the sphere that stands for it, or than its link by a fifth.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import trimesh

from models.arm.arm import Arm, Capsule
from models.arm.hand_camera import HAND_CAMERA, HAND_FROM_TOOL
from models.arrays import Floats
from models.pose import RigidTransform
from models.spacecraft.part import Part
from models.spacecraft.solids import bar, box, cylinder, lathe, placed, standing

SEGMENTS = 48
PROUD = 1.2  # a collar over its link's tube
ALONG = 0.9  # cosine, from which a joint turns about its link and not across it
CAMERA_M = (0.075, 0.075, 0.10)  # the hand camera's body, behind its lens
LENS_M, HOOD_M = 0.020, 0.026
SHY_M = 0.003
PART = "robot_arm"


def arm_parts(arm: Arm, hand_from_tool: RigidTransform = HAND_FROM_TOOL) -> tuple[Part, ...]:
    """Return an arm with its camera as parts, each in the frame of its link.

    Those of the base are in the frame of the chaser, which is the chaser-fixed camera's.

    Parameters
    ----------
    arm : Arm
    hand_from_tool : RigidTransform
        How the camera is mounted.
    """
    last = len(arm.joints)
    parts = [
        replace(part, frame=capsule.link)
        for capsule in arm.capsules
        if capsule.name != HAND_CAMERA
        for part in _link(capsule)
    ]
    parts += [
        replace(part, frame=number)
        for number in range(1, last + 1)
        for part in _housing(arm, number)
    ]
    tool_from_hand = hand_from_tool.inverse()
    parts += [replace(part, frame=last) for part in _camera(arm.last_from_tool @ tool_from_hand)]
    return tuple(
        part if part.frame else replace(part, mesh=placed(part.mesh, arm.chaser_from_base))
        for part in parts
    )


def _link(capsule: Capsule) -> Iterator[Part]:
    """Yield a tube with its end fittings, or nothing for a sphere: that is a joint."""
    length, radius = capsule.length_m, capsule.radius_m
    if length < radius:
        return
    along = capsule.end_in_link - capsule.start_in_link
    stands = standing(capsule.start_in_link, along)
    tube = cylinder(radius, 0.0, length, SEGMENTS)
    yield Part(PART, placed(tube, stands), "white_paint", smooth=True)
    fit = min(0.25 * length, 0.6 * radius)
    for low in (SHY_M, length - fit - SHY_M):  # no face of it lies in one of the tube's
        ring = cylinder(1.06 * radius, low, low + fit, SEGMENTS)
        yield Part(PART, placed(ring, stands), "anodised_aluminium", smooth=True)


def _housing(arm: Arm, number: int) -> Iterator[Part]:
    """Yield the housing of joint ``number``, in the frame of the link that it turns."""
    spheres = [c for c in arm.capsules if c.link == number and c.length_m == 0.0]
    tubes = [c for c in arm.capsules if c.link in (number - 1, number) and c.length_m > 0.0]
    if spheres:
        place, radius = spheres[0].start_in_link, spheres[0].radius_m
    elif tubes:
        place, radius = np.zeros(3), PROUD * max(c.radius_m for c in tubes[:1])
    else:
        return
    axis = np.array([0.0, 0.0, 1.0])
    links = [c.end_in_link - c.start_in_link for c in tubes if c.link == number]
    rolls = any(abs(axis @ link) > ALONG * np.linalg.norm(link) for link in links)
    half = (0.35 if rolls else 0.8) * radius
    drum = _rounded(radius * (1.0 if rolls else 0.78), half, 0.15 * radius)
    stands = standing(place, axis)
    yield Part(PART, placed(drum, stands), "white_paint", smooth=True)
    if not rolls:
        for sign in (-1.0, 1.0):
            cap = cylinder(0.5 * radius, half - SHY_M, half + 0.12 * radius, SEGMENTS)
            yield Part(
                PART, placed(cap, standing(place, sign * axis)), "anodised_aluminium", smooth=True
            )


def _rounded(radius: float, half: float, bevel: float) -> trimesh.Trimesh:
    """Return a drum about z with bevelled edges."""
    return lathe(
        [
            (0.0, -half),
            (radius - bevel, -half),
            (radius, -half + bevel),
            (radius, half - bevel),
            (radius - bevel, half),
            (0.0, half),
        ],
        SEGMENTS,
    )


def _camera(last_from_hand: RigidTransform) -> Iterator[Part]:
    """Yield the hand camera: its body behind the lens, a hood, and the bracket from the hand."""
    depth = CAMERA_M[2]
    body = box(CAMERA_M, (0.0, 0.0, -0.015 - 0.5 * depth))
    yield Part(PART, placed(body, last_from_hand), "black_paint")
    hood = lathe(
        [
            (0.0, -0.016),
            (HOOD_M, -0.016),
            (HOOD_M, -0.002),
            (LENS_M, -0.002),
            (LENS_M, -0.012),
            (0.0, -0.012),
        ],
        SEGMENTS,
    )
    yield Part(PART, placed(hood, last_from_hand), "black_paint", smooth=True)
    behind = last_from_hand @ np.array([0.0, 0.0, -0.015 - 0.5 * depth])
    on_hand = np.array([0.0, 0.0, behind[2]])
    towards = behind - on_hand
    length = float(np.linalg.norm(towards))
    if length > CAMERA_M[0]:
        end: Floats = behind - 0.45 * CAMERA_M[0] * towards / length
        yield Part(PART, bar(on_hand, end, 0.04, 0.03), "anodised_aluminium")
