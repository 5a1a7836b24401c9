from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.dataset.detector_file import RANGES, detector_to_toml, read_detector
from models.errors import DatasetError
from models.sensors.camera_chip import Detector

NUMBERS = {key: st.floats(*span) for key, span in RANGES.items()}


@given(st.builds(Detector, **NUMBERS, bits=st.integers(1, 16)))
def test_any_detector_comes_back(tmp_path_factory: pytest.TempPathFactory, told: Detector) -> None:
    path = tmp_path_factory.mktemp("any") / "detector.toml"
    path.write_text(detector_to_toml(told))
    if told.bias_dn < told.max_dn:
        assert read_detector(path) == told
    else:
        with pytest.raises(DatasetError, match="bias_dn below the converter's end"):
            read_detector(path)


def test_every_number_has_a_range() -> None:
    assert {field.name for field in fields(Detector)} == {*RANGES, "bits", "mosaic"}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("bits = 12\n", "", r"unknown: none; missing: bits"),
        ("bits = 12", "bits = 12\nbit = 12", r"unknown: bit; missing: none"),
        ("bits = 12", 'bits = "12"', "bits to be a whole number, got '12'"),
        ("bits = 12", "bits = true", "bits to be a whole number, got True"),
        ("bits = 12", "bits = 12.0", r"bits to be a whole number, got 12\.0"),
        ("bits = 12", "bits = 60", "bits of at least 1 and at most 16, got 60"),
        ("prnu = 0.005", "prnu = -0.005", r"prnu of at least 0 .*, got -0\.005"),
        ("prnu = 0.005", "prnu = nan", "prnu of at least 0 .*, got nan"),
        ("prnu = 0.005", "prnu = inf", "prnu of at least 0 .*, got inf"),
        ("prnu = 0.005", "prnu = true", "prnu to be a number, got True"),
        ("bias_dn = 100.0", "bias_dn = 5000.0", "bias_dn below the converter's end, 4095 DN"),
    ],
)
def test_a_detector_that_cannot_be_is_refused(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    text = detector_to_toml(Detector())
    assert old in text
    path = tmp_path / "detector.toml"
    path.write_text(text.replace(old, new))
    with pytest.raises(DatasetError, match=rf"detector\.toml: expected .*{said}"):
        read_detector(path)


def test_the_filters_of_a_colour_chip_are_told_and_those_of_no_other(tmp_path: Path) -> None:
    path = tmp_path / "detector.toml"
    for detector in (Detector(), Detector(mosaic="rggb")):
        path.write_text(detector_to_toml(detector))
        assert ("mosaic" in path.read_text()) == (detector.mosaic != "none")
        assert read_detector(path) == detector
    path.write_text(detector_to_toml(Detector(mosaic="rggb")).replace("rggb", "xtrans"))
    with pytest.raises(DatasetError, match="expected mosaic as one of none, rggb"):
        read_detector(path)
