"""An export, from its datasets to its last file: image by image, then what tells of all of them.

Each image's files are written, then its label record; a killed export goes on behind the last
record. What tells of all images is made of the records at the end, in one go, piece by piece: no
more than a few images are ever in memory.
"""

from __future__ import annotations

import json
import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from importlib.metadata import version
from pathlib import Path
from typing import Any

from bench.export.card import card_files
from bench.export.croissant import croissant
from bench.export.folder import begin, finish, marking, write_pieces
from bench.export.formats.catalogue import format_named
from bench.export.formats.format import Format, Streamed
from bench.export.formats.huggingface import NAME as HUGGINGFACE
from bench.export.formats.huggingface import row
from bench.export.formats.reading_back import TARGETS
from bench.export.json_stream import whole
from bench.export.labels import label_of
from bench.export.mcap_file import check_mcap, write_mcap
from bench.export.picture import picture_of
from bench.export.plan import Plan, Shot, make_plan
from bench.export.record import Record
from bench.export.records import Records
from bench.export.request import ExportRequest
from bench.export.source import Source, open_source
from bench.export.tables import table_files
from bench.export.tone_curve import ToneCurve, tone_curve
from bench.progress import frame_progress
from bench.random_dataset.folder import datasets_within
from models.at_work import at_work
from models.dataset.dataset import open_dataset
from models.errors import DatasetError

EIGHT = 8
AHEAD = 2  # images for each core: what is in hand is all that is in memory


def export_datasets(request: ExportRequest) -> Plan:
    """Export datasets, or what is missing of an export that was stopped.

    Parameters
    ----------
    request : ExportRequest

    Returns
    -------
    Plan
        What has left.

    Raises
    ------
    ScenarioError
        If the datasets do not fit the format.
    DatasetError
        If a dataset cannot be read or lacks images, or the folder holds what is not this export.
    StorageError
        If the folder cannot be written; what is there is whole, and the same command goes on.
    """
    kind = format_named(request.kind)
    if request.mcap:
        check_mcap()
    folders = [each for given in request.datasets for each in datasets_within(given)]
    _check_images(request, folders)
    sources = [open_source(number + 1, folder) for number, folder in enumerate(folders)]
    plan = make_plan(sources, request.split, request.split_seed, request.split_block)
    kind.refuse(plan)
    versions = f"rvbench {version('rvbench')}"
    mark = marking(request, plan, versions)
    if begin(request.out, mark):
        return plan
    with at_work(request.out, "export"):
        records = Records(plan, request.out)
        curves = _curves(request, plan)
        missing = [shot for shot in plan.shots if not _is_there(records, shot)]
        _export_all(request, kind, records, missing, curves)
        told = dict(_finish(request, kind, records, versions))
        finish(request.out, mark, _every_file(kind, records, told))
    return plan


def _check_images(request: ExportRequest, folders: Sequence[Path]) -> None:
    """Refuse datasets of which images are missing, as of one that is not rendered to its end."""
    datasets = [open_dataset(folder) for folder in folders]
    images = [
        stream.path(dataset.folder, frame)
        for dataset in datasets
        for frame in dataset.indices
        for stream in dataset.info.image_streams
    ]
    absent = [path for path in images if not path.is_file()]
    if not absent:
        return
    drawn = any(datasets_within(given) != [given] for given in request.datasets)
    verb = "dataset SPEC.toml --out DIR` (without --only)" if drawn else "render CASE --out DIR`"
    raise DatasetError(
        f"expected all {len(images)} images of the datasets to be there, {len(absent)} are "
        f"missing, the first {absent[0]}; `rvbench {verb} renders them. Nothing "
        "was exported"
    )


def _export_all(
    request: ExportRequest,
    kind: Format,
    records: Records,
    missing: Sequence[Shot],
    curves: dict[int, ToneCurve | None],
) -> None:
    """Export images on all cores: half of the time is labels, the other waits for the disk."""
    cores = len(os.sched_getaffinity(0))
    begun: deque[Future[None]] = deque()
    with (
        frame_progress("export", len(missing)) as advance,
        ThreadPoolExecutor(cores, thread_name_prefix="export") as threads,
    ):
        try:
            for shot in missing:
                begun.append(
                    threads.submit(_export, request, kind, records, shot, curves[shot.scene])
                )
                if len(begun) == AHEAD * cores:
                    begun.popleft().result()
                    advance()
            while begun:
                begun.popleft().result()
                advance()
        finally:
            for each in begun:
                each.cancel()


def _export(
    request: ExportRequest, kind: Format, records: Records, shot: Shot, curve: ToneCurve | None
) -> None:
    """Write one image's files and then its record."""
    plan = records.plan
    picture = picture_of(plan.image_path(shot), curve, request.demosaic)
    label = label_of(plan, shot, picture.image)
    files: dict[str, tuple[int, str]] = {}
    for name, data in kind.exposure(plan, label, picture).items():
        files[name] = write_pieces(request.out / name, [data])
    records.put(shot, label.record.with_files(files))


def _is_there(records: Records, shot: Shot) -> bool:
    record = records.get(shot)
    return record is not None and all(
        (records.folder / name).is_file() and (records.folder / name).stat().st_size == size
        for name, (size, _) in record.files.items()
    )


def _curves(request: ExportRequest, plan: Plan) -> dict[int, ToneCurve | None]:
    """Return each dataset's curve to eight bits, by its number; None where all bits leave."""
    return {
        source.number: tone_curve(request.tone, source.dataset.onboard.detector)
        if request.bits == EIGHT
        else None
        for source in plan.sources
    }


def _finish(
    request: ExportRequest, kind: Format, records: Records, versions: str
) -> Iterator[tuple[str, tuple[int, str]]]:
    """Write what tells of all images; yield each file's path, size and hash."""
    plan = records.plan
    makers: list[Callable[[], Streamed]] = [
        lambda: kind.finish(records),
        lambda: table_files(records),
        lambda: _targets(plan),
        lambda: _tones(_curves(request, plan)),
        lambda: card_files(records, request, kind, versions),
    ]
    told: dict[str, tuple[int, str]] = {}
    for make in makers:
        for name, pieces in make():
            told[name] = write_pieces(request.out / name, pieces)
            yield name, told[name]
    if kind.name == HUGGINGFACE:
        metadata = {name: own for name, own in told.items() if name.endswith("metadata.jsonl")}
        text = croissant(plan, request.licence, versions, metadata, _example(records))
        yield "croissant.json", write_pieces(request.out / "croissant.json", [text.encode()])
    if request.mcap:
        for name in write_mcap(plan, request.out):
            data = (request.out / name).read_bytes()
            yield name, write_pieces(request.out / name, [data])


def _every_file(
    kind: Format, records: Records, told: dict[str, tuple[int, str]]
) -> Iterator[tuple[str, str]]:
    if not kind.staged:
        for record in records.of():
            for name, (_, digest) in sorted(record.files.items()):
                yield name, digest
    for name, (_, digest) in told.items():
        yield name, digest


def _example(records: Records) -> dict[str, Any]:
    """Return a line with a label, where there is one."""
    first: Record | None = None
    for record in records.of():
        first = first or record
        if record.visible is not None and record.visible.box is not None:
            return row(records.plan, record)
    return {} if first is None else row(records.plan, first)


def _targets(plan: Plan) -> Streamed:
    yield TARGETS, whole(dict(_target_table(source) for _, source in plan.targets()))


def _target_table(source: Source) -> tuple[str, dict[str, Any]]:
    target = source.target
    name = source.dataset.info.target
    if target is None:
        return name, {"keypoints": [], "keypoints_in_target_m": [], "skeleton": []}
    model = target.keypoints
    turns = () if target.wireframe is None else target.wireframe.symmetries
    return name, {
        "keypoints": list(model.names),
        "keypoints_in_target_m": model.points_in_target.tolist(),
        "skeleton": [list(pair) for pair in model.skeleton],
        "radius_m": target.radius_m,
        "symmetries": [turn.tolist() for turn in turns],
    }


def _tones(curves: dict[int, ToneCurve | None]) -> Streamed:
    told = {str(number): json.loads(own.to_json()) for number, own in curves.items() if own}
    if told:
        yield "tone_curves.json", whole(told)
