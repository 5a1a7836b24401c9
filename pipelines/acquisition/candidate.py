"""A pose that an image allows under a Sun that is known, and how it fits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.pose import RigidTransform
from pipelines.acquisition.light_likelihood import ToldLight
from pipelines.tracking.edge_fit import EdgeFit
from pipelines.tracking.pose_check import PoseCheck

WITH_BRIGHTNESS = (52.0, 4.8, 0.38)  # weights of brightness, fitness and preference
SIGMAS_OF_FITNESS = 20.0  # what a unit of it is worth beside what the light prefers


@dataclass(frozen=True, eq=False)
class Candidate:
    """A pose laid on an image, and how it fits.

    Attributes
    ----------
    fit : EdgeFit
    check : PoseCheck
    light : float
        Share of the image's light that it explains; see ``light_likelihood``.
    steps : float
        Share found of the steps in brightness that are due, each counted by how near it is.
    shading : float
        Correlation of its brightness with the Sun's cosine.
    told : ToldLight
        What it says of the light.
    preferred : float
        How clearly the light prefers it to the best fit of the image, in sigmas.
    brightness : float or None
        Share of the best log-likelihood of the image's brightness that there could be
        (``photometry``), where it is known what light falls on what surfaces.
    """

    fit: EdgeFit
    check: PoseCheck
    light: float
    steps: float
    shading: float
    told: ToldLight
    preferred: float = 0.0
    brightness: float | None = None

    @property
    def pose(self) -> RigidTransform:
        """``cam_from_target``."""
        return self.fit.cam_from_target

    @property
    def fitness(self) -> float:
        """How it fits by itself, in one number; a perfect fit has about 1.7."""
        return self.light + 0.5 * self.steps + 0.25 * self.check.score + 0.2 * self.shading

    @property
    def range_sigma(self) -> float:
        """Of the range, by the edges alone and each for itself, as a share of it."""
        try:
            covariance = np.linalg.inv(self.fit.information)
        except np.linalg.LinAlgError:
            return 1.0
        return float(np.sqrt(max(covariance[5, 5], 0.0)) / self.pose.translation[2])

    @property
    def score(self) -> float:
        """How it fits, and how it stands to the image's best fit; see ``score_of``."""
        return score_of(self.fitness, self.preferred, self.brightness)


def score_of(fitness: float, preferred: float, brightness: float | None) -> float:
    """Return how a candidate stands among others: in sigmas, or as a log-likelihood.

    With its brightness it is the sum under which right poses are likeliest among the candidates of
    696 images of training motions.

    Parameters
    ----------
    fitness, preferred : float
    brightness : float or None
        See ``Candidate``.
    """
    if brightness is None:
        return SIGMAS_OF_FITNESS * fitness + preferred
    of_brightness, of_fitness, of_preferred = WITH_BRIGHTNESS
    return of_brightness * brightness + of_fitness * fitness + of_preferred * preferred
