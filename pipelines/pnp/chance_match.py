"""How often clutter alone would make as many matches agree: a pose found by chance is none.

Three matches always give a pose. That others then agree with it says something only where few
poses were tried, or few candidates lie about. The number of false alarms is that of poses that
clutter offers, times the chance that each finds as many more matches among it (Desolneux, Moisan
and Morel 2000, "Meaningful alignments").
"""

from __future__ import annotations

import numpy as np
from scipy.special import bdtrc

from pipelines.pnp.hypotheses import MOST_TRIPLES

POSES_OF_THREE = 4  # that P3P gives at most
MADE_BY = 3
MOST_FALSE_ALARMS = 0.01


def false_alarms(
    agreeing: int, markers: int, stray_pairs: int, strays: int, searched_px: float, reach_px: float
) -> float:
    """Return how many poses clutter is expected to give with as many agreeing matches.

    Parameters
    ----------
    agreeing : int
        Matches that agree with the pose, the three that make it among them.
    markers : int
        That face the camera.
    stray_pairs : int
        Pairs of candidate and marker that the prediction allows, beside those that agree.
    strays : int
        Candidates that are none of those.
    searched_px : float, px^2
        Area in which candidates were looked for.
    reach_px : float, px
        How near to its marker a candidate must be to agree.
    """
    poses = min(stray_pairs**3 / 6.0, float(POSES_OF_THREE * MOST_TRIPLES))
    near = strays * np.pi * reach_px**2 / max(searched_px, 1.0)
    more, left = agreeing - MADE_BY, max(markers - MADE_BY, 0)
    if more <= 0:
        return float(poses)
    return float(poses * bdtrc(more - 1, left, min(near, 1.0))) if more <= left else 0.0
