from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.motion.rigid_body_rotation import RigidBodyRotation, euler_rate

XMM = np.array([[7052.0, -820.0, -3991.0], [-820.0, 129129.0, 0.0], [-3991.0, 0.0, 131196.0]])
CONSERVED = 1e-9  # relative, over half an hour at rtol 1e-12
START = Rotation.from_rotvec([0.3, -0.7, 1.1]).as_matrix()


@pytest.mark.parametrize("omega_deg_s", [[1.0, 0.0, 0.0], [0.5, -0.3, 0.2], [0.0, 1.0, 1e-3]])
def test_energy_and_momentum_are_kept(omega_deg_s: list[float]) -> None:
    body = RigidBodyRotation(XMM, np.deg2rad(omega_deg_s), START, 1800.0)

    def energy_and_momentum(time_s: float) -> tuple[float, Floats]:
        omega = body.omega_at(time_s)
        return omega @ XMM @ omega, body.inertial_from_body(time_s) @ XMM @ omega

    energy, momentum = energy_and_momentum(0.0)
    size = np.linalg.norm(momentum)
    for time_s in np.linspace(100.0, 1800.0, 7):
        then, moved = energy_and_momentum(float(time_s))
        assert then == pytest.approx(energy, rel=CONSERVED)
        np.testing.assert_allclose(moved, momentum, atol=CONSERVED * size)


def test_a_body_of_revolution_precesses_as_euler_found() -> None:
    """With I = (A, A, C) the rate turns about z at (C / A - 1) w_z, the body about its momentum."""
    a, c = 50.0, 80.0
    inertia, omega = np.diag([a, a, c]), np.array([0.02, 0.0, 0.01])
    body = RigidBodyRotation(inertia, omega, START, 2000.0)
    momentum = START @ inertia @ omega
    for time_s in (10.0, 777.7, 2000.0):
        turned = (c / a - 1.0) * omega[2] * time_s
        expected = [0.02 * np.cos(turned), 0.02 * np.sin(turned), 0.01]
        np.testing.assert_allclose(body.omega_at(time_s), expected, atol=1e-11)
        # The attitude: a spin about the body's axis, then a precession about the momentum.
        spin = Rotation.from_rotvec([0.0, 0.0, -turned]).as_matrix()
        precession = Rotation.from_rotvec(momentum / a * time_s).as_matrix()
        np.testing.assert_allclose(
            body.inertial_from_body(time_s), precession @ START @ spin, atol=1e-9
        )


def test_eulers_equation_in_principal_axes() -> None:
    found = euler_rate(np.diag([1.0, 2.0, 2.5]), np.array([0.1, 0.2, 0.3]))
    expected = [(2.0 - 2.5) / 1.0 * 0.06, (2.5 - 1.0) / 2.0 * 0.03, (1.0 - 2.0) / 2.5 * 0.02]
    np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_a_body_at_rest_stays() -> None:
    body = RigidBodyRotation(XMM, np.zeros(3), START, 100.0)
    np.testing.assert_allclose(body.inertial_from_body(100.0), START, atol=1e-15)


@pytest.mark.parametrize(
    ("inertia", "words"),
    [
        (np.diag([1.0, 1.0, 3.0]), "none larger than the other two together"),
        (np.diag([1.0, -1.0, 1.0]), "positive principal moments"),
        (np.array([[2.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]), "symmetric"),
    ],
)
def test_the_inertia_of_no_body_is_refused(inertia: Floats, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        RigidBodyRotation(inertia, np.zeros(3), START, 1.0)
