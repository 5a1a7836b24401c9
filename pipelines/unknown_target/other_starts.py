"""Where else to begin, when what was found does not explain the images.

**Mirrored.** While a target turns little, its images are as well explained by the shape turned
inside out along the boresight that turns the other way (Necker's reversal): with ``S`` the mirror
of depth, ``R' = S R S`` and ``P' = S P`` project to the same places but for perspective. Rates and
inertia are mirrored with it. A descent that went there early does not come back by itself.

**Flat.** All points in the plane of the first image, at the rates that were first thought of.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from pipelines.unknown_target import inertia_chart
from pipelines.unknown_target.observation_rows import Epochs
from pipelines.unknown_target.unknowns import CHART, OMEGA, Unknowns

DEPTH = np.diag([1.0, 1.0, -1.0])


def mirrored(at: Unknowns, epochs: Epochs) -> Unknowns:
    """Return the unknowns of the reversed shape.

    Parameters
    ----------
    at : Unknowns
    epochs : Epochs
        Two or more: the first two tell how the camera turns.
    """
    shared = at.shared.copy()
    camera = camera_rate(epochs)
    shared[OMEGA] = camera - DEPTH @ (at.shared[OMEGA] - camera)
    inertia = inertia_chart.inertia_of(at.shared[CHART])
    shared[CHART] = inertia_chart.chart_of(DEPTH @ inertia @ DEPTH)
    return Unknowns(shared, at.points @ DEPTH)


def flat(at: Unknowns, mean: Floats) -> Unknowns:
    """Return the unknowns of a flat shape that turns as was first thought.

    Parameters
    ----------
    at : Unknowns
    mean : (14,) array
        The first guess.
    """
    shared = at.shared.copy()
    shared[OMEGA], shared[CHART] = mean[OMEGA], mean[CHART]
    return Unknowns(shared, at.points * [1.0, 1.0, 0.0])


def camera_rate(epochs: Epochs) -> Floats:
    """Return the camera's inertial rate at the start, (3,) rad/s, its own axes."""
    first, second = epochs.R_cam_from_start[:2]
    turn = Rotation.from_matrix(first @ second.T).as_rotvec()
    return np.asarray(turn / (epochs.times_s[1] - epochs.times_s[0]))
