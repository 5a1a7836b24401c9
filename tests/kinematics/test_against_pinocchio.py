"""Our kinematics against Pinocchio's, built from the same arms: ``make kinematics`` runs them.

Carpentier et al. 2019, The Pinocchio C++ library, IEEE/SICE SII. Where it is not installed, as in
``make test``, they are skipped.
"""

from __future__ import annotations

import numpy as np
import pytest

from models.arm.arm import Arm
from models.arm.arm_file import own_arm
from models.arm.clearance import axes_in_base, segment_distance
from models.arm.house_arm import house_arm
from models.arm.inverse_kinematics import solutions
from models.arm.kinematics import base_from_tool, chain, jacobian
from models.pose import RigidTransform
from tests.models.arm.test_arm_file import as_urdf
from tests.support.arms import drawn_angles, drawn_arm

pin = pytest.importorskip("pinocchio", reason="not installed; make kinematics installs it")

AGREE = 1e-10
POSES = 200
AGREE_M = 1e-6  # coal's own tolerance of a distance
ARMS = {
    "house": house_arm(),
    **{f"drawn {n}": drawn_arm(np.random.default_rng(n)) for n in range(4)},
}


def placed(pose: RigidTransform) -> pin.SE3:
    """Return a pose as Pinocchio's."""
    return pin.SE3(pose.rotation, pose.translation)


def theirs(arm: Arm) -> tuple[pin.Model, int]:
    """Return an arm as a model, and the number of its tool's frame."""
    model, parent = pin.Model(), 0
    for joint in arm.joints:
        parent = model.addJoint(
            parent, pin.JointModelRZ(), placed(joint.link_from_joint), joint.name
        )
    tool = model.addFrame(
        pin.Frame("tool", parent, placed(arm.last_from_tool), pin.FrameType.OP_FRAME)
    )
    return model, tool


@pytest.mark.parametrize("name", ARMS)
def test_forward_kinematics_and_jacobian_agree(name):
    arm, rng = ARMS[name], np.random.default_rng(1)
    model, tool = theirs(arm)
    data = model.createData()
    worst = 0.0
    for _ in range(POSES):
        angles = drawn_angles(arm, rng)
        pin.forwardKinematics(model, data, angles)
        pin.updateFramePlacements(model, data)
        pose = data.oMf[tool].homogeneous
        worst = max(worst, np.abs(base_from_tool(arm, angles).matrix() - pose).max())
        for k, link in enumerate(chain(arm, angles)[1:-1], start=1):
            worst = max(worst, np.abs(link - data.oMi[k].homogeneous).max())
        slope = pin.computeFrameJacobian(
            model, data, angles, tool, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        worst = max(worst, np.abs(jacobian(arm, angles) - slope[[3, 4, 5, 0, 1, 2]]).max())
    assert worst < AGREE


def test_what_our_inverse_finds_is_the_pose_by_theirs():
    arm, rng, found = house_arm(), np.random.default_rng(2), 0
    model, tool = theirs(arm)
    data = model.createData()
    for _ in range(POSES):
        aim = base_from_tool(arm, drawn_angles(arm, rng))
        angles = next(solutions(arm, aim), None)
        assert angles is not None
        pin.forwardKinematics(model, data, angles)
        pin.updateFramePlacements(model, data)
        found += bool(np.abs(data.oMf[tool].homogeneous - aim.matrix()).max() < 10.0 * AGREE)
    assert found == POSES


@pytest.mark.parametrize("axis", ["0 0 1", "1 2 3"])
def test_a_urdf_is_read_as_they_read_it(axis):
    text = as_urdf(axis)
    arm = own_arm(text.splitlines(), "mine.urdf", RigidTransform.identity()).arm
    model = pin.buildModelFromXML(text)
    data, rng = model.createData(), np.random.default_rng(3)
    hand = model.getFrameId("hand")
    for _ in range(20):
        angles = drawn_angles(arm, rng)
        pin.forwardKinematics(model, data, angles)
        pin.updateFramePlacements(model, data)
        np.testing.assert_allclose(
            base_from_tool(arm, angles).matrix(), data.oMf[hand].homogeneous, atol=AGREE
        )


def test_distances_of_capsules_agree_with_coals():
    coal = pytest.importorskip("coal")
    arm, rng = house_arm(), np.random.default_rng(4)
    worst = 0.0
    for _ in range(100):
        axes = axes_in_base(arm, drawn_angles(arm, rng))
        for i in range(len(axes)):
            for j in range(i + 1, len(axes)):
                first, second = arm.capsules[i], arm.capsules[j]
                ours = float(segment_distance(axes[i], axes[j])) - first.radius_m - second.radius_m
                if ours < 0.01:
                    continue  # of bodies in each other the other library tells a depth
                bodies = []
                for axis, capsule in ((axes[i], first), (axes[j], second)):
                    along = axis[1] - axis[0]
                    length = float(np.linalg.norm(along))
                    z = along / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
                    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), z).matrix()
                    shape = coal.Capsule(capsule.radius_m, length)
                    bodies.append((shape, coal.Transform3s(turn, axis.mean(axis=0))))
                request, result = coal.DistanceRequest(), coal.DistanceResult()
                (a, a_at), (b, b_at) = bodies
                distance = coal.distance(a, a_at, b, b_at, request, result)
                worst = max(worst, abs(distance - ours))
    assert worst < AGREE_M
