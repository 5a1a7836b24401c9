"""A start under a Sun that is known: images are taken until one motion is hardly wrong.

What a start may cost is counted in fits, so that the same images give the same answer on any
machine.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Image
from pipelines.acquisition.candidate import Candidate
from pipelines.acquisition.daylight import Daylight
from pipelines.acquisition.rivals import (
    Belief,
    RivalOptions,
    Rivals,
    Verdict,
    belief_by_brightness,
)
from pipelines.acquisition.under_sun import UnderSun
from pipelines.tracking.edge_fit import EdgeImage


@dataclass(frozen=True)
class SunlitStartOptions:
    """What is believed, and what a start may cost.

    Attributes
    ----------
    rivals : RivalOptions
    belief, by_brightness : Belief
        Where shapes of light alone tell poses apart, and where their brightness is known.
    most_work : float
        In fits: an image that would begin beyond it is not looked at. A core of 2020 does 37 a
        second.
    followed, least_followed : float
        A rival that goes on to where it explains this share of the light that it did before, and
        did that much, is followed, and little else is tried;
    work_anew : float
        so it is after that many fits whatever it explains.
    longest_gap_s : float, s
        Between images of one start.
    """

    rivals: RivalOptions = field(default_factory=RivalOptions)
    belief: Belief = field(default_factory=Belief)
    by_brightness: Belief = field(default_factory=belief_by_brightness)
    most_work: float = 170.0
    followed: float = 0.85
    least_followed: float = 0.5
    work_anew: float = 100.0
    longest_gap_s: float = 60.0


@dataclass(frozen=True, eq=False)
class StartAnswer:
    """What a start says of its latest image.

    Attributes
    ----------
    pose : Candidate or None
    reason : str
        Why there is none; empty where there is one.
    wrong_probability : float
        That the best pose, claimed or not, is another than the true one; 1 without any.
    image : EdgeImage or None
        The part about the target; None where it was not looked at, and never with a pose.
    over : bool
        Whether the next image begins a new start.
    candidates : tuple of Candidate
        Of this image, the likeliest first.
    """

    pose: Candidate | None
    reason: str
    wrong_probability: float
    image: EdgeImage | None
    over: bool
    candidates: tuple[Candidate, ...] = ()


class SunlitStart:
    """One start.

    Parameters
    ----------
    looking : UnderSun
    options : SunlitStartOptions
    """

    def __init__(self, looking: UnderSun, options: SunlitStartOptions) -> None:
        self._looking, self._options = looking, options
        self._rivals: Rivals[Candidate] = Rivals(
            looking, options.rivals, options.belief, options.by_brightness
        )
        self._work, self._enough = 0.0, np.inf
        self.last_s = -np.inf

    def take(self, image: Image, time_s: float, daylight: Daylight) -> StartAnswer:
        """Take the next image.

        Parameters
        ----------
        image : (height, width) uint16 array, DN
        time_s : float, s
            Later than before.
        daylight : Daylight
        """
        if self.last_s == -np.inf:
            self.last_s = time_s
        if self._work >= self._options.most_work:
            reason = f"no pose within {self._options.most_work:.0f} fits, which a start may cost"
            return StartAnswer(None, reason, 1.0, None, over=True)
        options = self._options
        enough = -np.inf if self._work > options.work_anew else self._enough
        looked = self._looking.look(image, daylight, self._rivals.foreseen(time_s), enough)
        self._work += looked.work
        self.last_s = time_s
        if not looked.candidates:
            return StartAnswer(None, looked.reason, 1.0, looked.image, over=False)
        verdict = self._rivals.add(time_s, looked.candidates)
        wrong, light = verdict.wrong_probability, verdict.best.light
        self._enough = options.followed * light if light > options.least_followed else np.inf
        claimed = wrong <= options.rivals.most_wrong
        return StartAnswer(
            pose=verdict.best if claimed else None,
            reason="" if claimed else _doubt(verdict),
            wrong_probability=wrong,
            image=looked.image,
            over=claimed,
            candidates=looked.candidates,
        )


def _doubt(verdict: Verdict[Candidate]) -> str:
    best, standing = verdict.best, verdict.standing
    told = (
        f"the best pose may be wrong, with a probability of {verdict.wrong_probability:.2g}: it "
        f"explains {100.0 * standing.light:.0f} % of the light and "
        f"{100.0 * standing.steps:.0f} % of the edges due"
    )
    if verdict.other is None:
        return told
    turn = Rotation.from_matrix(best.pose.rotation.T @ verdict.other.rotation)
    away_deg = np.rad2deg(turn.magnitude())
    return f"{told}, and leads by {standing.lead:.1f} sigmas over one {away_deg:.0f} deg away"
