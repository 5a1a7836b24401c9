"""``rvbench compare``: the verb with its options."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from bench import api
from bench.scoring.verb import FormatName
from bench.verbs import DONE, OptionalCount, OptionalFolder
from models.plain_console import plain_console

IN_BRACKETS = "; in brackets 95 % intervals"


@dataclass(frozen=True)
class Compare:
    """Compare methods on the same frames: who is better, by how much, and can these frames tell.

        rvbench compare out/demo
        rvbench compare out/xmm mine.csv theirs.txt --out out/compared
        rvbench compare a.csv b.csv --dataset out/xmm --rank-by ar

    A method is a file of estimates (BOP results, a SPEED submission, a TUM trajectory, or our own
    format); a dataset stands for all that have spoken in it. Methods are paired frame by frame,
    numbers have bootstrap intervals, and a leaderboard is cut by range, phase angle and tumble
    rate. A frame without a pose is lost, and counts as the worst.
    """

    methods: Positional[
        Annotated[tuple[Path, ...], arg(metavar="METHOD ...", help_behavior_hint="")]
    ]
    """files of estimates, or datasets for all estimates in them"""
    dataset: OptionalFolder = None
    """whose frames they are of; a dataset among the methods unless given"""
    out: OptionalFolder = None
    """folder of the table, the JSON and the page; out/compare-CASE unless given"""
    rank_by: Literal["speed", "position", "attitude", "ar"] = "speed"
    """SPEED score, median position error, median attitude error, or BOP's average recall"""
    format: FormatName = "auto"
    """of the files that lie in no dataset; auto finds it by what a file holds"""
    scene: OptionalCount = None
    """of BOP results, or images named as in an export: the scene that is this dataset"""
    object: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """of BOP results: the obj_id that is its target, where there are several"""
    trajectory_of: Literal["camera", "target"] = "camera"
    """what a TUM trajectory's rows are: the camera's poses in the target frame, or the target's in
    the camera's"""
    exported: OptionalFolder = None
    """an export of the dataset (`rvbench export`), by whose numbers of scenes and objects files
    go"""
    split: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """with --exported, the split whose frames are judged (train, val or test); all unless given"""
    vsd_px: Annotated[int, arg(metavar="N")] = 512
    """pixels along the image's longer side that BOP's VSD looks at; 0 leaves VSD out"""
    seed: Annotated[int, arg(metavar="N")] = 0
    """of the bootstrap; recorded with its results"""
    resamples: Annotated[int, arg(metavar="N")] = 2000
    """of the bootstrap"""
    block_frames: OptionalCount = None
    """frames drawn together, for errors last; the cube root of their number unless given"""

    def run(self) -> int:
        """Compare."""
        comparison, files = api.compare(
            self.methods,
            self.dataset,
            self.out,
            rank_by=self.rank_by,
            file_format=None if self.format == "auto" else self.format,
            scene=self.scene,
            target=self.object,
            trajectory_of=self.trajectory_of,
            exported=self.exported,
            split=self.split,
            vsd_px=self.vsd_px,
            seed=self.seed,
            resamples=self.resamples,
            block_frames=self.block_frames,
        )
        from bench.compare.tables import pair_table, standing_table
        from bench.report.summary import print_table

        console = plain_console()
        frames = len(comparison.view.dataset.entries)
        print_table(
            console, standing_table(comparison), f"the same {frames} frames for all{IN_BRACKETS}"
        )
        print_table(console, pair_table(comparison), f"pair by pair{IN_BRACKETS}")
        for method in comparison.methods:
            if method.missing:
                print(f"{method.label}: {method.missing} of {frames} frames have no row: lost")
            for remark in method.remarks:
                print(f"{method.label}: {remark}")
        for what, path in files.items():
            print(f"{what + ':':<6} {path.resolve()}")
        return DONE
