"""How far a pose lies from a predicted one, in sigmas: by hand along each axis."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.pose import RigidTransform
from pipelines.pnp.predicted_pose import LEAST_VARIANCE, PredictedPose

HERE = RigidTransform(Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix(), np.array([0.1, 0.2, 5.0]))


def moved(step: Floats) -> RigidTransform:
    """Turn and shift it, rotation first."""
    return HERE.perturbed(step[:3], step[3:])


@pytest.mark.parametrize("axis", range(6))
def test_two_sigmas_along_an_axis_are_four(axis: int) -> None:
    sigmas = np.array([0.01, 0.02, 0.03, 0.1, 0.2, 0.3])
    step = np.zeros(6)
    step[axis] = 2.0 * sigmas[axis]
    predicted = PredictedPose(HERE, np.diag(sigmas**2), 0)
    assert predicted.squared_distance(moved(step)) == pytest.approx(4.0, rel=1e-6)


def test_two_axes_that_vary_together_are_nearer_along_than_across() -> None:
    covariance = 1e-4 * np.eye(6)
    covariance[3, 4] = covariance[4, 3] = 0.8e-4
    predicted = PredictedPose(HERE, covariance, 0)
    along = predicted.squared_distance(moved(np.array([0, 0, 0, 0.01, 0.01, 0])))
    across = predicted.squared_distance(moved(np.array([0, 0, 0, 0.01, -0.01, 0])))
    assert along == pytest.approx(2.0 / 1.8, rel=1e-5)
    assert across == pytest.approx(2.0 / 0.2, rel=1e-5)


def test_a_prediction_without_doubt_is_a_micrometre_wide() -> None:
    predicted = PredictedPose(HERE, np.zeros((6, 6)), 0)
    micrometre = np.array([0.0, 0.0, 0.0, 1e-6, 0.0, 0.0])
    assert LEAST_VARIANCE == 1e-12
    assert predicted.squared_distance(moved(micrometre)) == pytest.approx(1.0, rel=1e-6)
