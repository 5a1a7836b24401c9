"""What can be asked of a comparison, checked before anything is begun."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypedDict, Unpack

from bench.compare.bootstrap import Resampling
from bench.compare.exported_numbers import ExportedAs
from bench.compare.methods import Method
from bench.estimating.foreign_estimates.reading import FileFormat
from bench.estimating.foreign_estimates.said_poses import Choices, TrajectoryOf
from models.errors import ScenarioError
from models.reading.options import check_option
from models.reading.shown import shown

RankBy: TypeAlias = Literal["speed", "position", "attitude", "ar"]
VSD_PX = 512  # of 2048: every fourth pixel; the shares differ by less than a hundredth
MOST_VSD_PX, MOST_SEED, MOST_RESAMPLES = 16_384, 2**63 - 1, 100_000


@dataclass(frozen=True)
class CompareOptions:
    """What can be asked of a comparison.

    Attributes
    ----------
    file_format : str, optional
        Of foreign files; found by what they hold unless given.
    choices : Choices
        What those leave open.
    exported : ExportedAs, optional
        The export whose numbers foreign files go by, and which of its splits is judged.
    rank_by : str
        ``speed``, ``position``, ``attitude`` or ``ar``.
    resampling : Resampling
    vsd_px : int
        Pixels along the image's longer side that VSD looks at; 0 leaves it out, and ``ar`` with it.
    """

    file_format: FileFormat | None = None
    choices: Choices = field(default_factory=Choices)
    exported: ExportedAs | None = None
    rank_by: RankBy = "speed"
    resampling: Resampling = field(default_factory=Resampling)
    vsd_px: int = VSD_PX


class CompareChoices(TypedDict, total=False):
    """The same as typed, and the parts of ``Choices``, ``Resampling``, ``ExportedAs`` by name."""

    rank_by: RankBy
    file_format: FileFormat | None
    vsd_px: int
    scene: int | None
    target: int | None
    trajectory_of: TrajectoryOf
    seed: int
    resamples: int
    block_frames: int | None
    exported: Path | None
    split: str | None


def compare_options(**typed: Unpack[CompareChoices]) -> CompareOptions:
    """Return options from what is typed, checked.

    Raises
    ------
    ScenarioError
        If one cannot be.
    """

    def of(kind: type[Any]) -> dict[str, Any]:
        names = {each.name for each in fields(kind)}
        return {name: value for name, value in typed.items() if name in names}

    folder, split = typed.pop("exported", None), typed.pop("split", None)
    if folder is None and split is not None:
        raise ScenarioError(
            f"expected --split only with --exported DIR, which drew it, got {shown(split)}"
        )
    options = CompareOptions(
        **of(CompareOptions),
        exported=None if folder is None else ExportedAs(folder, split),
        choices=Choices(**of(Choices)),
        resampling=Resampling(**of(Resampling)),
    )
    check_options(options)
    return options


def check_number(methods: Sequence[Method]) -> None:
    """Refuse to compare one method with nothing.

    Raises
    ------
    ScenarioError
    """
    if len(methods) < 2:
        raise ScenarioError(
            "expected at least two methods to compare, files of estimates or datasets, got "
            f"{methods[0].label if methods else 'none'}; "
            "for one: `rvbench score DATASET --estimates FILE`"
        )


def check_options(options: CompareOptions) -> None:
    """Refuse options that cannot be.

    Raises
    ------
    ScenarioError
    """
    how = options.resampling
    check_option("--seed", how.seed, 0, MOST_SEED, whole=True)
    check_option("--resamples", how.resamples, 100, MOST_RESAMPLES, whole=True)
    check_option("--block-frames", how.block_frames, 1, 1_000_000, whole=True)
    check_option("--vsd-px", options.vsd_px, 0, MOST_VSD_PX, whole=True)
    if options.rank_by == "ar" and not options.vsd_px:
        raise ScenarioError(
            "expected --vsd-px above 0 with --rank-by ar, whose average is over VSD too, got 0"
        )
