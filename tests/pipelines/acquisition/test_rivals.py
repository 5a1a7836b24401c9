"""Rivals over images: motion that is possible goes on, and what leads is believed by as much."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.pose import RigidTransform
from pipelines.acquisition.candidate import Candidate
from pipelines.acquisition.rivals import Belief, RivalOptions, Rivals, Standing
from pipelines.acquisition.under_sun import UnderSun
from pipelines.acquisition.under_sun_options import UnderSunOptions
from pipelines.tracking.edge_fit import EdgeFit
from pipelines.tracking.pose_check import NO_FIT
from tests.support.drawn_targets import CAMERA, DETECTOR, target

LOOKING = UnderSun(target(), CAMERA, DETECTOR, UnderSunOptions())
STEP_S, RATE_DEG_S = 5.0, 2.0
HALF_TURN = np.diag([-1.0, -1.0, 1.0])
SIGMA = 0.01  # of a range
UNIT = st.floats(0.0, 1.0)


def candidate(turned_deg: float, light: float, twin: bool = False) -> Candidate:
    rotation = Rotation.from_rotvec([0.0, np.deg2rad(turned_deg), 0.0]).as_matrix()
    pose = RigidTransform(rotation @ HALF_TURN if twin else rotation, np.array([0.0, 0.0, 12.0]))
    fit = EdgeFit(pose, None, None, None, np.eye(6), 0.0)  # type: ignore[arg-type]
    return Candidate(fit, NO_FIT, light, steps=0.9, shading=0.4, told=None)  # type: ignore[arg-type]


def rivals() -> Rivals[Candidate]:
    return Rivals(LOOKING, RivalOptions(), Belief())


def test_a_lead_of_each_image_adds_up() -> None:
    carried, margins = rivals(), []
    for image in range(3):
        turned = RATE_DEG_S * STEP_S * image
        seen = (candidate(turned, 0.70), candidate(turned, 0.66, twin=True))
        margins.append(carried.add(STEP_S * image, seen).standing.lead)
    assert margins == sorted(margins)
    assert margins[2] == pytest.approx(3 * margins[0])


def test_an_image_of_the_same_view_counts_little() -> None:
    carried = rivals()
    seen = (candidate(0.0, 0.70), candidate(0.0, 0.66, twin=True))
    first = carried.add(0.0, seen).standing.lead
    again = carried.add(STEP_S, seen).standing.lead
    assert again == pytest.approx(first * (1.0 + RivalOptions().least_weight))


def test_a_turn_that_none_makes_is_no_motion() -> None:
    """What leads in one image and nowhere in the next is worth what the worst was."""
    carried = rivals()
    carried.add(0.0, (candidate(0.0, 0.80, twin=True), candidate(0.0, 0.72)))
    verdict = carried.add(1.0, (candidate(0.0, 0.74), candidate(90.0, 0.73)))
    assert verdict.best.light == 0.74


def test_from_the_third_image_on_a_rate_is_foreseen() -> None:
    carried = rivals()
    for image in range(2):
        carried.add(STEP_S * image, (candidate(10.0 * image, 0.7),))
    foreseen = carried.foreseen(3 * STEP_S)[0]
    expected = candidate(30.0, 0.7).pose
    np.testing.assert_allclose(foreseen.rotation, expected.rotation, atol=1e-12)


@given(UNIT, UNIT, UNIT, UNIT)
def test_a_larger_lead_is_never_believed_less(low: float, more: float, a: float, b: float) -> None:
    belief = Belief()
    one, other = (
        belief.wrong_probability(Standing(lead, a, b, SIGMA)) for lead in (low, low + more)
    )
    assert belief.least <= other <= one <= 1.0


def test_a_sole_rival_leads_by_its_weight() -> None:
    assert rivals().add(0.0, (candidate(0.0, 0.7),)).other is None
