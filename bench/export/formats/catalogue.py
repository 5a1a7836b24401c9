"""The formats there are, by the names that ``--as`` takes."""

from __future__ import annotations

from bench.export.formats import (
    bop,
    bop_imagewise,
    coco,
    huggingface,
    speedplus,
    webdataset,
    yolo_pose,
)
from bench.export.formats.format import Format
from models.errors import ScenarioError
from models.reading.shown import shown

FORMATS: dict[str, Format] = {
    each.FORMAT.name: each.FORMAT
    for each in (bop, bop_imagewise, webdataset, speedplus, coco, yolo_pose, huggingface)
}


def format_named(name: str) -> Format:
    """Return a format by name.

    Raises
    ------
    ScenarioError
        If there is none of that name; the message lists those there are.
    """
    if name not in FORMATS:
        raise ScenarioError(f"expected --as one of {', '.join(FORMATS)}, got {shown(name)}")
    return FORMATS[name]
