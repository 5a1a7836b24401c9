"""What star frames came to: shares identified, errors over the bound, honesty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
    across_arcsec, about_arcsec : float, arcsec
        Root mean square error on each axis across the boresight, and about it.
    across_over_bound, about_over_bound : float
    nees : float
        Over its 3 degrees of freedom, in the mean.
    stars : float
        Identified, in the mean.
    most_triangles : int
    frame_s : float, s
        Of one core, in the mean, to find an attitude or refuse.
    """

    sky: str
    attitudes: int
    identified: float
    wrong: int
    across_arcsec: float
    about_arcsec: float
    across_over_bound: float
    about_over_bound: float
    nees: float
    stars: float
    most_triangles: int
    frame_s: float


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
    own, stated, bound = error[right], whole("stated_rad2")[right], whole("bound_rad2")[right]
    across = np.sqrt(np.mean(own[:, :2] ** 2)) if len(own) else np.nan
    about = np.sqrt(np.mean(own[:, 2] ** 2)) if len(own) else np.nan
    least = np.sqrt(np.mean(np.diagonal(bound, axis1=1, axis2=2)[:, :2])) if len(own) else np.nan
    least_about = np.sqrt(np.mean(bound[:, 2, 2])) if len(own) else np.nan
    squares = np.einsum("ni,ni->n", own, np.linalg.solve(stated, own[..., None])[..., 0])
    return Surveyed(
        sky=sky,
        attitudes=len(found),
        identified=float(right.mean()),
        wrong=int(np.count_nonzero(found & ~right)),
        across_arcsec=float(across / ARCSEC),
        about_arcsec=float(about / ARCSEC),
        across_over_bound=float(across / least),
        about_over_bound=float(about / least_about),
        nees=float(squares.mean() / DOF) if len(own) else np.nan,
        stars=float(whole("stars")[right].mean()) if len(own) else np.nan,
        most_triangles=int(whole("triangles").max()),
        frame_s=float(np.mean(np.concatenate([each.seconds for each in outcomes]))),
    )
