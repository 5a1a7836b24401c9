"""The second-order minimum-energy filter of an attitude and a rate, on SO(3) x R^3.

A measured attitude enters as three unit vectors, fixed in the local frame and seen in target
axes: where the measurement says they are, and where the filter says.

The paper's Table 2 is put right in four places: E has a minus sign (with the printed plus the
gain is indefinite after one step); the measured vectors come from the measured attitude; the
rate lives in target axes, as its equation 9 needs; ``-alpha K`` is no fading memory but its
opposite (``NavigationOptions.forgetting_per_s``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from models.arrays import Floats
from pipelines.filters.covariance_fault import positive
from pipelines.filters.kalman import normalised_square
from pipelines.filters.multiplicative_ekf import RotationUpdate
from pipelines.filters.rotation_process import RotationState, skew, turn_between

LONGEST_TURN_RAD = 0.02  # of one step: the attitude's own path is straight within it
MOST_STEPS = 25
MOST_HALVINGS = 24  # of a step that overshoots: 1e-7 of it moves nothing far
ROUNDING = 1e-12  # of the weights: a misfit that grows by less has not grown


@dataclass(frozen=True)
class NoMinimumEnergy:
    """The measurement cannot be taken in. Falsy.

    Attributes
    ----------
    reason : str
        In words.
    """

    reason: str

    def __bool__(self) -> bool:
        return False


def reference_vectors(noise_in_target: Floats, R_lvlh_from_target: Floats) -> tuple[Floats, Floats]:
    """Return three reference vectors, (3, 3), one per row in the local frame, and their weights u.

    The information of the three, ``sum u_i (I - r_i r_i')``, equals that of the measured attitude:
    the vectors lie along the axes of its covariance, ``u_i`` is half the trace of the information
    less that about ``r_i``. No three vectors tell more about one axis than about the two others
    together; where the covariance says so, what is over is given up.
    """
    information, axes = np.linalg.eigh(np.linalg.inv(noise_in_target))
    information[2] = min(information[2], information[0] + information[1])
    return (R_lvlh_from_target @ axes).T, 0.5 * float(information.sum()) - information


def residual(seen: Floats, expected: Floats, weights: Floats) -> Floats:
    """Return ``r^R = -sum u_i (rhat_i x r_i)``, (3,), of vectors in target axes.

    Parameters
    ----------
    seen, expected : (k, 3) arrays
        Unit vectors r_i as measured and rhat_i as the filter has them.
    weights : (k,) array
        u_i.
    """
    products = expected.T @ (weights[:, None] * seen)
    cross = products - products.T  # of which each a b' - b a' is [b x a]x
    return np.array([cross[2, 1], cross[0, 2], cross[1, 0]])


def second_order_term(seen: Floats, expected: Floats, weights: Floats) -> Floats:
    """Return the (3, 3) block ``E11 = -sum u_i ([rhat_i]x [r_i]x + [r_i]x [rhat_i]x) / 2``.

    With this minus sign it is, at no error, the information ``sum u_i (I - r_i r_i')``.

    Parameters
    ----------
    seen, expected : (k, 3) arrays
        Unit vectors r_i as measured and rhat_i as the filter has them, target axes.
    weights : (k,) array
        u_i.
    """
    products = expected.T @ (weights[:, None] * seen)
    return np.asarray(np.trace(products) * np.eye(3) - 0.5 * (products + products.T))


def update(
    state: RotationState, measured: Floats, noise: Floats
) -> RotationUpdate | NoMinimumEnergy:
    """Take in a measured attitude, or say why not: a right angle away or more, E is indefinite.

    The measurement acts over the time that it stands for, while the target stands still: what it
    does between images, ``rotation_process`` has done. The gain's Riccati equation is stepped by
    the exponential of its matrix fraction, which is exact and keeps it positive definite; an
    explicit step of the whole diverges at camera rates. The attitude is moved by the gain at the
    end of a step, which makes the linear case exact too, however few the steps. Far off, where E
    says less than the residual pushes, a whole step would overshoot, by several turns near a right
    angle, and end where E is indefinite and the gain with it: such a step is taken in halves.

    Parameters
    ----------
    state : RotationState
        Predicted; its covariance is the paper's gain K.
    measured : (3, 3) array
        ``R_lvlh_from_target`` of a pose.
    noise : (3, 3) array, rad2
        Covariance of its turn in target axes.

    References
    ----------
    Saccon, Trumpf, Mahony and Aguiar, Second-order-optimal minimum-energy filters on Lie groups,
    2016, theorem 4.1; Pesce et al. 2019, Table 2.
    """
    turn = turn_between(state.R_lvlh_from_target, measured)
    angle = float(np.linalg.norm(turn))
    if angle >= 0.5 * np.pi:
        return NoMinimumEnergy("attitude a right angle or more from the predicted one")
    nis = normalised_square(turn, state.covariance[:3, :3] + noise)
    references, weights = reference_vectors(noise, measured)
    seen = references @ measured
    count = min(MOST_STEPS, 1 + int(angle / LONGEST_TURN_RAD))
    for _ in range(count):
        after = _sound_step(state, references, seen, weights / count, MOST_HALVINGS)
        if after is None:
            return NoMinimumEnergy(
                f"attitude {np.rad2deg(angle):.0f} deg from the predicted one: "
                "no positive gain takes it in"
            )
        state = after
    return RotationUpdate(state, nis)


def _misfit(state: RotationState, references: Floats, seen: Floats, weights: Floats) -> float:
    """Return ``sum u_i |r_i - rhat_i|^2 / 2``, the measurement's part of the energy."""
    away = seen - references @ state.R_lvlh_from_target
    return 0.5 * float(weights @ (away * away).sum(axis=1))


def _sound_step(
    state: RotationState, references: Floats, seen: Floats, weights: Floats, halvings: int
) -> RotationState | None:
    """Take a step, in parts where the whole does not come closer; None if no part does."""
    slack = ROUNDING * float(weights.sum())
    with np.errstate(all="ignore"):
        try:
            after = _step(state, references, seen, weights)
        except np.linalg.LinAlgError:
            after = None
    if after is not None and positive(after.covariance):
        before = _misfit(state, references, seen, weights)
        if _misfit(after, references, seen, weights) <= before + slack:
            return after
    if halvings == 0:
        return None
    middle = _sound_step(state, references, seen, 0.5 * weights, halvings - 1)
    if middle is None:
        return None
    return _sound_step(middle, references, seen, 0.5 * weights, halvings - 1)


def _step(
    state: RotationState, references: Floats, seen: Floats, weights: Floats
) -> RotationState | None:
    """Take a step; None where it would turn by a right angle or more."""
    expected = references @ state.R_lvlh_from_target
    push = residual(seen, expected, weights)
    told = np.zeros((6, 6))
    told[:3, :3] = second_order_term(seen, expected, weights)
    # W turns the gain by half of what the attitude moves, which at the start is far less than the
    # gain before the step would move it.
    moves = np.linalg.solve(np.eye(6) + state.covariance @ told, state.covariance)[:3, :3] @ push
    connection = np.zeros((6, 6))
    connection[:3, :3] = 0.5 * skew(moves)
    fraction = np.block([[-connection, np.zeros((6, 6))], [told, connection.T]])
    moved = expm(fraction)
    upper = moved[:6, :6] @ state.covariance + moved[:6, 6:]
    lower = moved[6:, :6] @ state.covariance + moved[6:, 6:]
    gain = np.linalg.solve(lower.T, upper.T).T
    gain = 0.5 * (gain + gain.T)
    correction = gain[:, :3] @ push
    if not np.linalg.norm(correction[:3]) < 0.5 * np.pi:
        return None
    return state.turned(correction, gain)
