"""``rvbench dataset``: the verb with its options."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from bench.verbs import DONE, OptionalCount

SpecFile = Annotated[Path, arg(metavar="SPEC.toml")]
Folder = Annotated[Path, arg(metavar="DIR")]


@dataclass(frozen=True)
class Dataset:
    """Render a dataset of random poses, Suns, exposures and backgrounds, drawn by a seed.

        rvbench new dataset mine
        rvbench dataset mine.toml --out out/mine
        rvbench export out/mine --as coco --out out/mine-coco

    SPEC.toml names spacecraft and cameras, and says from where to where all is drawn; a start file
    with every key explained comes from `rvbench new dataset`. Several Suns and exposures at a pose
    (suns_per_pose, exposures_per_sun) share its light: that of five Suns costs 1.4 times that of
    one.

    DIR gets a folder for each spacecraft, camera and specimen: each is a dataset, which the verbs
    show, estimate, score and export open. Its README.md has pictures of what was drawn, and counts
    of what was refused. Training, validation and test share no pose, and `rvbench export DIR` keeps
    them apart.

    Frame number n is the same, to the bit, whatever was rendered before it. Stop it anywhere: the
    same command goes on. Another specification in the same DIR is refused, with what differs.
    """

    spec: Positional[SpecFile]
    """what is drawn, as TOML"""
    out: Folder
    """folder of the dataset"""
    workers: OptionalCount = None
    """processes that render; one for each core unless given, one in all with CUDA"""
    only: Annotated[tuple[int, int] | None, arg(metavar="FIRST LAST", help_behavior_hint="")] = None
    """render these frames now, and others another time, or on another machine"""
    variant: Literal["auto", "llvm", "cuda", "scalar"] = "auto"
    """how Mitsuba computes; auto takes the fastest that renders here"""

    def run(self) -> int:
        """Make it, and say what came of it."""
        from bench import api

        result = api.dataset(
            self.spec, self.out, workers=self.workers, only=self.only, variant=self.variant
        )
        for folder in result.folders:
            print(f"dataset: {folder}")
        if result.left:
            print(f"left: {result.left} frames; the same command renders them")
        print(f"card: {(self.out / 'README.md').resolve()}")
        return DONE
