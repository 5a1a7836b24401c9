"""A scored dataset as a recording for Rerun's viewer: ``rvbench view DIR --rerun FILE.rrd``.

Entities: those of ``bench.viewing.recorded_scene``, ``plots/TITLE/LINE`` and ``lost/LABEL``;
timelines ``time`` and ``frame``.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bench.estimating.runs import read_run
from bench.report.given import report_input
from bench.report.parts import ReportInput
from bench.report.time_plot import TimePlot, size_plots
from bench.scoring.score import shown_labels
from bench.viewing.recorded_scene import CAMERA, ORBIT, TRUE, RecordedScene
from bench.viewing.rerun_sdk import loaded_rerun
from models.atomic_file import sweep_beside, whole_or_absent

LOST, PLOTS = "lost", "plots"
TWO_SIDED = ("band", "bound")


def write_recording(folder: Path, path: Path) -> None:
    """Write a recording of run 0: frames, target, poses and errors.

    Parameters
    ----------
    folder : Path
        A scored dataset.
    path : Path
        The file, ``.rrd``.

    Raises
    ------
    ScenarioError
        If Rerun's SDK is not installed.
    DatasetError
        If dataset or score cannot be read.
    StorageError
        If the file cannot be written.
    """
    rerun, blueprint = loaded_rerun()
    given = report_input(folder)
    plots = _plots(given)
    dataset, labels = given.records.dataset, shown_labels(given.score)
    estimates = {label: read_run(dataset, 0, label).estimates for label in labels}
    sweep_beside(path)
    with whole_or_absent(path) as scratch:
        stream = rerun.RecordingStream("rvbench", recording_id=dataset.fingerprint()[:32])
        scene = RecordedScene(rerun, stream, given.records, estimates, given.label)
        stream.save(scratch, default_blueprint=_layout(rerun, blueprint, scene, plots))
        scene.write_still()
        for place, index in enumerate(dataset.indices):
            record = given.records.record(index)
            stream.set_time("frame", sequence=index)
            stream.set_time("time", duration=record.frame.time_s)
            scene.write_frame(record, place)
            for label in labels:
                said = estimates[label].get(index)
                if not said:
                    reason = "no estimate" if said is None else said.reason or "no reason given"
                    stream.log([LOST, label], rerun.TextLog(reason, level="WARN"))
            for plot in plots:
                for line in plot.lines:
                    value = line.values[place]
                    if value is not None:
                        both = [value, -value] if line.kind in TWO_SIDED else [value]
                        stream.log(plot_path(plot, line.label), rerun.Scalars(both))
        stream.disconnect()


def plot_path(plot: TimePlot, *line: str) -> list[str]:
    """Return the entity of a plot, or of a line of it.

    Parameters
    ----------
    plot : TimePlot
    line : str
        Its label.
    """
    return [PLOTS, f"{plot.title} [{plot.unit}]" if plot.unit else plot.title, *line]


def _plots(given: ReportInput) -> list[TimePlot]:
    """Return the page's plots, and the sizes of the errors where it has none of them."""
    own = given.records.chain.report(given).plots
    titles = {plot.title for plot in own}
    sizes = [plot for plot in size_plots(given.score) if plot.title not in titles]
    return [plot for plot in (*sizes, *own) if not plot.is_empty]


def _layout(rerun: Any, blueprint: Any, scene: RecordedScene, plots: Sequence[TimePlot]) -> Any:
    """Return what the viewer shows first: scene and pictures on the left, plots on the right."""
    views = []
    if scene.has_target:
        around = [f"- /{ORBIT}/**", "+ /**"]
        views.append(blueprint.Spatial3DView(origin="/", contents=around, name="target's frame"))
    if scene.has_pictures:
        views.append(blueprint.Spatial2DView(origin=f"/{CAMERA}/{TRUE}", name="frame"))
    if scene.has_orbit:
        views.append(blueprint.Spatial3DView(origin=f"/{ORBIT}", name="inertial frame"))
    drawn = [
        blueprint.TimeSeriesView(
            origin=rerun.new_entity_path(plot_path(plot)), name=plot_path(plot)[-1]
        )
        for plot in plots
    ]
    return blueprint.Blueprint(
        blueprint.Horizontal(blueprint.Vertical(*views), blueprint.Grid(*drawn))
    )
