"""The pipeline's dynamics against the simulation's, and their derivatives against differences."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.suites.volpe2017.cases import motion_of, states_of
from models.motion.gravity_gradient_rotation import lvlh_from_first
from models.spacecraft.simple_target import inertia_kg_m2
from pipelines.unknown_target.free_tumble import UNKNOWNS, FreeTumble
from pipelines.unknown_target.inertia_chart import chart_of
from tests.support.watched_target import SHORT

CHART = chart_of(inertia_kg_m2())
FIRST = states_of(SHORT)[0].R_lvlh_from_target
OMEGA = motion_of(SHORT).omega0_in_target
TIMES_S = SHORT.times_s[::20]
STEP = 1e-6


def turned(omega=OMEGA, chart=CHART):
    tumble = FreeTumble(omega, chart, FIRST, SHORT.orbit_rate, float(TIMES_S[-1]))
    return tumble.at(TIMES_S)


def test_it_turns_as_the_truth_does():
    found = turned()
    for place, time_s in enumerate(TIMES_S):
        state = motion_of(SHORT).state(float(time_s))
        attitude = lvlh_from_first(SHORT.orbit_rate * time_s) @ found.R_start_from_body[place]
        np.testing.assert_allclose(attitude, state.R_lvlh_from_target, atol=1e-8)
        np.testing.assert_allclose(found.omega[place], state.omega_in_target, atol=1e-10)


@pytest.mark.parametrize("unknown", range(UNKNOWNS))
def test_derivatives_are_differences(unknown):
    change = STEP * np.eye(UNKNOWNS)[unknown]
    more = turned(OMEGA + change[:3], CHART + change[3:])
    less = turned(OMEGA - change[:3], CHART - change[3:])
    turns = np.swapaxes(less.R_start_from_body, 1, 2) @ more.R_start_from_body
    slopes = Rotation.from_matrix(turns).as_rotvec() / (2.0 * STEP)
    expected = turned()
    scale = np.abs(slopes).max()
    np.testing.assert_allclose(
        expected.turn_by_unknowns[:, :, unknown], slopes, atol=1e-4 * scale + 1e-9
    )
    slopes = (more.omega - less.omega) / (2.0 * STEP)
    scale = np.abs(slopes).max()
    np.testing.assert_allclose(
        expected.omega_by_unknowns[:, :, unknown], slopes, atol=1e-4 * scale + 1e-9
    )
