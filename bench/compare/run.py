"""Compare from files to files; estimates are read and refused before anything heavy is loaded."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.compare.methods import found_methods
from bench.compare.options import CompareOptions, check_number
from bench.compare.outcome_place import (
    FILE_NAME,
    PAGE_NAME,
    TABLE_NAME,
    check_file_place,
    check_folder_place,
)
from models.atomic_file import sweep_beside, write_text
from models.errors import ScenarioError

if TYPE_CHECKING:
    from bench.compare.comparison import Comparison


def score_one(
    folder: Path, estimates: Path, out: Path, options: CompareOptions
) -> tuple[Comparison, dict[str, Any]]:
    """Score one file of estimates against a dataset.

    Parameters
    ----------
    folder : Path
        The dataset; it is only read.
    estimates : Path
    out : Path
        The score.
    options : CompareOptions

    Raises
    ------
    ScenarioError
        If the estimates are a folder with several.
    DatasetError
        If something cannot be read, or another's file stands at ``out``.
    """
    check_file_place(out)
    dataset, methods = found_methods(
        [estimates], folder, options.file_format, options.choices, options.exported
    )
    if len(methods) > 1:
        raise ScenarioError(
            f"expected one file with --estimates, got the folder {estimates} with "
            f"{len(methods)}; to compare them: `rvbench compare {estimates}`"
        )
    from bench.compare.comparison import compared
    from bench.compare.outcome import comparison_table, write_comparison

    comparison = compared(dataset, methods, options)
    table = comparison_table(comparison)
    write_comparison(out, table)
    return comparison, table


def write_outcome(
    methods: Sequence[Path], dataset: Path | None, out: Path | None, options: CompareOptions
) -> tuple[Comparison, dict[str, Path]]:
    """Compare methods and write JSON, table and page.

    Parameters
    ----------
    methods : sequence of Path
    dataset : Path, optional
    out : Path, optional
        Folder; ``out/compare-CASE`` unless given.
    options : CompareOptions

    Returns
    -------
    Comparison, dict of str to Path
        And the files, by what they are.

    Raises
    ------
    RvbenchError
        If something cannot be read, or the folder holds what is not ours.
    """
    if not methods:
        check_number([])
    if out is not None:
        check_folder_place(out)
    opened, found = found_methods(
        methods, dataset, options.file_format, options.choices, options.exported
    )
    check_number(found)
    if out is None:
        out = Path("out") / f"compare-{opened.info.case}"
        check_folder_place(out)
    from bench.compare.comparison import compared
    from bench.compare.outcome import comparison_table, standings_csv, write_comparison
    from bench.compare.page import write_comparison_page

    comparison = compared(opened, found, options)
    write_comparison(out / FILE_NAME, comparison_table(comparison))
    sweep_beside(out / TABLE_NAME)
    write_text(out / TABLE_NAME, standings_csv(comparison))
    write_comparison_page(out / PAGE_NAME, comparison)
    return comparison, {"json": out / FILE_NAME, "table": out / TABLE_NAME, "page": out / PAGE_NAME}
