"""The files of what is on board before the first frame: written, and read as one thing.

::

    camera.toml       the camera as calibrated
    detector.toml     the detector as calibrated
    optics.toml       the blur of the lens as measured, where it is told
    markers.toml      the target's markers as surveyed
    prior.toml        the first pose as drawn, with its sigmas
    wireframe.json    the target as drawn
    knowledge.toml    how the camera is mounted, and the sigmas expected before flight
    sigmas.toml       1-sigma of what the files above may be wrong by, where it is told
    ANY_OTHER.toml    what else a chain has on board

A dataset has those of them that its sensors and its pipelines need.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from models.arrays import Floats
from models.camera import Camera
from models.dataset.detector_file import detector_to_toml, read_detector
from models.dataset.marker_file import markers_to_toml, read_markers
from models.dataset.prior_file import prior_to_toml, read_prior
from models.errors import DatasetError
from models.onboard import FlightExpectations, OnboardKnowledge
from models.reading.bounds import LENGTH_M, ORBIT_M, SIGMA_PX, SPEED_M_S
from models.reading.fields import Fields
from models.reading.toml_file import read_toml
from models.wireframe.wireframe_file import read_wireframe, wireframe_to_json

CAMERA, DETECTOR, OPTICS, MARKERS = "camera.toml", "detector.toml", "optics.toml", "markers.toml"
PRIOR, WIREFRAME, EXPECTATIONS = "prior.toml", "wireframe.json", "knowledge.toml"
SIGMAS = "sigmas.toml"
LARGEST_INERTIA_KG_M2 = 1e9
MOST_SIGMAS = 1000
WHITE_DN_MS = (1e-6, 1e12)
UNIT_TOLERANCE = 1e-3  # a direction typed with four digits is one
KNOWN = (CAMERA, DETECTOR, OPTICS, MARKERS, PRIOR, WIREFRAME, EXPECTATIONS, SIGMAS)


def onboard_texts(onboard: OnboardKnowledge) -> dict[str, str]:
    """Return the texts of the files that hold what is on board, by name.

    Raises
    ------
    DatasetError
        If a table on board has the name of another file, or one that does not end in .toml.
    """
    texts = {}
    if onboard.camera is not None:
        texts[CAMERA] = onboard.camera.to_toml()
    if onboard.detector is not None:
        texts[DETECTOR] = detector_to_toml(onboard.detector)
    if onboard.psf_sigma_px is not None:
        texts[OPTICS] = tomli_w.dumps({"psf_sigma_px": float(onboard.psf_sigma_px)})
    if onboard.markers is not None:
        texts[MARKERS] = markers_to_toml(onboard.markers)
    if onboard.prior is not None:
        texts[PRIOR] = prior_to_toml(onboard.prior)
    if onboard.wireframe is not None:
        texts[WIREFRAME] = wireframe_to_json(onboard.wireframe)
    if onboard.expectations is not None:
        texts[EXPECTATIONS] = expectations_to_toml(onboard.expectations)
    if onboard.sigmas:
        texts[SIGMAS] = tomli_w.dumps({key: float(x) for key, x in onboard.sigmas.items()})
    for name, table in onboard.tables.items():
        if name in KNOWN or not name.endswith(".toml"):
            raise DatasetError(
                f"expected a name of its own ending in .toml for a table on board, got {name!r}"
            )
        texts[name] = tomli_w.dumps(table)
    return texts


def read_onboard(
    folder: Path, names: tuple[str, ...], run_folder: Path | None = None
) -> OnboardKnowledge:
    """Read what is on board.

    Parameters
    ----------
    folder : Path
        The dataset.
    names : tuple of str
        Of the files; see ``DatasetInfo.onboard``.
    run_folder : Path, optional
        Of a later run: files that it has of its own stand in for the dataset's.

    Raises
    ------
    DatasetError, ScenarioError
        If a file is missing or cannot be.
    """

    def path(name: str) -> Path | None:
        if name not in names:
            return None
        own = None if run_folder is None else run_folder / name
        return own if own is not None and own.exists() else folder / name

    camera, detector = path(CAMERA), path(DETECTOR)
    optics, sigmas, markers, prior = path(OPTICS), path(SIGMAS), path(MARKERS), path(PRIOR)
    wireframe, expectations = path(WIREFRAME), path(EXPECTATIONS)
    return OnboardKnowledge(
        camera=None if camera is None else Camera.from_toml(camera),
        detector=None if detector is None else read_detector(detector),
        markers=None if markers is None else read_markers(markers),
        prior=None if prior is None else read_prior(prior),
        wireframe=None if wireframe is None else read_wireframe(wireframe),
        expectations=None if expectations is None else read_expectations(expectations),
        psf_sigma_px=None if optics is None else _psf_sigma_px(optics),
        sigmas={} if sigmas is None else _sigmas(sigmas),
        tables={name: _other(path(name), name, folder) for name in names if name not in KNOWN},
    )


def _other(path: Path | None, name: str, folder: Path) -> dict[str, Any]:
    if path is None or not name.endswith(".toml"):
        raise DatasetError(
            f"{folder}/dataset.json: expected on-board files {', '.join(KNOWN)}, or tables of a "
            f"chain's own ending in .toml, got {name!r}"
        )
    return read_toml(path)


def expectations_to_toml(expected: FlightExpectations) -> str:
    """Return the text of ``knowledge.toml``."""
    table: dict[str, Any] = {
        "R_cam_from_lvlh": expected.cam_from_lvlh.rotation.tolist(),
        "t_cam_from_lvlh_m": expected.cam_from_lvlh.translation.tolist(),
        "sigma_px": float(expected.sigma_px),
        "chaser_sigma_m": float(expected.chaser_sigma_m),
        "chaser_sigma_m_s": float(expected.chaser_sigma_m_s),
    }
    if expected.range_m is not None:
        table["range_m"] = [float(edge) for edge in expected.range_m]
    if expected.inertia_kg_m2 is not None:
        table["inertia_kg_m2"] = expected.inertia_kg_m2.tolist()
    if expected.sun_dir_in_inertial is not None:
        table["sun_dir_in_inertial"] = expected.sun_dir_in_inertial.tolist()
        table["sun_sigma_deg"] = float(expected.sun_sigma_deg)
    if expected.earth_shines:
        table["earth_shines"] = True
    if expected.earth_dir_in_inertial is not None:
        table["earth_dir_in_inertial"] = expected.earth_dir_in_inertial.tolist()
    if expected.white_dn_ms is not None:
        table["white_dn_ms"] = float(expected.white_dn_ms)
    if expected.earth_hides_sun:
        table["earth_hides_sun"] = True
    return tomli_w.dumps(table)


def read_expectations(path: Path) -> FlightExpectations:
    """Read ``knowledge.toml``.

    Raises
    ------
    DatasetError
        If a key is missing or unknown, or a value cannot be.
    """
    fields = Fields(read_toml(path), path)
    sigmas = ("sigma_px", "chaser_sigma_m", "chaser_sigma_m_s")
    fields.only(
        ("R_cam_from_lvlh", "t_cam_from_lvlh_m", *sigmas),
        (
            *("range_m", "inertia_kg_m2", "sun_dir_in_inertial", "sun_sigma_deg"),
            *("earth_shines", "earth_dir_in_inertial", "white_dn_ms", "earth_hides_sun"),
        ),
    )
    span = fields.vector("range_m", 2, 0.0, ORBIT_M[1]) if "range_m" in fields else None
    if span is not None and not 0.0 < span[0] <= span[1]:
        raise fields.refusal("range_m", "as nearest and farthest, m", span.tolist())
    inertia = None
    if "inertia_kg_m2" in fields:
        inertia = fields.covariance("inertia_kg_m2", 3, LARGEST_INERTIA_KG_M2)
    return FlightExpectations(
        cam_from_lvlh=fields.pose("R_cam_from_lvlh", "t_cam_from_lvlh_m", *LENGTH_M),
        sigma_px=fields.number("sigma_px", *SIGMA_PX, above=0.0),
        chaser_sigma_m=fields.number("chaser_sigma_m", 0.0, ORBIT_M[1]),
        chaser_sigma_m_s=fields.number("chaser_sigma_m_s", 0.0, SPEED_M_S[1]),
        range_m=None if span is None else (float(span[0]), float(span[1])),
        inertia_kg_m2=inertia,
        sun_dir_in_inertial=_direction(fields, "sun_dir_in_inertial"),
        sun_sigma_deg=(
            fields.number("sun_sigma_deg", 0.0, 180.0) if "sun_sigma_deg" in fields else 0.0
        ),
        earth_shines=fields.flag("earth_shines") if "earth_shines" in fields else False,
        earth_dir_in_inertial=_direction(fields, "earth_dir_in_inertial"),
        white_dn_ms=(
            fields.number("white_dn_ms", *WHITE_DN_MS) if "white_dn_ms" in fields else None
        ),
        earth_hides_sun=fields.flag("earth_hides_sun") if "earth_hides_sun" in fields else False,
    )


def _direction(fields: Fields, key: str) -> Floats | None:
    """Return a unit vector, if it is there."""
    if key not in fields:
        return None
    direction = fields.vector(key, 3, -1.001, 1.001)
    if not abs(np.linalg.norm(direction) - 1.0) < UNIT_TOLERANCE:
        raise fields.refusal(key, "of length 1", direction.tolist())
    return direction


def _sigmas(path: Path) -> dict[str, float]:
    fields = Fields(read_toml(path), path)
    return {key: fields.number(key, 0.0, ORBIT_M[1]) for key in fields.names(MOST_SIGMAS)}


def _psf_sigma_px(path: Path) -> float:
    fields = Fields(read_toml(path), path)
    fields.only(("psf_sigma_px",))
    return fields.number("psf_sigma_px", *SIGMA_PX)
