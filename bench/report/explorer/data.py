"""All that a page's explorer shows, as one table of plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from bench.estimating.runs import read_run
from bench.pictures.frame_record import FrameRecord
from bench.pictures.stretch import SOFTENING
from bench.report.explorer.previews import Previews, shown_places
from bench.report.explorer.scene import pose_numbers, scene_data
from bench.report.numbers import number
from bench.report.parts import ReportInput, ReportParts
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
    drawn = chain.signal is not None and records.onboard.detector is not None
    previews = None
    if records.onboard.detector is not None:
        previews = Previews(len(with_picture), records.onboard.detector)
    frames, pictures, true_layers, truths = [], [], [], []
    own: dict[str, dict[str, list[Any]]] = {
        label: {"verdicts": [], "poses": [], "layers": []} for label in labels
    }
    for place, index in enumerate(indices):
        record = records.record(index)
        frames.append(_frame(record))
        shown = drawn and place in with_picture
        if chain.signal is not None and previews is not None and shown:
            pictures.append(previews.preview(chain.signal(record)))
        else:
            pictures.append("")
        for label in labels:
            said = replace(record, variant=label, estimate=estimates[label].get(index))
            layers = chain.layers(said) if chain.layers is not None and shown else []
            own[label]["verdicts"].append(chain.verdict(said))
            own[label]["poses"].append(pose_numbers(said.estimated_pose))
            own[label]["layers"].append([x.to_json() for x in layers if not x.of_truth])
        true_layers.append([x.to_json() for x in layers if x.of_truth])
        truths.append(replace(record, frame=replace(record.frame, readings={})))
    camera = records.onboard.camera
    return {
        "title": f"{given.info.case}, Sun {given.info.sun}",
        "leading": given.label,
        "frames": frames,
        "image": {
            "width_px": None if camera is None else camera.width,
            "height_px": None if camera is None else camera.height,
            "softening": SOFTENING,
            "pictures": pictures if any(pictures) else [],
        },
        "pipelines": {
            label: {
                **own[label],
                "reasons": [row["reason"] for row in given.score["pipelines"][label]["per_frame"]],
            }
            for label in labels
        },
        "true_layers": true_layers,
        "plots": [asdict(plot) for plot in parts.plots],
        "scene": scene_data(records, truths),
    }


def _frame(record: FrameRecord) -> dict[str, Any]:
    words = [f"frame {record.frame.index}", f"{record.frame.time_s:.1f} s"]
    if record.true_range_m is not None:
        words.append(f"{number(record.true_range_m, 4)} m")
    return {
        "frame": record.frame.index,
        "time_s": record.frame.time_s,
        "title": ", ".join(words),
    }
