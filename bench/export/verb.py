"""``rvbench export``: the verb with its options."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import FlagCreatePairsOff, Positional, arg

from bench.verbs import DONE, WORSE
from models.errors import ScenarioError
from models.reading.options import check_choice

FORMATS = ("bop", "bop-imagewise", "webdataset", "speedplus", "coco", "yolo-pose", "huggingface")
BITS = (8, 16)
BAYER = ("rggb", "grbg", "gbrg", "bggr")
Folders = Annotated[tuple[Path, ...], arg(metavar="DATASET", help_behavior_hint="")]
MOST_SHOWN = 20


@dataclass(frozen=True)
class Export:
    """Write datasets in a format that other people's tools read, with true labels.

        rvbench export out/xmm --as coco --out out/xmm-coco
        rvbench export out/s1 out/s2 out/s3 --as bop --split 0.8 0.1 0.1 --out out/bop
        rvbench export out/mine --as coco --out out/mine-coco
        rvbench export out/xmm --as yolo-pose --tone asinh --out out/yolo
        rvbench export --check --out out/xmm-coco

    Masks, boxes, depth, keypoints (seen, in shadow, hidden or outside, told apart) and poses come
    from the truth half. With every format go tables of sensors, estimates and truth as CSV, a card
    (README.md) with pictures, and hashes of all files. Stop it anywhere: the same command goes on.
    """

    out: Annotated[Path, arg(metavar="DIR")]
    """folder of the export"""
    datasets: Positional[Folders] = ()
    """datasets; each is a scene, in the order given. Of one that `rvbench dataset` made, all of its
    folders, with their splits"""
    as_: Annotated[str | None, arg(name="as", metavar="FORMAT", help_behavior_hint="")] = None
    """bop (scenewise), bop-imagewise, webdataset (BOP shards), speedplus, coco, yolo-pose or
    huggingface (imagefolder with Croissant)"""
    check: Annotated[FlagCreatePairsOff[bool], arg(help_behavior_hint="")] = False
    """reopen what is in DIR: every hash, masks against boxes, keypoints against poses; exit code 1
    if anything is wrong. With datasets, after exporting them"""
    bits: Annotated[int | None, arg(metavar="8|16", help_behavior_hint="")] = None
    """of the images: 16 leaves the detector's numbers as recorded, 8 goes by --tone; unless given,
    8 where the format's usual readers take no more (bop-imagewise, webdataset, speedplus,
    yolo-pose), else 16"""
    tone: Literal["sqrt", "linear", "asinh"] = "sqrt"
    """the curve to 8 bits, from the bias to saturation; it is written into tone_curves.json"""
    demosaic: Annotated[str | None, arg(metavar="PATTERN", help_behavior_hint="")] = None
    """of images behind a Bayer filter: its upper left four pixels (rggb, grbg, gbrg or bggr); they
    leave in colours, else raw"""
    split: Annotated[tuple[float, float, float], arg(metavar="TRAIN VAL TEST")] = (0.8, 0.1, 0.1)
    """shares of the frames; all streams of a frame go together. A dataset that brings its own
    splits keeps them"""
    split_seed: Annotated[int, arg(metavar="N")] = 0
    """draws the splits; it is recorded"""
    split_block: Annotated[int, arg(metavar="N")] = 1
    """frames in a row that stay together, for neighbours of a slow motion are nearly the same"""
    licence: Annotated[str, arg(metavar="NAME", help_behavior_hint="")] = ""
    """of what leaves, for its card, such as CC-BY-4.0; not stated unless given"""
    mcap: Annotated[FlagCreatePairsOff[bool], arg(help_behavior_hint="")] = False
    """tables as MCAP, too (`pip install mcap`)"""

    def run(self) -> int:
        """Export, check, and say what came of it.

        Raises
        ------
        ScenarioError
            If there are neither datasets nor a check, datasets without a format, or an option is
            none of its choices.
        """
        for name, value, choices in (
            ("--as", self.as_, FORMATS),
            ("--bits", self.bits, BITS),
            ("--demosaic", self.demosaic, BAYER),
        ):
            check_choice(name, value, choices)
        if not self.datasets and not self.check:
            raise ScenarioError(
                "expected datasets, `rvbench export DATASET --as FORMAT --out DIR`, or a check, "
                "`rvbench export --check --out DIR`; got neither"
            )
        if self.datasets:
            self._export()
        return self._check() if self.check else DONE

    def _export(self) -> None:
        from bench import api

        if self.as_ is None:
            raise ScenarioError(
                f"expected --as with the datasets, one of {', '.join(FORMATS)}; got none"
            )
        plan = api.export(
            self.datasets,
            self.as_,
            self.out,
            bits=self.bits,
            tone=self.tone,
            demosaic=self.demosaic,
            split=self.split,
            split_seed=self.split_seed,
            split_block=self.split_block,
            licence=self.licence,
            mcap=self.mcap,
        )
        for split in plan.splits:
            print(f"{split}: {sum(shot.split == split for shot in plan.shots)} images")
        print(f"export: {self.out}")
        print(f"card:   {(self.out / 'README.md').resolve()}")

    def _check(self) -> int:
        from bench.export.check import check_export

        kind, found = check_export(self.out)
        for fault in found.faults[:MOST_SHOWN]:
            print(f"wrong: {fault}")
        if len(found.faults) > MOST_SHOWN:
            print(f"wrong: and {len(found.faults) - MOST_SHOWN} more")
        told = f", keypoints within {found.reprojection_px:.2g} px" if found.reprojection_px else ""
        print(
            f"check: {kind}, {found.images} images, {found.objects} labels, {found.keypoints} "
            f"keypoints{told}; {len(found.faults) or 'nothing'} wrong"
        )
        return WORSE if found.faults else DONE
