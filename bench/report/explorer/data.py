"""All that a page's explorer shows, as one table of plain values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

from bench.estimating.runs import read_run
from bench.pictures.frame_record import FrameRecord, FrameRecords
from bench.pictures.marks import Layer
from bench.pictures.stretch import SOFTENING
from bench.report.explorer.previews import Previews, shown_places
from bench.report.explorer.runs import other_runs, run_plots
from bench.report.explorer.scene import orbit_data, pose_numbers, scene_data, turned
from bench.report.numbers import number
from bench.report.parts import ReportInput, ReportParts
from bench.report.scene_addition import SceneAddition
from bench.scoring.score import shown_labels
from models.estimate import Estimate


def explorer_data(given: ReportInput, parts: ReportParts) -> dict[str, Any]:
    """Return what the page's scripts read; frames everywhere in the order of ``frames.csv``.

    Parameters
    ----------
    given : ReportInput
    parts : ReportParts
        Of the same chain.
    """
    records, chain = given.records, given.records.chain
    labels = shown_labels(given.score)
    estimates: dict[str, Mapping[int, Estimate]] = {
        label: read_run(records.dataset, 0, label).estimates for label in labels
    }
    indices = records.dataset.indices
    with_picture = shown_places(len(indices))
    images = _Images(records, len(with_picture))
    addition = SceneAddition() if chain.scene is None else chain.scene(records, estimates)
    frames, true_layers, truths = [], [], []
    own: dict[str, dict[str, list[Any]]] = {
        label: {"verdicts": [], "poses": [], "layers": []} for label in labels
    }
    for place, index in enumerate(indices):
        record = records.record(index)
        frames.append(_frame(record))
        shown = images.drawn and place in with_picture
        images.add(record if shown else None)
        layers: Sequence[Layer] = []
        for label in labels:
            said = replace(record, variant=label, estimate=estimates[label].get(index))
            layers = chain.layers(said) if chain.layers is not None and shown else []
            own[label]["verdicts"].append(chain.verdict(said))
            pose = turned(said.estimated_pose, addition.true_from_own.get(label))
            own[label]["poses"].append(pose_numbers(pose))
            own[label]["layers"].append([x.to_json() for x in layers if not x.of_truth])
        true_layers.append([x.to_json() for x in layers if x.of_truth])
        truths.append(replace(record, frame=replace(record.frame, readings={})))
    camera = records.onboard.camera
    others = other_runs(records, labels)
    return {
        "title": f"{given.info.case}, Sun {given.info.sun}",
        "leading": given.label,
        "frames": frames,
        "image": {
            "width_px": None if camera is None else camera.width,
            "height_px": None if camera is None else camera.height,
            "softening": SOFTENING,
            "streams": images.streams(),
        },
        "pipelines": {
            label: {
                **own[label],
                "reasons": [row["reason"] for row in given.score["pipelines"][label]["per_frame"]],
                "runs": others.get(label, []),
            }
            for label in labels
        },
        "true_layers": true_layers,
        "plots": [
            *run_plots(given.score, others),
            *(asdict(plot) for plot in parts.plots if not plot.is_empty),
        ],
        "scene": scene_data(records, truths, addition),
        "orbit": None if addition.orbit is None else orbit_data(addition.orbit),
    }


class _Images:
    """The previews of a dataset's images, by name; empty text where a frame has none."""

    def __init__(self, records: FrameRecords, frames: int) -> None:
        self.signals, self.frames = records.chain.signals, frames
        self.detector = records.onboard.detector
        self._pictures: dict[str, list[str]] = {}
        self._previews: Previews | None = None
        self._count = 0

    @property
    def drawn(self) -> bool:
        """Whether the chain has images at all."""
        return self.signals is not None and self.detector is not None

    def add(self, record: FrameRecord | None) -> None:
        """Take the next frame; None for one without a picture."""
        found: dict[str, str] = {}
        if record is not None and self.signals is not None and self.detector is not None:
            own = self.signals(record)
            if self._previews is None:
                self._previews = Previews(self.frames, self.detector, len(own))
            found = {name: self._previews.preview(name, each) for name, each in own.items()}
        for name in found:
            self._pictures.setdefault(name, [""] * self._count)
        for name, pictures in self._pictures.items():
            pictures.append(found.get(name, ""))
        self._count += 1

    def streams(self) -> list[dict[str, Any]]:
        """Return all of them, that of the marks first."""
        return [{"name": name, "pictures": own} for name, own in self._pictures.items()]


def _frame(record: FrameRecord) -> dict[str, Any]:
    words = [f"frame {record.frame.index}", f"{record.frame.time_s:z.1f} s"]
    if record.true_range_m is not None:
        words.append(f"{number(record.true_range_m, 4)} m")
    return {
        "frame": record.frame.index,
        "time_s": record.frame.time_s,
        "title": ", ".join(words),
    }
