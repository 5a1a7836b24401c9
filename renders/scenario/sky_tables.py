"""The tables of a scenario that tell of the sky: what shines behind everything."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from models.errors import ScenarioError
from models.sky.earth_pointing import GEO_RATE_DEG_H
from renders.scenario.table import Numbers, Table, Triple

UNIT_TOLERANCE = 1e-3  # a quaternion typed with four digits is one


class StarsTable(Table):
    """The stars behind everything, and how the target stands among them.

    The attitude is that of the target's nominal axes at motion time 0, Earth-pointing at GEO (see
    ``models.sky.earth_pointing``) unless a quaternion says otherwise; from there it turns at the
    rate given, and sways as ``[motion]`` says. With ``[tumble]`` all of it follows from the motion,
    and ``shine`` alone may be given.
    """

    shine: bool = Field(False, description="whether they are seen")
    zenith_right_ascension_deg: float = Field(
        262.0,
        ge=0,
        lt=360,
        description="where +z points; a camera facing the deck sees the other end",
    )
    q_target_from_icrs_wxyz: Numbers = Field(
        (), description="instead of the zenith; of the nominal axes, at motion time 0"
    )
    rate_in_target_deg_h: Triple = Field(
        (0.0, -GEO_RATE_DEG_H, 0.0), description="of the nominal axes, in space, about themselves"
    )


def check_stars(table: StarsTable, where: str) -> None:
    """Refuse an attitude that is none.

    Raises
    ------
    ScenarioError
    """
    wxyz = table.q_target_from_icrs_wxyz
    if wxyz and (len(wxyz) != 4 or abs(np.linalg.norm(wxyz) - 1.0) > UNIT_TOLERANCE):
        raise ScenarioError(
            f"{where}: expected stars.q_target_from_icrs_wxyz of four numbers and length 1, scalar "
            f"first, got {list(wxyz)}; leave it out for an Earth-pointing target at GEO"
        )
