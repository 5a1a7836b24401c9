"""One image: every bit comes back, and what is damaged, or no 16-bit PNG, is refused."""

from __future__ import annotations

import os
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from models.arrays import AnyArray, Image
from models.dataset.image_file import check_image_size, encode_image, read_image
from models.errors import DatasetError
from tests.support.public_halves import CAMERA, noise_image

IMAGE = noise_image(0)
SIZE, CHUNK, CHECKSUM = slice(16, 24), slice(12, 29), slice(29, 33)  # in a PNG's header


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "a.png").write_bytes(encode_image(IMAGE))
    return tmp_path / "a.png"


@given(arrays(np.uint16, st.tuples(st.integers(1, 9), st.integers(1, 9))))
def test_any_16_bit_image_survives_and_encodes_alike(
    tmp_path_factory: pytest.TempPathFactory, image: Image
) -> None:
    data = encode_image(image)
    assert data == encode_image(image.copy())
    path = tmp_path_factory.mktemp("any") / "a.png"
    path.write_bytes(data)
    np.testing.assert_array_equal(read_image(path), image)


def test_an_image_of_its_cameras_size_is_read(path: Path) -> None:
    check_image_size(path, CAMERA)
    np.testing.assert_array_equal(read_image(path, CAMERA), IMAGE)


@pytest.mark.parametrize("image", [IMAGE[:10], IMAGE[:, 1:], np.zeros((99, 99), np.uint16)])
def test_an_image_of_another_size_is_refused(path: Path, image: Image) -> None:
    path.write_bytes(encode_image(image))
    said = rf"a\.png: expected 32 x 32 pixels, .*got {image.shape[1]} x {image.shape[0]}"
    with pytest.raises(DatasetError, match=said):
        check_image_size(path, CAMERA)
    with pytest.raises(DatasetError, match=said):
        read_image(path, CAMERA)


def test_a_header_that_promises_gigabytes_is_not_believed(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[SIZE] = 2 * (2**16).to_bytes(4, "big")
    data[CHECKSUM] = zlib.crc32(data[CHUNK]).to_bytes(4, "big")
    path.write_bytes(data)
    with pytest.raises(DatasetError, match="expected a whole PNG"):
        read_image(path)
    with pytest.raises(DatasetError, match="expected 32 x 32 pixels"):
        read_image(path, CAMERA)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.99])
def test_a_truncated_image_is_refused(path: Path, share: float) -> None:
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    with pytest.raises(DatasetError, match=r"whole PNG at .*a\.png.*render again"):
        read_image(path)


@pytest.mark.parametrize("share", [0.05, 0.3, 0.6, 0.9])
def test_an_image_with_a_flipped_bit_is_refused(path: Path, share: float) -> None:
    data = bytearray(path.read_bytes())
    data[int(share * len(data))] ^= 0x10
    path.write_bytes(data)
    with pytest.raises(DatasetError, match=r"whole PNG at .*a\.png"):
        read_image(path)


def test_an_image_with_its_middle_cut_out_is_refused(path: Path) -> None:
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2] + data[-12:])
    with pytest.raises(DatasetError, match="expected a whole PNG"):
        read_image(path)


@pytest.mark.parametrize(
    ("image", "said"),
    [
        (np.zeros((4, 4), np.uint8), "of uint8"),
        (np.zeros((4, 4, 3), np.uint16), r"shape \(4, 4, 3\)"),
    ],
)
def test_an_image_of_another_kind_is_refused(path: Path, image: AnyArray, said: str) -> None:
    path.write_bytes(encode_image(image))
    with pytest.raises(DatasetError, match=f"expected a 16-bit single-channel image .*{said}"):
        read_image(path)


def test_a_picture_that_is_no_png_is_refused(path: Path) -> None:
    ok, data = cv2.imencode(".jpg", np.zeros((8, 8), np.uint8))
    assert ok
    path.write_bytes(data.tobytes())
    with pytest.raises(DatasetError, match="expected a whole PNG"):
        read_image(path)
    with pytest.raises(DatasetError, match=r"expected 32 x 32 pixels, .* got no PNG"):
        check_image_size(path, CAMERA)


@pytest.mark.parametrize("read", [read_image, lambda path: check_image_size(path, CAMERA)])
def test_what_is_no_file_is_told_and_not_waited_for(tmp_path: Path, read) -> None:
    """A pipe that nobody writes to would keep its reader for ever."""
    path = tmp_path / "a.png"
    with pytest.raises(DatasetError, match=r"expected an image at .*a\.png.*No such file.*render"):
        read(path)
    os.mkfifo(path)
    with pytest.raises(DatasetError, match=r"expected an image at .*a\.png.*a pipe"):
        read(path)
    path.unlink()
    path.mkdir()
    with pytest.raises(DatasetError, match=r"expected an image at .*a\.png.*a folder"):
        read(path)
