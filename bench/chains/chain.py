"""What a chain is to the bench: one value that says all that the engine does not know."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from numpy import uint8
from numpy.typing import NDArray

from models.arrays import Floats
from models.dataset.dataset import Dataset
from models.estimate import Estimate
from models.pose import RigidTransform

if TYPE_CHECKING:  # scoring and reporting load much that estimating must not
    from bench.estimating.runs import Run
    from bench.pictures.frame_record import FrameRecord, FrameRecords
    from bench.pictures.marks import Layer
    from bench.report.parts import ReportInput, ReportParts
    from bench.report.scene_addition import SceneAddition
    from bench.report.table import Table
    from bench.scoring.judgement import Judgement, TrueScene

EstimatesByPipeline = Mapping[str, Mapping[int, Estimate]]


class FrameTruth(Protocol):
    """What really was at the instant to which a frame's estimate is stamped; more is welcome."""

    @property
    def time_s(self) -> float:
        """That instant, s."""
        ...

    @property
    def cam_from_target(self) -> RigidTransform | None:
        """The true pose; None where the truth tells none."""
        ...


class PosedFrameTruth(FrameTruth, Protocol):
    """The truth of a frame of which a pose is known."""

    @property
    def cam_from_target(self) -> RigidTransform:
        """The true pose."""
        ...


@dataclass(frozen=True)
class ScorePart:
    """One named part of a score.

    Attributes
    ----------
    name : str
        Its key in ``score.json``, under ``parts``.
    score : callable
        ``score(judged, truth, label)``: a dataclass, dict or list of what the judged runs of one
        pipeline come to, run 0 first; None where there is nothing to say.
    """

    name: str
    score: Callable[[Sequence[Sequence[Any]], Any, str], Any]


@dataclass(frozen=True)
class Chain:
    """A chain.

    Attributes
    ----------
    name : str
        As ``dataset.json`` has it.
    title : str
        What its frames are, in words: ``image pairs``.
    pipelines : tuple of str
        Those that come first in its tables; see ``pipelines.registry``. Other packages' run beside
        them on the streams that they name.
    truths : callable
        ``truths(dataset)``: the truth of each frame by its number, for pictures; empty where the
        dataset has no truth half.
    truth : callable
        ``truth(dataset)``: all of the truth half that judging needs, whatever its type.
    judge : callable
        ``judge(run, truth)``: one ``Judgement`` a frame, of the chain's own kind.
    parts : tuple of ScorePart
        What it adds to the common core of a score.
    frame_rows : callable
        ``frame_rows(judged, truth)``: what it adds to each frame of run 0 in ``per_frame``.
    report : callable
        ``report(given)``: what it adds to the report's page.
    headline : callable
        ``headline(score)``: the table that compares the pipelines.
    picture : callable
        ``picture(record, width_px)``: a frame with its marks, RGB; None where it has no picture.
    show : callable
        ``show(record)``: a frame laid open, RGB; None where there is nothing to show.
    verdict : callable
        ``verdict(record)``: one line of how wrong an estimate is.
    legend : str
        What the marks of ``picture`` mean.
    signals : callable, optional
        ``signals(record)``: a frame's images above the bias by their names, (height, width) or
        (height, width, 3), DN, that of the marks first, for a page whose reader chooses image,
        marks and greys; without it the page has no such image.
    layers : callable, optional
        ``layers(record)``: the marks of ``picture`` as numbers.
    scene : callable, optional
        ``scene(records, estimates)``, the latter of run 0 by pipeline: what a page's scene shows
        besides target, camera and Sun; see ``bench.report.scene_addition``.
    greys : str
        How its grey levels come about; empty where the legend says it all.
    judge_alone : callable, optional
        ``judge_alone(estimate, record, scene)``: a ``Judgement`` of one frame by its sealed record,
        where there is no dataset, as in a sweep; see ``bench.scoring.judgement.TrueScene``. Without
        it the chain's cases cannot be swept.
    trials : callable, optional
        ``trials(dataset, workers)``: more that is tried with the chain's pipelines beside the run
        itself; returns the files written.
    brought : mapping of str to str
        Pipelines that come with it, by name: where each stands, ``module:attribute``.
    """

    name: str
    title: str
    pipelines: tuple[str, ...]
    truths: Callable[[Dataset], Mapping[int, Any]]
    truth: Callable[[Dataset], Any]
    judge: Callable[[Run, Any], Sequence[Judgement]]
    parts: tuple[ScorePart, ...]
    frame_rows: Callable[[Sequence[Sequence[Any]], Any], list[dict[str, Any]]]
    report: Callable[[ReportInput], ReportParts]
    headline: Callable[[dict[str, Any]], Table]
    picture: Callable[[FrameRecord, int], NDArray[uint8] | None]
    show: Callable[[FrameRecord], NDArray[uint8] | None]
    verdict: Callable[[FrameRecord], str]
    legend: str
    greys: str = ""
    signals: Callable[[FrameRecord], Mapping[str, Floats]] | None = None
    layers: Callable[[FrameRecord], Sequence[Layer]] | None = None
    scene: Callable[[FrameRecords, EstimatesByPipeline], SceneAddition] | None = None
    judge_alone: Callable[[Estimate, Any, TrueScene], Judgement] | None = None
    trials: Callable[[Dataset, int], list[Path]] | None = None
    brought: Mapping[str, str] = field(default_factory=dict)
