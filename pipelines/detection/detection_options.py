"""What detection reads of a pipeline's settings; the symbols are those of Opromolla et al. 2022."""

from __future__ import annotations

from typing import Literal, Protocol, TypeAlias

ThresholdRule: TypeAlias = Literal["fraction_of_max", "otsu", "larger_of_both", "per_blob"]
PerimeterRule: TypeAlias = Literal["crofton", "chain"]


class DetectionOptions(Protocol):
    """Any pipeline's settings that have these; ``pipelines.chaser_fixed.options`` tells of each."""

    @property
    def tau_bin(self) -> float:
        """Threshold as a fraction of the largest unsaturated difference."""

    @property
    def threshold_rule(self) -> ThresholdRule:
        """How that fraction becomes a threshold; see ``binarisation``."""

    @property
    def s_ao(self) -> float:
        """Least area of a blob over the expected one (equation 3)."""

    @property
    def tau_circ(self) -> float:
        """Least circularity (equation 5)."""

    @property
    def perimeter(self) -> PerimeterRule:
        """How the perimeter of equation 5 is measured; see ``circularity``."""

    @property
    def s_bord(self) -> float:
        """Border margin over the expected radius (equation 7)."""

    @property
    def region_sigmas(self) -> float:
        """Half-size of a searched region, in sigmas of the predicted marker."""
