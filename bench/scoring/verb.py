"""``rvbench score``: the verb with its options."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from tyro.conf import Positional, arg

from bench import api
from bench.verbs import (
    DONE,
    WORSE,
    Folder,
    OptionalCount,
    OptionalFile,
    OptionalFolder,
    OptionalNumber,
    print_score,
)
from models.errors import ScenarioError
from models.plain_console import plain_console
from models.reading.options import check_option

MOST_LIMIT_MM = 1e9  # a gate that always passes is none
FormatName = Literal["auto", "bop", "speed", "tum", "rvbench"]


@dataclass(frozen=True)
class Score:
    """Score the estimates of a dataset against its truth, or those of a file from elsewhere.

        rvbench score out/demo
        rvbench score out/demo --fail-above-mm 1.0
        rvbench score out/demo --estimates mine.csv
        rvbench score out/xmm --estimates slam.txt --trajectory-of camera

    What each number of score.json means is told by the report. With --estimates the dataset is only
    read: the file may hold BOP results, a SPEED submission, a TUM trajectory or our own format
    (docs/formats.md tells of each), and it is measured by SPEED's score, BOP's, ADD and recall too.
    Frames that a file leaves out are lost, and counted.
    """

    folder: Positional[Folder]
    """a dataset with its truth half and estimates"""
    fail_above_mm: OptionalNumber = None
    """exit with 1 if 5 % of the position errors of `best`, or of the file, exceed this, in mm, or a
    frame is missed"""
    estimates: OptionalFile = None
    """score this file of estimates instead"""
    format: FormatName = "auto"
    """its format; auto finds it by what the file holds"""
    scene: OptionalCount = None
    """of BOP results, or images named as in an export: the scene that is this dataset"""
    object: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    """of BOP results: the obj_id that is its target, where there are several"""
    trajectory_of: Literal["camera", "target"] = "camera"
    """what a TUM trajectory's rows are: the camera's poses in the target frame, or the target's in
    the camera's"""
    exported: OptionalFolder = None
    """an export of that dataset (`rvbench export`), by whose numbers of scenes and objects the file
    goes"""
    split: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """with --exported, the split whose frames are judged (train, val or test); all unless given"""
    vsd_px: Annotated[int, arg(metavar="N")] = 512
    """pixels along the image's longer side that BOP's VSD looks at; 0 leaves VSD out"""
    out: OptionalFile = None
    """with --estimates, where the score goes; else beside that file, as FILE.score.json"""

    def run(self) -> int:
        """Score.

        Raises
        ------
        ScenarioError
            If an option of files comes without one.
        RvbenchError
            Each says what to do.
        """
        check_option("--fail-above-mm", self.fail_above_mm, 0.0, MOST_LIMIT_MM)
        if self.estimates is not None:
            return self._score_file(self.estimates)
        self._refuse_options_of_files()
        scored = api.score(self.folder)
        print_score(scored)
        print(f"score: {self.folder / 'score.json'}")
        label = "best" if "best" in scored["pipelines"] else next(iter(scored["pipelines"]))
        return self._verdict(label, scored["pipelines"][label]["core"])

    def _score_file(self, path: Path) -> int:
        if path.is_dir() or not path.name:
            raise ScenarioError(f"expected --estimates as a file, got {path}: a folder")
        out = self.out or path.with_name(f"{path.name}.score.json")
        comparison, table = api.score_estimates(
            self.folder,
            path,
            out,
            file_format=None if self.format == "auto" else self.format,
            scene=self.scene,
            target=self.object,
            trajectory_of=self.trajectory_of,
            exported=self.exported,
            split=self.split,
            vsd_px=self.vsd_px,
        )
        from bench.compare.tables import recall_table, summary_table
        from bench.report.summary import print_table

        (method,) = comparison.methods
        console = plain_console()
        print_table(console, summary_table(comparison), f"{path.name} on {self.folder}")
        print_table(console, recall_table(comparison, "spacecraft"), "share of all frames within")
        if method.missing:
            print(f"{method.missing} of {table['dataset']['frames']} frames have no row: lost")
        for remark in method.remarks:
            print(remark)
        print(f"score: {out}")
        return self._verdict(method.label, table["methods"][method.label]["core"])

    def _refuse_options_of_files(self) -> None:
        for name, default in (
            ("format", "auto"), ("scene", None), ("object", None), ("out", None),
            ("trajectory_of", "camera"), ("vsd_px", 512), ("exported", None), ("split", None),
        ):  # fmt: skip
            if getattr(self, name) != default:
                raise ScenarioError(
                    f"expected --{name.replace('_', '-')} only with --estimates FILE, got it with "
                    f"the estimates that {self.folder} has itself"
                )

    def _verdict(self, label: str, core: dict[str, Any]) -> int:
        if self.fail_above_mm is None:
            return DONE
        p95_mm, missed = core["position_error_mm"]["p95"], core["lost"]["missed"]
        if p95_mm is not None and p95_mm <= self.fail_above_mm and not missed:
            return DONE
        said = "no pose at all" if p95_mm is None else f"{p95_mm:.3g} mm"
        print(
            f"worse than asked: {label} has a 95th percentile of {said} against "
            f"{self.fail_above_mm:g} mm, and {missed} missed frames"
        )
        return WORSE
