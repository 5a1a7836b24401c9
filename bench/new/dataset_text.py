"""A specification of a random dataset to start from, made of the tables that read it."""

from __future__ import annotations

from typing import Any

from bench.new.table_text import table_lines, table_of, value_text
from bench.random_dataset.spec_tables import Spec, SpecCameraTable, TargetTable

HEAD = """\
# A dataset of your own: `rvbench dataset {name}.toml --out out/{name}` renders it as it is.
#
# `#key = value` shows a default: take away the # to change it. `# key = ...` has none. What the
# file does not name keeps its default; an unknown key is refused, whatever it was meant to do.

"""
TOP: dict[str, Any] = {"frames": 60, "seed": 1, "suns_per_pose": 5}
TARGETS: tuple[dict[str, Any], ...] = (
    {"spacecraft": "maxar1300"},
    {"spacecraft": "xmm"},
    {"spacecraft": "hispasat", "range_m": [40.0, 90.0]},
)
CAMERA: dict[str, Any] = {"name": "wide", "preset": "chaser_fixed", "width": 256}
GIVEN: dict[str, dict[str, Any]] = {
    "pose": {"attitude": "uniform", "range_m": [25.0, 60.0]},
    "sun": {"phase_deg": [0.0, 100.0]},
    "exposure": {"exposure_ms": [1.0, 8.0]},
    "background": {"space": 0.6, "stars": 0.2, "earth": 0.2},
    "vary": {"diffuse": 0.1, "specular": 0.1, "roughness": 0.2, "psf_sigma_px": [0.4, 0.8]},
    "split": {"train": 0.8, "val": 0.1, "test": 0.1},
    "render": {"samples": 16},
}
"""What the file sets: sixty small frames, a minute or two of work."""
LEFT_OUT = {"render": ("seed",)}  # which the dataset draws


def dataset_text(name: str) -> str:
    """Return the text of a specification that renders as it is."""
    top = "\n".join(table_lines("", Spec, {"name": name, **TOP})).split("[]\n", 1)[1]
    parts = [HEAD.format(name=name) + top + "\n"]
    for number, target in enumerate(TARGETS):
        lines = table_lines("target", TargetTable, target, "[[{}]]")
        short = [f"{key} = {value_text(value)}" for key, value in target.items()]
        parts.append("\n".join(lines if not number else ["[[target]]", *short]) + "\n")
    parts.append("\n".join(table_lines("camera", SpecCameraTable, CAMERA, "[[{}]]")) + "\n")
    for key, field in Spec.model_fields.items():
        if (table := table_of(field)) is not None:
            lines = table_lines(key, table, GIVEN.get(key, {}), left_out=LEFT_OUT.get(key, ()))
            parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)
