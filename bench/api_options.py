"""What may be asked of the functions of ``bench.api`` by name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    from bench.runners.chunks import Chunk


class RenderOptions(TypedDict, total=False):
    """What can be asked of a rendering; see ``renders.scenario.scenario.RenderRequest``."""

    sun: str | None
    rate_hz: float | None
    start_s: float | None
    end_s: float | None
    width: int | None
    spp: int | None
    variant: Literal["auto", "llvm", "cuda", "scalar"]
    store: Path | None
    store_budget_gb: float | None
    keep_light: Literal["all", "some", "none"]
    keep_every: int | None
    threads: int | None


class DatasetOptions(TypedDict, total=False):
    """What can be asked of a random dataset; see ``bench.random_dataset.run.DatasetRequest``."""

    workers: int | None
    only: tuple[int, int] | None
    variant: Literal["auto", "llvm", "cuda", "scalar"]
    chunk: Chunk | None


class ExportOptions(TypedDict, total=False):
    """What can be asked of an export; see ``bench.export.request.ExportRequest``."""

    bits: int | None
    tone: str
    demosaic: str | None
    split: tuple[float, float, float]
    split_seed: int
    split_block: int
    licence: str
    mcap: bool


class SweepOptions(TypedDict, total=False):
    """What can be asked of a sweep; see ``bench.sweep.plan.SweepRequest``."""

    range_m: tuple[float, ...]
    time_s: tuple[float, ...]
    sun_step_deg: float | None
    suns: tuple[str, ...]
    exposure_ms: tuple[float, ...]
    lamp_w_sr: tuple[float, ...]
    pipeline: str
    draws: int
    width: int | None
    spp: int | None
    marker_samples: int | None
    variant: Literal["auto", "llvm", "cuda", "scalar"]
    store: Path | None
    store_budget_gb: float | None
    threads: int | None
    memory_gb: float


def check_case(case: str) -> None:
    """Refuse a case that there is not, before anything that renders is loaded.

    Raises
    ------
    ScenarioError
        It suggests the nearest.
    """
    from renders.scenario.case_files import case_path

    case_path(case)
