"""``dataset.json``: what is written comes back, what is not ours or cannot be is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from models.dataset.description import DatasetInfo, Stream, info_to_json, read_info
from models.errors import DatasetError
from models.frame import CHASER_ORBIT, IMAGE_850
from tests.support.public_halves import IMAGES, PAIRS, as_version_1, write_pairs

WORDS = st.text(st.characters(codec="utf-8", categories=("L", "N", "P")), max_size=20)
NAMES = st.from_regex(r"[a-z][a-z0-9_]{0,10}", fullmatch=True)
STREAMS = st.one_of(
    st.builds(
        Stream,
        name=NAMES,
        kind=st.just("image"),
        files=NAMES.map(lambda name: f"images/{name}_{{index:06d}}.png"),
        offset_s=st.floats(-10.0, 10.0),
    ),
    st.builds(
        Stream,
        name=NAMES,
        kind=st.just("table"),
        files=NAMES.map(lambda name: f"{name}.csv"),
        columns=st.lists(NAMES.map("x_{}".format), min_size=1, unique=True).map(tuple),
    ),
    st.builds(
        Stream,
        name=NAMES,
        kind=st.just("estimates"),
        files=NAMES.map(lambda name: f"estimates/{name}.jsonl"),
    ),
)
INFOS = st.builds(
    DatasetInfo,
    case=WORDS,
    sun=WORDS,
    frames=st.integers(1, 1_000_000),
    target=WORDS,
    chain=WORDS,
    streams=st.lists(STREAMS, min_size=1, max_size=5, unique_by=lambda each: each.name).map(tuple),
    onboard=st.lists(NAMES.map("{}.toml".format), max_size=5, unique=True).map(tuple),
    provenance=st.dictionaries(NAMES, WORDS, max_size=3),
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_pairs(tmp_path)


def change(folder: Path, **changes: Any) -> None:
    """Set keys of ``dataset.json``; None takes one out."""
    table = {**json.loads((folder / "dataset.json").read_text()), **changes}
    kept = {key: value for key, value in table.items() if value is not None}
    (folder / "dataset.json").write_text(json.dumps(kept))


@settings(max_examples=50, suppress_health_check=[HealthCheck.too_slow])
@given(INFOS)
def test_any_description_comes_back(tmp_path_factory: pytest.TempPathFactory, info) -> None:
    folder = tmp_path_factory.mktemp("any")
    (folder / "dataset.json").write_text(info_to_json(info))
    back = read_info(folder)
    assert back == info
    assert info_to_json(back) == info_to_json(info)


def test_a_stream_is_found_by_name() -> None:
    assert PAIRS.stream(IMAGE_850) is PAIRS.streams[1]
    assert [each.name for each in IMAGES.image_streams] == ["image"]
    with pytest.raises(DatasetError, match=r"'chaser_orbit' .*, got image_800, image_850"):
        PAIRS.stream(CHASER_ORBIT)


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("info", [PAIRS, IMAGES])
def test_version_1_says_the_same(tmp_path: Path, info: DatasetInfo, version: int) -> None:
    """What version 1 left unsaid is what version 2 writes for the two chains that it had."""
    if version == 2:
        (tmp_path / "dataset.json").write_text(info_to_json(info))
    else:
        as_version_1(tmp_path, "rvbench-pairs" if info is PAIRS else "rvbench-images")
    # Version 1 had fixed names of files, in an order of its own.
    back = read_info(tmp_path)
    assert set(back.onboard) == set(info.onboard)
    assert back.version == version
    assert replace(back, onboard=info.onboard, version=info.version) == info


def test_a_folder_without_a_dataset_is_told(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"expected a dataset in .*dataset\.json.*render"):
        read_info(tmp_path)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"version": 3}, "expected format 'rvbench-dataset' of version 2, .* of version 3"),
        ({"version": True}, "of version True"),
        ({"version": 2.0}, r"of version 2\.0"),
        ({"version": None}, "of version None; is it ours. render it again"),
        ({"format": "bop"}, "got 'bop' of version 2"),
        ({"format": ["rvbench-pairs"], "version": 1}, "got .'rvbench-pairs'. of version 1"),
        ({"format": "x" * 10_000}, "got 'x{100,120}'?.{3,4} of version 2"),
        ({"frames": "two"}, "expected frames to be a whole number, got 'two'"),
        ({"frames": True}, "expected frames to be a whole number, got True"),
        ({"frames": 2.0}, r"expected frames to be a whole number, got 2\.0"),
        ({"frames": 0}, "expected frames of at least 1"),
        ({"frames": 10**9}, "expected frames .*at most 1e.06, got 1000000000"),
        ({"case": 5}, "expected case to be text, got 5"),
        ({"case": "x" * 1_000_000}, "expected case of at most 200 characters, got 1000000"),
        ({"case": "\x1b[2J"}, "expected case to be printable text"),
        ({"provenance": []}, r"expected provenance with keys and values, got \[\]"),
        ({"provenance": {"seed": 5}}, "expected provenance.seed to be text, got 5"),
        ({"target": None}, "missing: target"),
        ({"streams": None}, "missing: streams"),
        ({"pose": [0.0, 0.0, 5.0]}, "unknown: pose"),
        ({"streams": {}}, "expected streams as a table with at least one stream"),
        ({"streams": ["image_800"]}, "expected streams with keys and values"),
        ({"onboard": "camera.toml"}, "expected onboard as a list, got 'camera.toml'"),
        ({"onboard": ["camera.toml", "camera.toml"]}, "expected onboard as paths, each once"),
        ({"onboard": ["../camera.toml"]}, "onboard as paths within the dataset's public half"),
        ({"onboard": ["/etc/passwd"]}, "onboard as paths within the dataset's public half"),
        ({"onboard": ["truth/camera.toml"]}, "onboard as paths within the dataset's public half"),
    ],
)
def test_what_cannot_be_is_refused(folder: Path, changes: dict[str, object], said: str) -> None:
    change(folder, **changes)
    with pytest.raises(DatasetError, match=rf"dataset\.json: .*{said}"):
        read_info(folder)


TABLE = {"kind": "table", "files": "a.csv", "columns": ["x_m"]}
PICTURES = {"kind": "image", "files": "a/{index:06d}.png", "offset_s": 0.0}


@pytest.mark.parametrize(
    ("name", "stream", "said"),
    [
        ("Image", PICTURES, "expected streams named by small letters"),
        ("a b", PICTURES, "expected streams named by small letters"),
        ("\n", PICTURES, "expected the keys of streams as printable text"),
        ("a", {**PICTURES, "kind": "sound"}, "expected streams.a.kind as one of image, table"),
        ("a", {**PICTURES, "files": "a.png"}, "expected streams.a.files as a path .*with .index"),
        ("a", {**PICTURES, "files": "../{index:06d}.png"}, "streams.a.files as a path within"),
        ("a", {**PICTURES, "files": "/x/{index:06d}.png"}, "streams.a.files as a path within"),
        ("a", {**PICTURES, "files": "truth/{index:06d}.png"}, "the dataset's public half"),
        ("a", {**PICTURES, "offset_s": "soon"}, "expected streams.a.offset_s to be a number"),
        ("a", {"kind": "image", "files": "{index:06d}.png"}, "missing: offset_s"),
        ("a", {**TABLE, "offset_s": 0.1}, "in streams.a; unknown: offset_s"),
        ("a", {**TABLE, "files": "{index:06d}.csv"}, "for images and for nothing else"),
        ("a", {**TABLE, "files": "truth/exposures.csv"}, "the dataset's public half"),
        ("a", {**TABLE, "columns": []}, "expected streams.a.columns as names"),
        ("a", {**TABLE, "columns": ["x_m", "x_m"]}, "columns as names of .*, each once"),
        ("a", {**TABLE, "columns": ["time_s"]}, "each once, beside index and time_s"),
        ("a", {**TABLE, "columns": ["x,m"]}, "columns as names of letters"),
        ("a", "pictures", "expected streams.a with keys and values, got 'pictures'"),
    ],
)
def test_a_stream_that_cannot_be_is_refused(
    folder: Path, name: str, stream: object, said: str
) -> None:
    change(folder, streams={name: stream})
    with pytest.raises(DatasetError, match=rf"dataset\.json: .*{said}"):
        read_info(folder)


@pytest.mark.parametrize(
    "data",
    [b"", b"{", b"[1, 2]", b"\xff\xfe", b'"rvbench-pairs"', b"[" * 5000, b'{"a": NaN}'],
)
def test_an_info_that_is_no_table_of_json_is_refused(folder: Path, data: bytes) -> None:
    (folder / "dataset.json").write_bytes(data)
    with pytest.raises(DatasetError, match="expected a dataset in"):
        read_info(folder)
