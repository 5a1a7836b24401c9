"""Navigation records as rows of table streams: what a dataset keeps, and a pipeline reads."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from models.arrays import Floats
from models.errors import DatasetError
from models.frame import Reading, TableReading
from models.navigation_records import (
    GnssEpoch,
    InertialInterval,
    NavigationRecord,
    StarAttitude,
)

GNSS, INERTIAL, STARS = "gnss", "inertial", "star_attitude"
GNSS_COLUMNS = (
    "satellite", "sent_x_m", "sent_y_m", "sent_z_m", "sent_x_m_s", "sent_y_m_s", "sent_z_m_s",
    "cn0_dbhz", "pseudorange_m", "range_rate_m_s",
)  # fmt: skip
INERTIAL_COLUMNS = (
    "duration_s", "turn_x_rad", "turn_y_rad", "turn_z_rad",
    "thrusting", "force_x_m_s2", "force_y_m_s2", "force_z_m_s2",
)  # fmt: skip
STARS_COLUMNS = ("qw", "qx", "qy", "qz", "xx_rad2", "xy_rad2", "xz_rad2", "yy_rad2", "yz_rad2",
                 "zz_rad2")  # fmt: skip
COLUMNS = {GNSS: GNSS_COLUMNS, INERTIAL: INERTIAL_COLUMNS, STARS: STARS_COLUMNS}
UNIT_TOLERANCE = 1e-3  # of a quaternion's length; what is nearer is made exact
MOST_STEP_S = 60.0  # of an inertial interval: more is a gap
UPPER = np.triu_indices(3)


def table_of(record: NavigationRecord) -> tuple[str, TableReading]:
    """Return the stream of a record of one run, and its rows."""
    if isinstance(record, GnssEpoch):
        rows = np.column_stack(
            [
                record.satellite,
                record.sent_from_m,
                record.sent_at_m_s,
                record.cn0_dbhz,
                record.pseudorange_m[0],
                record.range_rate_m_s[0],
            ]
        )
        return GNSS, _reading(GNSS, record.time_s, rows)
    if isinstance(record, InertialInterval):
        force = record.specific_force_m_s2
        felt = np.zeros(3) if force is None else force[0]
        row = np.concatenate(
            [[record.duration_s], record.turn_rad[0], [float(force is not None)], felt]
        )
        return INERTIAL, _reading(INERTIAL, record.time_s, row[None])
    covariance = np.broadcast_to(record.covariance_rad2, (1, 3, 3))[0]
    row = np.concatenate([record.q_inertial_from_body_wxyz[0], covariance[UPPER]])
    return STARS, _reading(STARS, record.time_s, row[None])


def records_of(readings: Mapping[str, Reading]) -> list[NavigationRecord]:
    """Return the records of a frame in the order of their times: turns before what they lead to.

    Raises
    ------
    DatasetError
        If a row cannot be: a quaternion without length, a covariance that is none, an interval
        without duration.
    """
    found: list[NavigationRecord] = []
    for stream, read in ((INERTIAL, _intervals), (GNSS, _epochs), (STARS, _attitudes)):
        table = readings.get(stream)
        if isinstance(table, TableReading) and len(table.time_s):
            if table.columns != COLUMNS[stream]:
                raise DatasetError(
                    f"stream {stream}: expected the columns {', '.join(COLUMNS[stream])}, got "
                    f"{', '.join(table.columns)}"
                )
            found += read(table)
    return sorted(found, key=lambda record: record.time_s)


def _reading(stream: str, time_s: float, rows: Floats) -> TableReading:
    return TableReading(COLUMNS[stream], np.full(len(rows), time_s), rows.astype(np.float64))


def _intervals(table: TableReading) -> list[NavigationRecord]:
    found: list[NavigationRecord] = []
    for time_s, row in zip(table.time_s.tolist(), table.rows, strict=True):
        if not 0.0 < row[0] <= MOST_STEP_S:
            raise DatasetError(
                f"stream {INERTIAL} at {time_s} s: expected a duration above 0 and up to "
                f"{MOST_STEP_S:g} s, got {row[0]}"
            )
        force = row[None, 5:8] if row[4] > 0.5 else None
        found.append(InertialInterval(time_s, float(row[0]), row[None, 1:4], force))
    return found


def _epochs(table: TableReading) -> list[NavigationRecord]:
    found: list[NavigationRecord] = []
    for time_s in np.unique(table.time_s).tolist():
        rows = table.rows[table.time_s == time_s]
        found.append(
            GnssEpoch(
                time_s,
                rows[:, 0].astype(np.int64),
                rows[:, 1:4],
                rows[:, 4:7],
                rows[:, 7],
                rows[None, :, 8],
                rows[None, :, 9],
            )
        )
    return found


def _attitudes(table: TableReading) -> list[NavigationRecord]:
    found: list[NavigationRecord] = []
    for time_s, row in zip(table.time_s.tolist(), table.rows, strict=True):
        length = float(np.linalg.norm(row[:4]))
        covariance = np.zeros((3, 3))
        covariance[UPPER] = row[4:]
        covariance += np.triu(covariance, 1).T
        if abs(length - 1.0) > UNIT_TOLERANCE or not np.linalg.eigvalsh(covariance)[0] > 0.0:
            raise DatasetError(
                f"stream {STARS} at {time_s} s: expected a unit quaternion and a positive "
                f"covariance, got a length of {length:.6g} and {covariance.tolist()} rad2"
            )
        found.append(StarAttitude(time_s, row[None, :4] / length, covariance))
    return found
