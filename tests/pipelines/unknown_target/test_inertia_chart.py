"""Five free numbers are always the inertia of a body, and any body's inertia has its five."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from models.motion.rigid_body_rotation import RigidBodyRotation
from models.spacecraft.simple_target import inertia_kg_m2
from pipelines.unknown_target.inertia_chart import SIZE, chart_of, derivatives, inertia_of

CHARTS = arrays(np.float64, SIZE, elements=st.floats(-1.5, 1.5))
STEP = 1e-6


@given(CHARTS)
def test_any_five_numbers_are_a_body(chart):
    inertia = inertia_of(chart)
    assert np.trace(inertia) == pytest.approx(1.0)
    RigidBodyRotation(inertia, np.zeros(3), np.eye(3), 1.0)  # refuses what no body has


@given(CHARTS)
def test_there_and_back(chart):
    np.testing.assert_allclose(chart_of(7.0 * inertia_of(chart)), chart, atol=1e-7)


def test_a_bodys_inertia_is_found_up_to_its_scale():
    inertia = inertia_kg_m2()
    found = inertia_of(chart_of(inertia))
    np.testing.assert_allclose(found * np.trace(inertia), inertia, rtol=1e-9, atol=1e-9)


def test_a_ball_is_in_the_middle():
    np.testing.assert_allclose(inertia_of(np.zeros(SIZE)), np.eye(3) / 3.0)


@given(CHARTS)
def test_derivatives_are_differences(chart):
    for place, change in enumerate(STEP * np.eye(SIZE)):
        slope = (inertia_of(chart + change) - inertia_of(chart - change)) / (2.0 * STEP)
        np.testing.assert_allclose(derivatives(chart)[place], slope, atol=1e-8)


def test_what_no_body_has_is_refused():
    with pytest.raises(ValueError, match="expected the inertia of a body"):
        chart_of(np.diag([1.0, 1.0, 3.0]))
