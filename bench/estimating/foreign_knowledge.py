"""What is on board where frames are anybody's: from the files given, or found beside the frames."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bench.estimating.foreign_images import read_foreign_image
from models.arrays import Image
from models.camera import Camera
from models.dataset.detector_file import read_detector
from models.dataset.marker_file import read_markers
from models.dataset.onboard_files import EXPECTATIONS, PRIOR, read_expectations
from models.dataset.prior_file import read_prior
from models.errors import DatasetError, ScenarioError
from models.markers import MarkerPattern
from models.onboard import OnboardKnowledge
from models.reading.toml_file import read_toml
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe
from models.wireframe.wireframe_file import read_wireframe

BITS = (8, 10, 12, 14, 16)


@dataclass(frozen=True)
class GivenFiles:
    """What was typed; None is looked for, or guessed.

    Attributes
    ----------
    target : str
        A target's name, the TOML of a spacecraft of one's own, or a ``markers.toml`` or
        ``wireframe.json``.
    prior : Path or None
        The first pose; else ``prior.toml`` in or beside the folder of the frames.
    detector : Path or None
        Else guessed from the first image; see ``guessed_detector``.
    knowledge : Path or None
        Mount and expected sigmas; else ``knowledge.toml`` in or beside the folder.
    navigation : Path or None
        The chaser's orbit; else ``navigation.csv`` in or beside the folder.
    """

    target: str
    prior: Path | None = None
    detector: Path | None = None
    knowledge: Path | None = None
    navigation: Path | None = None


def beside(folder: Path, name: str, given: Path | None) -> Path | None:
    """Return the file given, else the one of that name in or beside a folder, if there is one.

    Parameters
    ----------
    folder : Path
    name : str
        Of the file, where it is not given.
    given : Path or None
    """
    places = (folder / name, folder.resolve().parent / name)
    return given or next((place for place in places if place.is_file()), None)


def foreign_knowledge(
    folder: Path, image: Path, camera: Camera, given: GivenFiles
) -> OnboardKnowledge:
    """Gather what is known before the first frame.

    Parameters
    ----------
    folder : Path
        Of the frames.
    image : Path
        The first, from which a detector is guessed.
    camera : Camera
        As calibrated.
    given : GivenFiles

    Raises
    ------
    DatasetError, ScenarioError
        If a file cannot be, or there is no such target.
    """
    markers, wireframe = markers_and_wireframe(given.target)
    prior = beside(folder, PRIOR, given.prior)
    knowledge = beside(folder, EXPECTATIONS, given.knowledge)
    return OnboardKnowledge(
        camera=camera,
        detector=_detector(image, given.detector),
        markers=markers,
        wireframe=wireframe,
        prior=None if prior is None else read_prior(prior),
        expectations=None if knowledge is None else read_expectations(knowledge),
    )


def markers_and_wireframe(target: str) -> tuple[MarkerPattern | None, Wireframe | None]:
    """Return what is known of a target, by its name or from a file; None is not known.

    Raises
    ------
    DatasetError, ScenarioError
        If there is no such target, or the file cannot be.
    """
    if target.lower().endswith(".toml"):
        if "mesh" not in read_toml(Path(target)):
            return read_markers(Path(target)), None
        from models.spacecraft.own.build import read_own_target  # builds meshes: only when asked

        own = read_own_target(Path(target))
        return own.spacecraft.markers, own.known_wireframe
    if target.lower().endswith(".json"):
        return None, read_wireframe(Path(target))
    from models.spacecraft.catalogue import spacecraft_by_name  # builds meshes: only when asked
    from models.spacecraft.wireframes import WIREFRAMES, wireframe_by_name

    markers = spacecraft_by_name(target).markers
    wireframe = wireframe_by_name(target) if target in WIREFRAMES else None
    if markers is None and wireframe is None:
        raise ScenarioError(
            f"expected a target with markers or a wireframe, got {target!r}, which has none; "
            "give its markers as a .toml file, or its wireframe as a .json file"
        )
    return markers, wireframe


def guessed_detector(image: Image) -> Detector:
    """Guess a detector from one of its images: bits from the largest number, no bias.

    Gain and noise follow from a full well of 100 000 e over those bits; they weigh centroids
    against each other and decide what is saturated, so a rough guess serves.

    Parameters
    ----------
    image : (height, width) uint16 array, DN
    """
    largest = max(int(image.max()), 1)
    bits = next(bits for bits in BITS if largest < 2**bits)
    default = Detector()
    return Detector(gain_e_dn=default.full_well_e / 2**bits, bias_dn=0.0, bits=bits)


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
