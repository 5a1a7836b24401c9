"""A camera file to start from: that of the chaser, each key with what it means."""

from __future__ import annotations

from dataclasses import asdict

from models.camera import CAMERAS

PRESET = "chaser_fixed"
MEANINGS = {
    "width": "columns, px",
    "height": "rows, px",
    "fx": "focal length along a row, px: 0.5 width / tan(half the field of view)",
    "fy": "focal length along a column, px",
    "cx": "principal point, px; the middle is (width - 1) / 2",
    "cy": "",
    "k1": "radial distortion, Brown-Conrady as in OpenCV; 0 if left out",
    "k2": "",
    "p1": "tangential distortion",
    "p2": "",
    "k3": "radial distortion, sixth order",
}
HEAD = """\
# A camera of your own, as calibrated, for pairs that were not rendered here:
# `rvbench estimate --frames DIR --camera {name}.toml --target maxar1300 --prior prior.toml`
# These numbers are those of the preset {preset}.

"""


def camera_text(name: str) -> str:
    """Return the text of a camera file that can be used as it is."""
    rows = []
    for key, value in asdict(CAMERAS[PRESET]).items():
        note = MEANINGS.get(key, "")
        rows.append(f"{f'{key} = {value!r}':<28}  # {note}" if note else f"{key} = {value!r}")
    return HEAD.format(name=name, preset=PRESET) + "\n".join(rows) + "\n"
