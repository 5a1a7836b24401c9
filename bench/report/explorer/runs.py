"""All runs of a dataset in a page: the errors of each, and what lies between the least and most."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bench.estimating.runs import found_runs, read_run
from bench.pictures.frame_record import FrameRecords, pose_stood_by
from bench.report.explorer.scene import pose_numbers, turned
from bench.report.numbers import number
from bench.scoring.judgement import NO_REASON, Judgement

MOST_RUNS = 100
MOST_POSES = 6_000  # of all runs but the first; beyond, only their errors are told
SIZES = (("position error of every run", "mm", 1e3, "position_m"),
         ("attitude error of every run", "deg", 1.0, "attitude_deg"))  # fmt: skip


def other_runs(records: FrameRecords, labels: Sequence[str]) -> dict[str, list[dict[str, Any]]]:
    """Return what each run but the first came to, by pipeline; empty where there is one alone.

    Parameters
    ----------
    records : FrameRecords
    labels : sequence of str
        Pipelines.

    Raises
    ------
    DatasetError
        If a run cannot be read.
    """
    dataset, chain = records.dataset, records.chain
    numbers = {label: found_runs(dataset.folder, label)[1:MOST_RUNS] for label in labels}
    if not any(numbers.values()):
        return {}
    truth = chain.truth(dataset)
    with_poses = sum(map(len, numbers.values())) * len(dataset.indices) <= MOST_POSES
    found: dict[str, list[dict[str, Any]]] = {}
    for label in labels:
        found[label] = []
        for each in numbers[label]:
            run = read_run(dataset, each, label)
            judged = chain.judge(run, truth)
            turn = None
            if with_poses and chain.scene is not None and records.onboard.camera is not None:
                turn = chain.scene(records, {label: run.estimates}).true_from_own.get(label)
            poses = [
                pose_numbers(turned(pose_stood_by(run.estimates[index], records.onboard), turn))
                for index in dataset.indices
            ]
            found[label].append(
                {
                    "run": each,
                    "verdicts": [_verdict(one) for one in judged],
                    "reasons": [one.estimate.reason if one.lost else None for one in judged],
                    "poses": poses if with_poses else [],
                    "sizes": [_sizes(judged, scale, key) for _, _, scale, key in SIZES],
                }
            )
    return found


def run_plots(
    score: dict[str, Any], others: dict[str, list[dict[str, Any]]]
) -> list[dict[str, Any]]:
    """Return plots of one run's errors among those of all; none where there is one run alone.

    Parameters
    ----------
    score : dict
    others : dict
        See ``other_runs``.
    """
    plots = []
    for place, (title, unit, _, _) in enumerate(SIZES):
        key = ("position_error_mm", "attitude_error_deg")[place]
        lines: list[dict[str, Any]] = []
        for label, runs in others.items():
            first = [row[key] for row in score["pipelines"][label]["per_frame"]]
            every = [first, *(run["sizes"][place] for run in runs)]
            there = [[x for x in column if x is not None] for column in zip(*every, strict=True)]
            least = [min(column, default=None) for column in there]
            most = [max(column, default=None) for column in there]
            own = {"pipeline": label, "values": first}
            lines.append(
                {**own, "label": f"{label}: least to most of {len(every)} runs", "kind": "range",
                 "values": least, "upper": most}
            )  # fmt: skip
            lines.append(
                {**own, "label": f"{label}: the run chosen", "kind": "line", "size": place}
            )
        if lines:
            plots.append({"title": title, "unit": unit, "lines": lines})
    return plots


def _sizes(judged: Any, scale: float, key: str) -> list[float | None]:
    values = (getattr(each, key) for each in judged)
    return [None if value is None else float(f"{scale * value:.5g}") for value in values]


def _verdict(one: Judgement) -> str | None:
    """Return what to say of a frame; None where its sizes say it, which the page puts in words."""
    if not one.lost and one.position_m is not None and one.attitude_deg is not None:
        return None
    if one.lost:
        return f"no pose: {one.estimate.reason or NO_REASON}"
    told = []
    if one.position_m is not None:
        told.append(f"position error {number(1e3 * one.position_m)} mm")
    if one.attitude_deg is not None:
        told.append(f"attitude {number(one.attitude_deg)} deg")
    return "; ".join(told) or "judged by no pose"
