"""``detector.toml``: the detector as calibrated."""

from __future__ import annotations

from dataclasses import asdict, fields
from pathlib import Path

import tomli_w

from models.reading.fields import Fields
from models.reading.toml_file import read_toml
from models.sensors.camera_chip import Detector

PLAIN, MOSAICS = "none", ("none", "rggb")
RANGES = {
    "pixel_pitch_um": (0.1, 1e4),
    "quantum_efficiency": (1e-6, 1.0),
    "prnu": (0.0, 1.0),
    "dark_current_e_s": (0.0, 1e9),
    "full_well_e": (1.0, 1e9),
    "blooming": (0.0, 1.0),
    "read_noise_e": (0.0, 1e6),
    "gain_e_dn": (1e-6, 1e6),
    "bias_dn": (0.0, 65535.0),
}


def detector_to_toml(detector: Detector) -> str:
    """Return the text of ``detector.toml``."""
    table = asdict(detector)
    if detector.mosaic == PLAIN:
        del table["mosaic"]
    return tomli_w.dumps(table)


def read_detector(path: Path) -> Detector:
    """Read ``detector.toml``; every key but ``mosaic`` must be there.

    Raises
    ------
    DatasetError
        If a key is missing or unknown, or a value cannot be.
    """
    table = Fields(read_toml(path), path)
    table.only([field.name for field in fields(Detector) if field.name != "mosaic"], ("mosaic",))
    numbers = {key: table.number(key, *span) for key, span in RANGES.items()}
    mosaic = table.text("mosaic") if "mosaic" in table else PLAIN
    if mosaic not in MOSAICS:
        raise table.refusal("mosaic", f"as one of {', '.join(MOSAICS)}", mosaic)
    detector = Detector(**numbers, bits=table.whole("bits", 1, 16), mosaic=mosaic)
    if not detector.bias_dn < detector.max_dn:
        raise table.refusal(
            "bias_dn", f"below the converter's end, {detector.max_dn} DN", detector.bias_dn
        )
    return detector
