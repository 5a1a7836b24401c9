"""Further exposures of a start's images: the same light, for longer, with noise of its own."""

from __future__ import annotations

import numpy as np
import pytest

from bench.suites.uncooperative_suns.cases import MotionTask
from bench.suites.uncooperative_suns.frames import known_of, render_motion
from bench.suites.uncooperative_suns.plan import Sizes
from models.errors import ScenarioError

NUMBER = 3  # a motion that shows it 58 px across
TASK = MotionTask("hispasat", "", NUMBER, 5, 256, 4, 1, (0.25, 4.0))
LINEAR_SHARE = 0.02  # of a sum over the image: shot noise and pixel response
LIT_DN, CLEAR = 40.0, 0.9  # above the bias; of the saturation


@pytest.fixture(scope="module")
def rendered() -> dict[str, np.ndarray]:
    return dict(render_motion(TASK).values)


def test_light_goes_with_the_exposure(rendered: dict[str, np.ndarray]) -> None:
    _, detector, _ = known_of(TASK)
    top = detector.bias_dn + CLEAR * (detector.saturation_dn - detector.bias_dn)
    metered = rendered["images"][:, 0].astype(float)
    for place, factor in enumerate(TASK.bracket):
        further = rendered["bracket"][:, 0, place].astype(float)
        told = (metered > detector.bias_dn + LIT_DN) & (metered < top) & (further < top)
        assert told.sum() > 50
        signal = (further - detector.bias_dn)[told].sum()
        assert signal == pytest.approx(
            factor * (metered - detector.bias_dn)[told].sum(), rel=LINEAR_SHARE
        )


def test_its_noise_is_its_own(rendered: dict[str, np.ndarray]) -> None:
    """In the dark corner nothing but read noise stands, and it is not the same twice."""
    corner = [rendered["images"][0, 0][:20, :20]]
    corner += [rendered["bracket"][0, 0, place][:20, :20] for place in range(2)]
    for k in range(3):
        other = corner[(k + 1) % 3].astype(float)
        correlation = np.corrcoef(corner[k].astype(float).ravel(), other.ravel())[0, 1]
        assert abs(correlation) < 0.2  # four times 1 / sqrt(400)


def test_metered_images_are_the_same_with_and_without(rendered: dict[str, np.ndarray]) -> None:
    plain = render_motion(MotionTask("hispasat", "", NUMBER, 5, 256, 4, 1)).values
    assert plain["images"].tobytes() == rendered["images"].tobytes()


@pytest.mark.parametrize("bracket", [(0.0, 4.0), (-1.0,), (0.1, 4.0), (17.0,)])
def test_what_sixteen_bits_do_not_hold_is_refused(bracket: tuple[float, ...]) -> None:
    with pytest.raises(ScenarioError, match="--bracket"):
        Sizes(bracket=bracket)
