from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.dataset.frame_table import FrameEntry, frames_to_csv, read_frame_entries
from models.errors import DatasetError
from models.reading.bounds import EXPOSURE_MS, FRAME, TIME_S

HEADER = "index,time_s,exposure_ms\n"


@st.composite
def frame_lists(draw: st.DrawFn) -> list[FrameEntry]:
    indices = draw(st.lists(st.integers(*FRAME), unique=True, max_size=8).map(sorted))
    times = draw(
        st.lists(st.floats(*TIME_S), unique=True, min_size=len(indices), max_size=len(indices)).map(
            sorted
        )
    )
    exposures = st.one_of(st.just(0.0), st.floats(*EXPOSURE_MS))
    return [
        FrameEntry(index, time_s, draw(exposures))
        for index, time_s in zip(indices, times, strict=True)
    ]


@given(frame_lists())
def test_any_list_comes_back_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory, entries: list[FrameEntry]
) -> None:
    folder = tmp_path_factory.mktemp("any")
    (folder / "frames.csv").write_text(frames_to_csv(entries))
    assert read_frame_entries(folder) == entries


def test_numbers_of_numpy_are_numbers(tmp_path: Path) -> None:
    entries = [FrameEntry(np.int64(3), np.float64(0.1), np.float32(0.5))]
    assert frames_to_csv(entries) == HEADER + "3,0.1,0.5\n"


def test_where_nothing_is_exposed_no_exposure_need_stand(tmp_path: Path) -> None:
    (tmp_path / "frames.csv").write_text("index,time_s\n2,0.5\n")
    assert read_frame_entries(tmp_path) == [FrameEntry(2, 0.5, 0.0)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "missing: index, time_s"),
        ("index,exposure_ms\n0,1.0\n", "missing: time_s"),
        (HEADER.replace("\n", ",pose\n") + "0,0.0,1.0,2\n", "unknown: 'pose'"),
        ("index,time_s,time_s\n0,0.0,1.0\n", "twice: time_s"),
        (HEADER + "0,0.0\n", "expected 3 cells, got 2"),
        (HEADER + "zero,0.0,1.0\n", r":2: expected index to be a whole number, got 'zero'"),
        (HEADER + "0.5,0.0,1.0\n", "expected index to be a whole number"),
        (HEADER + "-1,0.0,1.0\n", "expected index of at least 0"),
        (HEADER + "0,nan,1.0\n", "expected time_s to be a number, got 'nan'"),
        (HEADER + "0,1e200,1.0\n", "expected time_s .*at most 1e.09, got 1e.200"),
        (HEADER + "0,np.float64(0.1),1.0\n", "expected time_s to be a number"),
        (HEADER + "0,0.0,-1.0\n", "expected exposure_ms of at least 0"),
        (HEADER + "0,0.0,inf\n", "expected exposure_ms to be a number, got 'inf'"),
        (HEADER + "1,0.0,1.0\n1,0.2,1.0\n", "rising indices and times"),
        (HEADER + "2,0.0,1.0\n1,0.2,1.0\n", "rising indices and times"),
        (HEADER + "0,0.2,1.0\n1,0.2,1.0\n", "rising indices and times"),
    ],
)
def test_a_list_that_cannot_be_is_refused(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "frames.csv").write_text(text)
    with pytest.raises(DatasetError, match=rf"frames\.csv.*{said}"):
        read_frame_entries(tmp_path)


def test_a_missing_or_binary_list_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"frames\.csv: No such file"):
        read_frame_entries(tmp_path)
    (tmp_path / "frames.csv").write_bytes(b"index,time_s\xff\xfe\n")
    with pytest.raises(DatasetError, match=r"frames\.csv.*no UTF-8"):
        read_frame_entries(tmp_path)
