"""The centralised filter against a plain unscented one, in odd order, in a manoeuvre, for long."""

from dataclasses import replace

import numpy as np
import pytest

from models.errors import DatasetError
from models.navigation_records import GnssEpoch, InertialInterval, StarAttitude
from models.quaternions import (
    conjugate,
    from_rotation_vector,
    mean_quaternion,
    multiplied,
    rotated,
    to_rotation_vector,
)
from pipelines.absolute.dynamics import carried, process_noise_factor
from pipelines.absolute.error_state import SIZE
from pipelines.absolute.integrity import protection_levels_m
from pipelines.absolute.measurements import range_and_rate_sigmas, ranges_and_rates
from pipelines.absolute.navigator import AbsoluteNavigator, started_from
from pipelines.absolute.options import absolute_options_for
from pipelines.filters.rodrigues_error import error_parameters, error_quaternion
from pipelines.filters.square_root_unscented import UnscentedWeights

PAPER = replace(
    absolute_options_for("paper", "leo"), start_clock_s=1e-6, start_drift=1e-9, alpha=0.99
)
BEST = absolute_options_for("best", "leo")
PLACE, SPEED = np.array([7.158e6, 0.0, 0.0]), np.array([0.0, -1103.0, 7380.0])
STAR = np.diag([1.2e-5, 2.4e-5, 1.2e-5]) ** 2
EQUAL = 1e-9  # of a state's own sigma


def epoch(time_s: float, rng: np.random.Generator, runs: int = 1, count: int = 9) -> GnssEpoch:
    ways = np.array([1.5, 0.0, 0.0]) + rng.standard_normal((count, 3))
    senders = 2.66e7 * ways / np.linalg.norm(ways, axis=1, keepdims=True)
    speeds = np.cross([0.0, 0.0, 1.46e-4], senders)
    vector = np.zeros(SIZE)
    vector[:3], vector[3:6] = PLACE + SPEED * time_s, SPEED
    bare = GnssEpoch(
        time_s,
        np.arange(count),
        senders,
        speeds,
        np.full(count, 42.0),
        np.zeros((runs, count)),
        np.zeros((runs, count)),
    )
    exact = ranges_and_rates(vector, bare)
    noisy = exact + range_and_rate_sigmas(bare, PAPER) * rng.standard_normal((runs, 2 * count))
    return replace(bare, pseudorange_m=noisy[:, :count], range_rate_m_s=noisy[:, count:])


def navigator(options=PAPER, runs: int = 1, **more) -> AbsoluteNavigator:
    turned = np.tile([1.0, 0.0, 0.0, 0.0], (runs, 1))
    start = started_from(options, np.tile(PLACE, (runs, 1)), np.tile(SPEED, (runs, 1)), turned)
    return AbsoluteNavigator(options, start, **more)


def still(time_s: float, duration_s: float, runs: int = 1) -> InertialInterval:
    return InertialInterval(time_s, duration_s, np.zeros((runs, 3)))


def stars(time_s: float, off_rad=(0.0, 0.0, 0.0), runs: int = 1) -> StarAttitude:
    quaternion = from_rotation_vector(np.tile(off_rad, (runs, 1)))
    return StarAttitude(time_s, quaternion, STAR)


class PlainUnscented:
    """The textbook's filter: covariances, Cholesky factors, gains; no square root is kept."""

    def __init__(self, own: AbsoluteNavigator) -> None:
        self.vector = own.state.vector[0].copy()
        self.quaternion = own.state.q_inertial_from_body_wxyz[0]
        self.covariance = own.state.covariance[0]
        self.weights = UnscentedWeights(SIZE, PAPER.alpha, PAPER.beta, PAPER.kappa)

    def points(self):
        scale = np.sqrt(np.diag(self.covariance))
        root = np.linalg.cholesky(self.covariance / np.outer(scale, scale)) * scale[:, None]
        steps = self.weights.spread * root.T
        return np.concatenate([np.zeros((1, SIZE)), steps, -steps])

    def propagate(self, interval: InertialInterval) -> None:
        off = self.points()
        moved, turned = carried(
            self.vector + off,
            multiplied(self.quaternion, error_quaternion(off[:, 9:12])),
            interval.turn_rad,
            interval.duration_s,
            PAPER,
        )
        mean = moved[0] + self.weights.mean @ (moved - moved[0])
        self.quaternion = mean_quaternion(turned, self.weights.mean)
        spread = moved - mean
        spread[:, 9:12] = error_parameters(multiplied(conjugate(self.quaternion), turned))
        noise = process_noise_factor(PAPER, interval.duration_s)
        self.covariance = (spread.T * self.weights.covariance) @ spread + noise @ noise.T
        self.vector = mean
        self.vector[9:12] = 0.0

    def correct(self, predicted, measured, noise, off) -> None:
        mean = predicted[0] + self.weights.mean @ (predicted - predicted[0])
        spread = predicted - mean
        whole = (spread.T * self.weights.covariance) @ spread + noise
        across = (off.T * self.weights.covariance) @ spread
        gain = np.linalg.solve(whole, across.T).T
        self.covariance = self.covariance - gain @ whole @ gain.T
        self.covariance = 0.5 * (self.covariance + self.covariance.T)
        moved = gain @ (measured - mean)
        self.vector += moved
        self.vector[9:12] = 0.0
        self.quaternion = multiplied(self.quaternion, error_quaternion(moved[9:12]))

    def take_gnss(self, own: GnssEpoch) -> None:
        off = self.points()
        measured = np.concatenate([own.pseudorange_m[0], own.range_rate_m_s[0]])
        sigmas = range_and_rate_sigmas(own, PAPER)
        self.correct(ranges_and_rates(self.vector + off, own), measured, np.diag(sigmas**2), off)

    def take_stars(self, own: StarAttitude) -> None:
        off = self.points()
        seen = multiplied(conjugate(self.quaternion), own.q_inertial_from_body_wxyz[0])
        self.correct(off[:, 9:12], error_parameters(seen), own.covariance_rad2, off)


def test_it_is_a_plain_unscented_filter():
    """Sixty steps with everything in them: states within 1e-6 sigma, covariances within 1e-6.

    What is lost is lost by the plain filter, whose covariance spans 1e14.
    """
    own, rng = navigator(), np.random.default_rng(6)
    plain = PlainUnscented(own)
    for step in range(1, 61):
        now_s = 0.2 * step
        interval = InertialInterval(now_s, 0.2, 1e-3 * rng.standard_normal((1, 3)))
        seen = stars(now_s, 1e-4 * rng.standard_normal(3))
        own.take(interval)
        plain.propagate(interval)
        own.take(seen)
        plain.take_stars(seen)
        if step % 5 == 0:
            told = epoch(now_s, rng)
            own.take(told)
            plain.take_gnss(told)
    sigma = np.sqrt(np.diag(plain.covariance))
    assert own.state.vector[0] / sigma == pytest.approx(plain.vector / sigma, abs=1e-6)
    assert own.state.covariance[0] / np.outer(sigma, sigma) == pytest.approx(
        plain.covariance / np.outer(sigma, sigma), abs=1e-6
    )
    apart = multiplied(conjugate(plain.quaternion), own.state.q_inertial_from_body_wxyz[0])
    assert to_rotation_vector(apart) == pytest.approx(np.zeros(3), abs=1e-9)


def test_a_run_is_the_same_in_any_company():
    rng = np.random.default_rng(1)
    turn, told = 1e-3 * rng.standard_normal((4, 3)), epoch(0.2, rng, runs=4)
    together = navigator(runs=4)
    together.take(InertialInterval(0.2, 0.2, turn))
    together.take(told)
    for run in range(4):
        alone = navigator()
        alone.take(InertialInterval(0.2, 0.2, turn[run : run + 1]))
        one = slice(run, run + 1)
        alone.take(
            replace(
                told, pseudorange_m=told.pseudorange_m[one], range_rate_m_s=told.range_rate_m_s[one]
            )
        )
        sigma = np.sqrt(np.diag(alone.state.covariance[0]))
        shift = (together.state.vector[run] - alone.state.vector[0]) / sigma
        assert np.abs(shift).max() < EQUAL


def test_what_comes_late_is_counted_and_left():
    own, rng = navigator(), np.random.default_rng(2)
    assert own.take(still(1.0, 1.0))
    before = own.state
    assert not own.take(epoch(0.5, rng))
    assert not own.take(stars(0.9))
    assert not own.take(still(1.0, 0.2))
    assert own.state is before
    assert own.integrity.late == 3
    assert own.take(stars(1.0))


def test_a_lone_satellite_is_used_and_none_is_no_harm():
    own, rng = navigator(), np.random.default_rng(2)
    own.take(still(1.0, 1.0))
    before = np.trace(own.state.covariance[0][:3, :3])
    own.take(epoch(1.0, rng, count=1))
    after = np.trace(own.state.covariance[0][:3, :3])
    assert after < before
    own.take(epoch(1.0, rng, count=0))
    assert np.trace(own.state.covariance[0][:3, :3]) == after
    assert own.integrity.gnss.tracked == 0


def test_the_mask_passes_by_what_grazes_the_ionosphere():
    geo = absolute_options_for("paper", "geo")
    turned = np.array([[1.0, 0.0, 0.0, 0.0]])
    place = np.array([[4.2e7, 0.0, 0.0]])
    own = AbsoluteNavigator(geo, started_from(geo, place, np.array([[0.0, 3075.0, 0.0]]), turned))
    senders = np.array([[-2.4e7, 1.05e7, 0.0], [-1.5e7, 2.1e7, 0.0]])  # 2.2e5 and 5e6 m above
    none = np.zeros((2, 3))
    ranges = np.linalg.norm(place - senders, axis=1)[None]
    own.take(GnssEpoch(0.0, np.array([7, 8]), senders, none, np.full(2, 30.0), ranges, 0 * ranges))
    assert own.integrity.gnss.satellite.tolist() == [8]
    assert own.integrity.gnss.tracked == 2


def test_accelerometers_carry_a_manoeuvre():
    """A push of 0.02 m/s2 for 20 s: with them the speed is known, without them it is lost."""
    q = from_rotation_vector(np.array([[0.4, 0.1, -0.8]]))
    start = started_from(PAPER, PLACE[None], SPEED[None], q)
    force = np.array([[0.02, 0.0, 0.0]])
    felt, blind = (AbsoluteNavigator(PAPER, replace(start)) for _ in range(2))
    for step in range(1, 101):
        pushed = InertialInterval(0.2 * step, 0.2, np.zeros((1, 3)), force)
        felt.take(pushed)
        blind.take(replace(pushed, specific_force_m_s2=None))
    gained = felt.state.vector[0, 3:6] - blind.state.vector[0, 3:6]
    assert gained == pytest.approx(0.4 * rotated(q[0], [1.0, 0.0, 0.0]), abs=1e-3)
    assert felt.state.covariance[0][3, 3] > blind.state.covariance[0][3, 3]


@pytest.mark.slow  # five minutes: a million steps of one run
def test_the_covariance_stays_positive_over_a_million_steps():
    assert smallest_pivot(steps=1_000_000, runs=1) > 0.0


def test_the_covariance_stays_positive_over_many_steps():
    assert smallest_pivot(steps=4_000, runs=1) > 0.0


def smallest_pivot(steps: int, runs: int) -> float:
    """Return the smallest pivot of the factor over its row, of 100 Hz with stars and few ranges."""
    own, rng = navigator(runs=runs), np.random.default_rng(9)
    told, smallest = epoch(0.0, rng, runs=runs, count=3), np.inf
    for step in range(1, steps + 1):
        now_s = 0.01 * step
        own.take(still(now_s, 0.01, runs))
        if step % 20 == 0:
            own.take(stars(now_s, runs=runs))
        if step % 100 == 0:
            own.state.vector[:, :6] = np.concatenate([PLACE, SPEED])  # what is judged is the factor
            own.take(replace(told, time_s=now_s))
            factor = own.state.factor
            rows = np.sqrt(np.sum(factor**2, axis=-1))
            pivots = np.abs(np.diagonal(factor, axis1=1, axis2=2)) / rows
            smallest = min(smallest, float(pivots.min()))
            assert np.isfinite(factor).all()
    return smallest


def test_protection_levels_follow_the_axes():
    levels = protection_levels_m(np.diag([1.0, 4.0, 9.0]), np.eye(3)[:, [2, 0, 1]])
    assert levels == pytest.approx(5.33 * np.array([3.0, 1.0, 2.0]))


def test_what_does_not_fit_is_refused():
    rng = np.random.default_rng(0)
    with pytest.raises(DatasetError, match=r"GNSS at 1\.0 s: expected arrays of shapes"):
        replace(epoch(1.0, rng), pseudorange_m=np.zeros((1, 3)))
    with pytest.raises(ValueError, match="places of Sun and Moon"):
        navigator(BEST)
