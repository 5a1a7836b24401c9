"""What star frames came to: shares identified, errors over the bound, honesty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.suites.units import Outcome
from bench.suites.vinag2018.star_survey import WRONG_ARCSEC
from models.arrays import Floats

ARCSEC = np.deg2rad(1.0 / 3600.0)
DOF = 3


@dataclass(frozen=True)
class Surveyed:
    """Attitudes under one sky.

    Attributes
    ----------
    sky : str
    attitudes : int
    identified : float
        Share with an attitude that is right.
    wrong : int
        Attitudes that are not.
    most_triangles : int
    frame_ms : float, ms
        Of one core, in the mean, to find an attitude or refuse.
    across_arcsec, about_arcsec : float or None, arcsec
        Root mean square error on each axis across the boresight, and about it; None, as all that
        follows, if no attitude is right.
    across_over_bound, about_over_bound : float or None
    nees : float or None
        Over its 3 degrees of freedom, in the mean.
    stars : float or None
        Identified, in the mean.
    """

    sky: str
    attitudes: int
    identified: float
    wrong: int
    most_triangles: int
    frame_ms: float
    across_arcsec: float | None = None
    about_arcsec: float | None = None
    across_over_bound: float | None = None
    about_over_bound: float | None = None
    nees: float | None = None
    stars: float | None = None


def surveyed(sky: str, outcomes: Sequence[Outcome]) -> Surveyed:
    """Summarise the attitudes of a sky.

    Parameters
    ----------
    sky : str
    outcomes : sequence of Outcome
    """

    def whole(name: str) -> Floats:
        return np.concatenate([each.values[name] for each in outcomes])

    found, error = whole("found"), whole("error_rad")
    off = np.linalg.norm(error, axis=1) / ARCSEC
    right = found & (np.nan_to_num(off, nan=np.inf) <= WRONG_ARCSEC)
    summary = Surveyed(
        sky=sky,
        attitudes=len(found),
        identified=float(right.mean()),
        wrong=int(np.count_nonzero(found & ~right)),
        most_triangles=int(whole("triangles").max()),
        frame_ms=1e3 * float(np.mean(np.concatenate([each.seconds for each in outcomes]))),
    )
    if not right.any():
        return summary
    own, stated, bound = error[right], whole("stated_rad2")[right], whole("bound_rad2")[right]
    across, about = np.sqrt(np.mean(own[:, :2] ** 2)), np.sqrt(np.mean(own[:, 2] ** 2))
    least = np.mean(np.diagonal(bound, axis1=1, axis2=2), axis=0)
    squares = np.einsum("ni,ni->n", own, np.linalg.solve(stated, own[..., None])[..., 0])
    return replace(
        summary,
        across_arcsec=float(across / ARCSEC),
        about_arcsec=float(about / ARCSEC),
        across_over_bound=float(across / np.sqrt(least[:2].mean())),
        about_over_bound=float(about / np.sqrt(least[2])),
        nees=float(squares.mean() / DOF),
        stars=float(whole("stars")[right].mean()),
    )
