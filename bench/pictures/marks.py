"""Marks on a frame as numbers, layer by layer, for whoever draws them: a page's reader chooses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from models.arrays import Floats

Sign = Literal["circle", "diamond", "ticks", "lines"]


@dataclass(frozen=True, eq=False)
class Layer:
    """Marks of one kind.

    Attributes
    ----------
    name : str
        What is chosen by: ``detections``, ``reprojections``, ``truth``.
    of_truth : bool
        Whether it is the same whatever a pipeline says.
    sign : str
        How each is drawn; ``lines`` are polylines.
    places_px : sequence of (2,) or of (k, 2) arrays, px
        Pixel centres are integers.
    labels : tuple of str
        One each; empty where there are none.
    dim : tuple of bool
        Which were matched to nothing; empty where none can be.
    """

    name: str
    of_truth: bool
    sign: Sign
    places_px: tuple[Floats, ...]
    labels: tuple[str, ...] = ()
    dim: tuple[bool, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Return it for a page, places to a hundredth of a pixel, pairs run together."""
        return {
            "name": self.name,
            "sign": self.sign,
            "places_px": [place.round(2).ravel().tolist() for place in self.places_px],
            "labels": list(self.labels),
            "dim": list(self.dim),
        }
