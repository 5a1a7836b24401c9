from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.dataset.frame_table import FrameEntry
from models.dataset.sensor_table import LARGEST, read_table, table_to_csv
from models.errors import DatasetError
from models.frame import TableReading

COLUMNS = ("range_m", "sigma_m")
ENTRIES = [FrameEntry(0, 0.0), FrameEntry(2, 1.0), FrameEntry(5, 3.0)]
HEADER = "index,time_s,range_m,sigma_m\n"
NUMBERS = st.floats(-LARGEST, LARGEST)


@st.composite
def readings(draw: st.DrawFn) -> dict[int, TableReading]:
    """Up to four rows for each frame, later than those before and not later than it."""
    found, after = {}, -5.0
    for entry in ENTRIES:
        times = draw(st.lists(st.floats(after, entry.time_s), max_size=4).map(sorted))
        rows = [[draw(NUMBERS), draw(NUMBERS)] for _ in times]
        after = max([after, *times])
        found[entry.index] = TableReading(
            COLUMNS, np.array(times), np.array(rows).reshape(len(times), 2)
        )
    return found


@given(readings())
def test_any_readings_come_back_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory, told: dict[int, TableReading]
) -> None:
    path = tmp_path_factory.mktemp("any") / "ranges.csv"
    path.write_text(table_to_csv(COLUMNS, told.items()))
    back = read_table(path, COLUMNS, ENTRIES)
    assert back.keys() == told.keys()
    for index, reading in told.items():
        assert back[index].columns == COLUMNS
        np.testing.assert_array_equal(back[index].time_s, reading.time_s)
        np.testing.assert_array_equal(back[index].rows, reading.rows)
    assert table_to_csv(COLUMNS, back.items()) == path.read_text()


def test_a_frame_without_rows_has_a_reading_without_rows(tmp_path: Path) -> None:
    path = tmp_path / "ranges.csv"
    path.write_text(HEADER + "2,0.5,9,1\n2,0.75,8,1\n")
    back = read_table(path, COLUMNS, ENTRIES)
    assert [len(back[index].time_s) for index in (0, 2, 5)] == [0, 2, 0]
    assert back[0].rows.shape == (0, 2)
    assert back[2].column("range_m").tolist() == [9.0, 8.0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("index,time_s,range_m\n", "missing: sigma_m"),
        (HEADER.replace("sigma_m", "w"), "missing: sigma_m; unknown: 'w'"),
        (HEADER + "2,1.0,9\n", "expected 4 cells, got 3"),
        (HEADER + "1,0.5,9,1\n", r":2: expected the number of a frame of frames.csv, got 1"),
        (HEADER + "7,0.5,9,1\n", "a frame of frames.csv, got 7"),
        (HEADER + "2,1.5,9,1\n", r"up to frame 2's, 1\.0 s; got 1\.5 s"),
        (HEADER + "2,0.5,9,1\n5,0.4,9,1\n", r":3: expected times that do not run back"),
        (HEADER + "2,nan,9,1\n", "time_s to be a number"),
        (HEADER + "2,1.0,nan,1\n", "range_m to be a number"),
        (HEADER + "2,1.0,1e300,1\n", "range_m .*at most 1e.15"),
        (HEADER + "2,1.0,,1\n", "range_m to be a number"),
    ],
)
def test_a_table_that_cannot_be_is_refused(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "ranges.csv"
    path.write_text(text)
    with pytest.raises(DatasetError, match=rf"ranges\.csv.*{said}"):
        read_table(path, COLUMNS, ENTRIES)


def test_a_missing_table_is_named(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"ranges\.csv: No such file"):
        read_table(tmp_path / "ranges.csv", COLUMNS, ENTRIES)
