"""How the arm looks against what was checked to be clear."""

from __future__ import annotations

import numpy as np
import pytest

from models.arm.clearance import axes_in_base, segment_distance
from models.arm.hand_camera import HAND_FROM_TOOL, with_hand_camera
from models.arm.house_arm import house_arm
from models.arm.kinematics import chaser_from_links
from models.arm.shape import PART, arm_parts
from models.spacecraft.armed_chaser import armed_chaser, chaser_without_arm
from models.spacecraft.chaser import STOWED_ARM, chaser
from models.spacecraft.stance import Stance
from tests.support.arms import drawn_angles, drawn_arm

PROUD_M = 0.03  # of bevels, caps, end fittings and the bracket over the capsules


def test_bodies_are_closed_and_face_outward():
    for part in arm_parts(house_arm()):
        mesh = part.mesh.copy()
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        assert mesh.is_watertight
        assert mesh.volume > 0.0


@pytest.mark.parametrize("own", [False, True], ids=["house", "drawn"])
def test_what_is_seen_lies_within_what_was_checked(own):
    rng = np.random.default_rng(5)
    arm = with_hand_camera(drawn_arm(rng) if own else house_arm())
    angles = drawn_angles(arm, rng)
    links = chaser_from_links(arm, angles)
    stands = links[0]
    axes = np.stack([stands @ axis for axis in axes_in_base(arm, angles)])
    radii = np.array([capsule.radius_m for capsule in arm.capsules])
    stance = Stance((stands @ stands.inverse(), *links[1:]))
    for part in arm_parts(arm, HAND_FROM_TOOL):
        corners = stance.corners(part)
        points = np.repeat(corners[:, None, None], 2, axis=2)
        gaps = segment_distance(points, axes[None]) - radii
        if part.material == "anodised_aluminium" and part.frame == len(arm.joints):
            continue  # the bracket from hand to camera
        assert gaps.min(axis=1).max() < PROUD_M, part


def test_the_arm_that_moves_takes_the_stowed_ones_place():
    names = [part.name for part in armed_chaser(house_arm(), HAND_FROM_TOOL).parts]
    assert STOWED_ARM not in names
    assert PART in names
    assert len(chaser_without_arm().parts) == len(chaser().parts) - 1
    assert {part.frame for part in chaser().parts} == {0}


def test_every_link_of_length_is_drawn():
    drawn = {part.frame for part in arm_parts(house_arm())}
    assert {0, 3, 5, 7} <= drawn
