"""One comparison of ``make speed``: what both sides took, and the ratios of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.cycles.noise import Cost


@dataclass(frozen=True)
class Row:
    """One comparison.

    Attributes
    ----------
    what : str
    target : float
        What the ratio should reach; for bare Mitsuba, what it may not exceed.
    ours, theirs : list of Cost
        One for each repetition, the two of a pair taken one after the other.
    noise_ratio, whole_frame_noise_ratio : float
        Their error over ours at equal samples, by either reading of it.
    bare : bool
        Whether "ours" is bare Mitsuba and "theirs" is rvbench, so that less is better.
    """

    what: str
    target: float
    ours: list[Cost]
    theirs: list[Cost]
    noise_ratio: float
    whole_frame_noise_ratio: float
    bare: bool = False

    @property
    def decisive(self) -> list[float]:
        """What is held against the target: at equal noise; of bare Mitsuba, light alone."""
        return self.of_light_alone if self.bare else self.at_equal_noise

    @property
    def reached(self) -> bool:
        """Whether the middle of the repetitions reaches the target."""
        middle = float(np.median(self.decisive))
        return middle <= self.target if self.bare else middle >= self.target

    @property
    def at_equal_samples(self) -> list[float]:
        """Their whole time over ours."""
        return [b.whole_s / a.whole_s for a, b in zip(self.ours, self.theirs, strict=True)]

    @property
    def at_equal_noise(self) -> list[float]:
        """Their whole time over ours, had they the samples that give our noise."""
        pairs = zip(self.ours, self.theirs, strict=True)
        return [b.at_noise(self.noise_ratio, 1.0) / a.whole_s for a, b in pairs]

    @property
    def of_light_alone(self) -> list[float]:
        """Their time for light over ours at equal samples: no start-up, no writing."""
        return [b.light_s / a.light_s for a, b in zip(self.ours, self.theirs, strict=True)]

    @property
    def of_processor_at_equal_noise(self) -> list[float]:
        """The same in processor time, which other work on the machine hardly changes."""
        pairs = zip(self.ours, self.theirs, strict=True)
        return [b.processor_at_noise(self.noise_ratio, 1.0) / a.processor_s for a, b in pairs]

    @property
    def of_processor(self) -> list[float]:
        """Their processor time over ours at equal samples."""
        return [b.processor_s / a.processor_s for a, b in zip(self.ours, self.theirs, strict=True)]
