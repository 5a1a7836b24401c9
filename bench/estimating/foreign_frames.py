"""Anybody's image pairs, made into what the pipeline takes.

A folder of ``NAME_800.png`` and ``NAME_850.png``, 8 or 16 bits, grey; TIFFs and JPEGs will do.
Pairs are taken in the order of their names. Times come from ``frames.csv`` (index, time_s,
exposure_ms) in the folder where there is one, else from the rate given; the first pose comes from a
``prior.toml``.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.estimating.contenders import contenders
from bench.estimating.estimates_place import check_estimates_place
from bench.estimating.estimation import tell_of
from bench.estimating.foreign_images import (
    images_by_name,
    read_foreign_image,
    read_header,
)
from bench.estimating.runner import estimate_run
from models.arrays import Image
from models.camera import Camera
from models.dataset.detector_file import read_detector
from models.dataset.frame_table import FrameEntry, read_frame_entries
from models.dataset.marker_file import read_markers
from models.dataset.prior_file import read_prior
from models.dataset.version1 import PAIR_GAP_S
from models.errors import DatasetError, ScenarioError
from models.frame import IMAGE_800, IMAGE_850, Frame, ImageReading, Reading
from models.markers import MarkerPattern
from models.onboard import OnboardKnowledge
from models.sensors.camera_chip import Detector

UNKNOWN_EXPOSURE_MS = 1.0  # no pipeline measures with it
BITS = (8, 10, 12, 14, 16)


@dataclass(frozen=True)
class ForeignPair:
    """One image pair on disk."""

    entry: FrameEntry
    path_800: Path
    path_850: Path


def estimate_pairs(
    folder: Path,
    camera: Camera,
    target: str,
    prior: Path | None,
    detector: Path | None,
    rate_hz: float,
    out: Path,
    pipelines: Sequence[str] = (),
    limit_s: float | None = None,
) -> list[Path]:
    """Estimate every image pair of a folder with every variant.

    Parameters
    ----------
    folder : Path
        Of image pairs.
    camera : Camera
        As calibrated.
    target : str
        Whose markers they show: a target's name, or a ``markers.toml``.
    prior : Path or None
        The first pose; else ``prior.toml`` in or beside the folder.
    detector : Path or None
        Else guessed from the first image; see ``guessed_detector``.
    rate_hz : float, Hz
        Where the folder has no ``frames.csv``.
    out : Path
        The estimates go to ``out/estimates``.
    pipelines : sequence of str
        Labels or names of pipelines; all that take pairs unless given.
    limit_s : float, optional, s
        Most that a frame may take.

    Returns
    -------
    list of Path
        The estimates files.

    Raises
    ------
    DatasetError, ScenarioError
        If the pairs, the prior or the target cannot be used.
    """
    if not 0.0 < rate_hz < np.inf:
        raise ScenarioError(f"expected a rate in Hz above zero, got {rate_hz}")
    pairs = find_pairs(folder, rate_hz)
    check_estimates_place(out, folder)
    has_jpegs = check_headers(pairs, camera)
    knowledge = foreign_knowledge(folder, pairs, camera, target, prior, detector)
    if has_jpegs:
        print(
            "rvbench: warning: there are JPEGs among these images, whose compression moves the "
            "centroids of markers; their sigmas know nothing of it. Write PNG or TIFF if you can",
            file=sys.stderr,
        )
    chosen, remarks = contenders((IMAGE_800, IMAGE_850), ("chaser_fixed",), pipelines)
    tell_of(remarks)
    return estimate_run(out, 0, read_pairs(pairs, camera), knowledge, chosen, len(pairs), limit_s)


def find_pairs(folder: Path, rate_hz: float) -> list[ForeignPair]:
    """List the image pairs of a folder, in order of name.

    Raises
    ------
    DatasetError
        If there are none, one of a pair is missing, or ``frames.csv`` has another number of rows.
    """
    found = images_by_name(folder)
    for band, other in ((800, 850), (850, 800)):
        alone = sorted(set(found[other]) - set(found[band]))
        if alone:
            beside = found[other][alone[0]]
            raise DatasetError(
                f"{folder}: expected {alone[0]}_{band}{beside.suffix} beside {beside.name}, found "
                f"none (images alone at {other} nm: {len(alone)}); add it, or take the other away"
            )
    names = sorted(found[850], key=_natural)
    entries = [FrameEntry(k, k / rate_hz, UNKNOWN_EXPOSURE_MS) for k in range(len(names))]
    if (folder / "frames.csv").is_file():
        entries = read_frame_entries(folder)
        if len(entries) != len(names):
            raise DatasetError(
                f"{folder}/frames.csv: expected one row for each of {len(names)} image pairs, "
                f"got {len(entries)}"
            )
    return [
        ForeignPair(entry, found[800][name], found[850][name])
        for entry, name in zip(entries, names, strict=True)
    ]


def read_pairs(pairs: list[ForeignPair], camera: Camera) -> Iterator[Frame]:
    """Read image pairs one at a time.

    Raises
    ------
    DatasetError
        If an image is not whole, not grey, not of the camera's size or of another depth than the
        first.
    """
    first_bits = None
    for pair in pairs:
        images = []
        for path in (pair.path_800, pair.path_850):
            image = read_foreign_image(path)
            first_bits = first_bits or image.bits
            _check_size(path, image.pixels.shape[1], image.pixels.shape[0], camera)
            _check_bits(path, image.bits, first_bits)
            images.append(image.pixels)
        entry = pair.entry
        readings: dict[str, Reading] = {
            IMAGE_800: ImageReading(images[0], entry.time_s - PAIR_GAP_S, entry.exposure_ms),
            IMAGE_850: ImageReading(images[1], entry.time_s, entry.exposure_ms),
        }
        yield Frame(entry.index, entry.time_s, readings)


def check_headers(pairs: list[ForeignPair], camera: Camera) -> bool:
    """Refuse images of another size than the camera's, or of two depths, before the first is read.

    PNGs alone tell both in their first bytes; ``read_pairs`` looks at all.

    Returns
    -------
    bool
        Whether there are JPEGs among them.

    Raises
    ------
    DatasetError
        The message names the file.
    """
    first_bits, has_jpegs = None, False
    for path in (path for pair in pairs for path in (pair.path_800, pair.path_850)):
        header = read_header(path)
        has_jpegs |= header.is_jpeg
        if header.bits is not None:
            first_bits = first_bits or header.bits
            _check_size(path, *header.size, camera)
            _check_bits(path, header.bits, first_bits)
    return has_jpegs


def _check_size(path: Path, width: int, height: int, camera: Camera) -> None:
    if (width, height) != (camera.width, camera.height):
        raise DatasetError(
            f"{path}: expected {camera.width} x {camera.height} pixels, as the camera has, "
            f"got {width} x {height}; give the camera that took them"
        )


def _check_bits(path: Path, bits: int, first: int) -> None:
    if bits != first:
        raise DatasetError(
            f"{path}: expected {first} bits, as the first image of the folder has, got {bits}; "
            "one detector took them all: write them all alike"
        )


def read_grey(path: Path) -> Image:
    """Read the pixels of a grey image, uint16; see ``foreign_images.read_foreign_image``."""
    return read_foreign_image(path).pixels


def marker_pattern(target: str) -> MarkerPattern:
    """Return a target's markers, by its name or from a ``markers.toml``.

    Raises
    ------
    ScenarioError
        If there is no such target or it has no markers.
    """
    if target.endswith(".toml"):
        return read_markers(Path(target))
    from models.spacecraft.catalogue import spacecraft_by_name  # builds meshes: only when asked

    markers = spacecraft_by_name(target).markers
    if markers is None:
        raise ScenarioError(
            f"expected a target with markers, got {target!r}, which has none; "
            "give its markers as a .toml file"
        )
    return markers


def guessed_detector(image: Image) -> Detector:
    """Guess a detector from one of its images: bits from the largest number, no bias.

    Gain and noise follow from a full well of 100 000 e over those bits; they weigh centroids
    against each other and decide what is saturated, so a rough guess serves.
    """
    largest = max(int(image.max()), 1)
    bits = next(bits for bits in BITS if largest < 2**bits)
    default = Detector()
    return Detector(gain_e_dn=default.full_well_e / 2**bits, bias_dn=0.0, bits=bits)


def foreign_knowledge(
    folder: Path,
    pairs: list[ForeignPair],
    camera: Camera,
    target: str,
    prior: Path | None,
    detector: Path | None,
) -> OnboardKnowledge:
    """Gather what must be known before the first frame.

    Raises
    ------
    ScenarioError
        If there is no prior: the pipeline tracks, it does not acquire.
    """
    beside = [place / "prior.toml" for place in (folder, folder.parent)]
    path = prior or next((place for place in beside if place.is_file()), None)
    if path is None:
        raise ScenarioError(
            f"expected a first pose: none was given with --prior, and there is no {beside[0]}; "
            "this pipeline tracks from a prior. Write a TOML file with t_cam_from_target_m, "
            "euler_321_deg, sigma_t_m and sigma_euler_deg, three numbers each"
        )
    return OnboardKnowledge(
        camera=camera,
        detector=_detector(pairs[0].path_850, detector),
        markers=marker_pattern(target),
        prior=read_prior(path),
    )


def _detector(image: Path, given: Path | None) -> Detector:
    """Read the detector given, and hold it against an image; guess it where none is given."""
    found = read_foreign_image(image)
    if given is None:
        return guessed_detector(found.pixels)
    detector, largest = read_detector(given), int(found.pixels.max())
    if found.bits < detector.bits or largest > detector.max_dn:
        raise DatasetError(
            f"{given}: expected the detector of these images, got one of {detector.bits} bits; "
            f"{image} has {found.bits} bits and values up to {largest}; "
            "leave --detector out to have it guessed"
        )
    return detector


def _natural(name: str) -> tuple[tuple[int, str], ...]:
    parts = re.split(r"(\d+)", name)
    return tuple((int(part), "") if part.isdigit() else (-1, part) for part in parts)
