"""How noisy a render is, and what it would have cost at another's noise.

Squared errors fall as one over the samples, so the time for light grows as the error is to shrink.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.cycles.jobs import Effort
from models.arrays import Radiance

TRIMMED = 0.001  # share of pixels left out, those that err most: a few fireflies decide nothing
FLOOR = 0.01  # of the mean radiance: what counts as black


def relative_mse(image: Radiance, reference: Radiance) -> float:
    """Return the mean over pixels of the squared error relative to a converged reference.

    Each pixel's squared error is divided by the square of the reference (Rousselle et al. 2011,
    ACM TOG 30, 159, section 6), with a floor; the brightest 0.1 % of that error image is trimmed.

    Parameters
    ----------
    image, reference : (height, width) arrays, W m-2 sr-1
    """
    floor = FLOOR * float(reference.mean(dtype=np.float64))
    error = image.astype(np.float64) - reference
    relative = error**2 / (reference.astype(np.float64) ** 2 + floor**2)
    kept = np.sort(relative, axis=None)[: relative.size - round(TRIMMED * relative.size)]
    return float(kept.mean())


def whole_frame_mse(image: Radiance, reference: Radiance) -> float:
    """Return the error's energy over the reference's, less the brightest 0.1 % of the pixels.

    The other reading of a relative mean squared error: here highlights count, shadows do not.

    Parameters
    ----------
    image, reference : (height, width) arrays, W m-2 sr-1
    """
    brightness = np.maximum(image, reference)
    kept = brightness <= np.quantile(brightness, 1.0 - TRIMMED)
    error = image[kept].astype(np.float64) - reference[kept]
    return float((error**2).sum() / (reference[kept].astype(np.float64) ** 2).sum())


@dataclass(frozen=True)
class Cost:
    """What some images cost.

    Attributes
    ----------
    light_s : float, s
        Spent on light, which grows with the samples.
    rest_s : float, s
        Start-up, writing, end: all else.
    light_processor_s, rest_processor_s : float, s
        The same, of all cores: what else the machine does hardly changes it.
    peak_mib : float, MiB
    """

    light_s: float
    rest_s: float
    light_processor_s: float
    rest_processor_s: float
    peak_mib: float

    @property
    def whole_s(self) -> float:
        """From the start of the process to its end."""
        return self.light_s + self.rest_s

    @property
    def processor_s(self) -> float:
        """Of all cores, from the start of the process to its end."""
        return self.light_processor_s + self.rest_processor_s

    def at_noise(self, own: float, wanted: float) -> float:
        """Return the whole time with the samples that bring noise ``own`` to ``wanted``, s."""
        return self.light_s * own / wanted + self.rest_s

    def processor_at_noise(self, own: float, wanted: float) -> float:
        """Return the processor time with those samples, s."""
        return self.light_processor_s * own / wanted + self.rest_processor_s

    def times(self, scale: float) -> Cost:
        """Return the cost of ``scale`` times the light, the rest as it is."""
        light_s, worked_s = scale * self.light_s, scale * self.light_processor_s
        return Cost(light_s, self.rest_s, worked_s, self.rest_processor_s, self.peak_mib)


def cost_of(effort: Effort) -> Cost:
    """Return what a process cost."""
    light_s = sum(effort.rendered_s)
    worked_s = sum(effort.rendered_processor_s)
    rest_s, rest_processor_s = effort.whole_s - light_s, effort.processor_s - worked_s
    return Cost(light_s, rest_s, worked_s, rest_processor_s, effort.peak_mib)
