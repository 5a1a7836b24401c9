"""Datasets of version 1: image pairs, or single images with the chaser's orbit beside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from models.frame import CHASER_ORBIT, IMAGE, IMAGE_800, IMAGE_850
from models.motion.relative_state import CHASER_ORBIT_COLUMNS

HASHED_IN_VERSION_1 = ("dataset.json", "frames.csv", "detector.toml", "markers.toml")
PAIR_GAP_S = 0.033  # version 1 did not tell it; the pipelines took this


@dataclass(frozen=True)
class Version1:
    """What a format of version 1 left unsaid.

    Attributes
    ----------
    chain : str
    streams : tuple of dict
        Arguments of ``models.dataset.description.Stream``.
    onboard : tuple of str
    """

    chain: str
    streams: tuple[dict[str, Any], ...]
    onboard: tuple[str, ...]


FORMATS = {
    "rvbench-pairs": Version1(
        chain="retroreflector_pairs",
        streams=(
            {
                "name": IMAGE_800,
                "kind": "image",
                "files": "frames/{index:06d}_800.png",
                "offset_s": -PAIR_GAP_S,
            },
            {"name": IMAGE_850, "kind": "image", "files": "frames/{index:06d}_850.png"},
        ),
        onboard=("camera.toml", "detector.toml", "markers.toml", "prior.toml"),
    ),
    "rvbench-images": Version1(
        chain="tumble_images",
        streams=(
            {"name": IMAGE, "kind": "image", "files": "frames/{index:06d}.png"},
            {
                "name": CHASER_ORBIT,
                "kind": "table",
                "files": "navigation.csv",
                "columns": CHASER_ORBIT_COLUMNS,
            },
        ),
        onboard=("camera.toml", "detector.toml", "knowledge.toml", "wireframe.json"),
    ),
}
