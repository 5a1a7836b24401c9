"""What the absolute navigator has on board: where it starts, and when."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np

from models.arrays import Floats
from models.errors import DatasetError
from models.onboard import OnboardKnowledge, needed
from models.sky.sun_ephemeris import epoch_of
from pipelines.absolute.options import REGIMES

NAME = "absolute"
FILE = "absolute.toml"
MOST = 1e9  # of any number of a start: beyond the Moon


@dataclass(frozen=True, eq=False)
class AbsoluteKnowledge:
    """What is known before the first record.

    Attributes
    ----------
    regime : str
        ``leo`` or ``geo``.
    epoch : datetime
        Of time zero, for Sun and Moon.
    position_m, velocity_m_s : (3,) array
        At time zero, inertial.
    q_inertial_from_body_wxyz : (4,) array
    lasting : bool
        Whether the errors of ranges are known to last.
    relative_from_s : float, s
        When an integrated unit turns to its target; before, it navigates for itself alone.
    """

    regime: str
    epoch: datetime
    position_m: Floats
    velocity_m_s: Floats
    q_inertial_from_body_wxyz: Floats
    lasting: bool = False
    relative_from_s: float = -np.inf

    @classmethod
    def of(cls, onboard: OnboardKnowledge) -> AbsoluteKnowledge:
        """Take it from what is on board, a table ``absolute.toml``.

        Raises
        ------
        DatasetError
            If the table is missing or a value cannot be.
        """
        table = needed(onboard.tables.get(FILE), FILE, NAME)
        regime = table.get("regime")
        if regime not in REGIMES:
            raise DatasetError(
                f"{FILE}: expected regime among {', '.join(REGIMES)}, got {regime!r}"
            )
        quaternion = _numbers(
            table.get("q_inertial_from_body_wxyz"), 4, "q_inertial_from_body_wxyz"
        )
        length = float(np.linalg.norm(quaternion))
        if abs(length - 1.0) > 1e-3:
            raise DatasetError(
                f"{FILE}: expected q_inertial_from_body_wxyz of length 1, got {length:.6g}"
            )
        return cls(
            regime,
            epoch_of(str(table.get("epoch"))),
            _numbers(table.get("position_m"), 3, "position_m"),
            _numbers(table.get("velocity_m_s"), 3, "velocity_m_s"),
            quaternion / length,
            bool(table.get("lasting", False)),
            _time(table),
        )


def _time(table: dict[str, Any]) -> float:
    told = table.get("relative_from_s", -np.inf)
    if isinstance(told, bool) or not isinstance(told, int | float) or np.isnan(told):
        raise DatasetError(f"{FILE}: expected relative_from_s as a time in s, got {told!r}")
    return float(told)


def _numbers(told: object, count: int, name: str) -> Floats:
    try:
        found = np.array(told, dtype=np.float64)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape != (count,) or not (np.abs(found) < MOST).all():
        raise DatasetError(f"{FILE}: expected {name} as {count} finite numbers, got {told!r}")
    return found
