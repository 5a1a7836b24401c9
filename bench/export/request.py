"""What can be asked of an export."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bench.export.formats.catalogue import format_named
from bench.export.picture import MOSAICS
from bench.export.tone_curve import CURVES
from models.errors import ScenarioError
from models.reading.options import check_option
from models.reading.shown import is_plain, shown

LARGEST_SEED, MOST_BLOCK, MOST_DATASETS = 2**31 - 1, 1_000_000, 999_999
BITS = (8, 16)
MOST_LICENCE = 200


@dataclass(frozen=True)
class ExportRequest:
    """An export.

    Attributes
    ----------
    datasets : tuple of Path
    kind : str
        Name of the format.
    out : Path
    bits : int, optional
        8 or 16 of each image; what the format's readers take unless given.
    tone : str
        The curve to 8 bits.
    demosaic : str, optional
        Bayer filter of raw images, to leave in colours.
    split : (float, float, float)
        Shares of train, val and test.
    split_seed : int
    split_block : int
        Frames in a row that stay together.
    licence : str
        Of what leaves; nothing if it is not stated.
    mcap : bool
        Whether tables leave as MCAP, too.

    Raises
    ------
    ScenarioError
        If an option cannot be used.
    """

    datasets: tuple[Path, ...]
    kind: str
    out: Path
    bits: int | None = None
    tone: str = "sqrt"
    demosaic: str | None = None
    split: tuple[float, float, float] = (0.8, 0.1, 0.1)
    split_seed: int = 0
    split_block: int = 1
    licence: str = ""
    mcap: bool = False

    def __post_init__(self) -> None:
        chosen = format_named(self.kind)
        if not 0 < len(self.datasets) <= MOST_DATASETS:
            raise ScenarioError(
                "expected at least one dataset, `rvbench export DATASET --as FORMAT --out DIR`, "
                "got none"
            )
        if self.bits is None:
            object.__setattr__(self, "bits", chosen.bits)
        if self.bits not in BITS:
            raise ScenarioError(f"expected --bits 8 or 16, got {shown(self.bits)}")
        if self.tone not in CURVES:
            raise ScenarioError(f"expected --tone one of {', '.join(CURVES)}, got {self.tone!r}")
        if self.demosaic is not None and self.demosaic not in MOSAICS:
            raise ScenarioError(
                f"expected --demosaic one of {', '.join(MOSAICS)}, got {shown(self.demosaic)}"
            )
        check_option("--split-seed", self.split_seed, 0, LARGEST_SEED, whole=True)
        check_option("--split-block", self.split_block, 1, MOST_BLOCK, whole=True)
        if len(self.licence) > MOST_LICENCE or not is_plain(self.licence):
            raise ScenarioError(
                f"expected --licence as printable text of up to {MOST_LICENCE} characters, "
                f"got {shown(self.licence)}"
            )
