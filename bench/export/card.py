"""The card of an exported dataset: a README that says what it holds, whence, and how to read it."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator

from bench.export.card_pictures import Spread, contact_sheet, histograms
from bench.export.formats.format import Format, Streamed
from bench.export.formats.huggingface import NAME as HUGGINGFACE
from bench.export.formats.huggingface import SPLITS
from bench.export.plan import Plan
from bench.export.records import Records
from bench.export.request import ExportRequest
from bench.export.source import Source
from bench.export.tables import as_path
from models.reading.regular_file import read_text

MOST_SCENARIO = 300_000_000


def card_files(records: Records, request: ExportRequest, kind: Format, versions: str) -> Streamed:
    """Return the README, its pictures, and the scenarios that the frames were made from.

    Parameters
    ----------
    records : Records
    request : ExportRequest
    kind : Format
    versions : str
        Of what makes the export.
    """
    spread, counts = Spread(), dict.fromkeys(records.plan.splits, 0)
    states: dict[str, int] = {}
    for record in records.of():
        spread.add(record)
        counts[record.split] += 1
        for state in record.keypoint_states:
            states[state] = states.get(state, 0) + 1
    sheet = contact_sheet(records)
    if sheet is not None:
        yield "card/frames.png", [sheet]
        yield "card/spread.png", [histograms(spread)]
    for source in records.plan.sources:
        path = source.folder / "truth" / "scenario.toml"
        if path.is_file():
            text = read_text(path, MOST_SCENARIO)
            yield f"provenance/{source.number:06d}_scenario.toml", [text.encode()]
    lines = [
        *(_front_matter(records.plan, request) if kind.name == HUGGINGFACE else ()),
        *_told(records.plan, request, kind, counts, states, sheet is not None),
        *_provenance(records.plan, request, versions),
    ]
    yield "README.md", [("\n".join(lines) + "\n").encode()]


def _front_matter(plan: Plan, request: ExportRequest) -> Iterator[str]:
    yield "---"
    yield f"license: {json.dumps(request.licence or 'unknown')}"
    yield "task_categories: [object-detection, keypoint-detection, image-segmentation]"
    yield "tags: [spacecraft, pose-estimation, synthetic]"
    yield "configs:"
    yield "  - config_name: default"
    yield "    data_files:"
    for split in plan.splits:
        yield f"      - split: {SPLITS[split]}"
        yield f"        path: data/{SPLITS[split]}/*"
    yield "---"
    yield ""


def _told(
    plan: Plan,
    request: ExportRequest,
    kind: Format,
    counts: dict[str, int],
    states: dict[str, int],
    pictures: bool,
) -> Iterator[str]:
    cases = ", ".join(dict.fromkeys(_plain(s.dataset.info.case) for s in plan.sources))
    yield f"# {cases}: {kind.title}"
    yield ""
    yield (
        f"Rendered images of {', '.join(map(_plain, plan.object_ids))}, with true poses, boxes, "
        "masks, depth and keypoints as far as the format has them; made by rvbench."
    )
    if pictures:
        yield ""
        yield "![Some frames with their labels](card/frames.png)"
        yield ""
        yield (
            "Around the target: outline and box of what is seen of it; keypoints green where seen, "
            "blue in shadow, red hidden behind a body. Greys are stretched to be seen."
        )
        yield ""
        yield "![Range, attitude, Sun, phase angle, exposure](card/spread.png)"
    yield ""
    yield "| split | images |"
    yield "|---|---|"
    for split, count in counts.items():
        yield f"| {split} | {count} |"
    yield ""
    if states:
        yield "| keypoints | |"
        yield "|---|---|"
        for state, count in sorted(states.items()):
            yield f"| {state} | {count} |"
        yield ""
    yield "## Conventions"
    yield ""
    yield "- Camera: x right, y down, z forward; the first pixel's centre is (0, 0)."
    yield "- Pose: `x_cam = R_cam_from_target x_target + t`."
    yield f"- Images: {_bits(request)}"
    if plan.depth_scale_mm and kind.name in ("bop", "bop-imagewise", "webdataset"):
        yield f"- Depth: along the boresight, {plan.depth_scale_mm:g} mm a step; 0 is space."
    if any(source.camera is not None and source.camera.distorted for source in plan.sources):
        yield (
            "- The lens distorts, and the images are as it makes them: readers that know K alone "
            "are wrong towards the corners. The coefficients (k1, k2, p1, p2, k3) stand beside K."
        )
    for source in plan.sources:
        if not source.camera_is_true and source.camera is not None:
            yield (
                f"- Dataset {source.number} tells its camera only as calibrated; labels go by that."
            )
    yield (
        "- Keypoints are `visible`, in `shadow` (in view, but neither Sun nor lamp reaches them), "
        "`hidden` (behind the target itself or the chaser) or `outside` the field; `targets.json` "
        "has them in the target's frame, in m."
    )
    if plan.splits == ("unlabelled",):
        yield "- None of the images has a pose: what is true of them is not of that kind."
    yield ""
    yield "## Licence"
    yield ""
    yield (
        _plain(request.licence)
        if request.licence
        else ("Not stated: ask who made it. (`rvbench export --licence NAME` states one.)")
    )
    yield ""


def _bits(request: ExportRequest) -> str:
    if request.bits == 8:
        return f"8 bits by the curve `{request.tone}`, written down in `tone_curves.json`."
    return "the detector's numbers as recorded, in files of 16 bits; most viewers show them dark."


def _provenance(plan: Plan, request: ExportRequest, versions: str) -> Iterator[str]:
    yield "## Provenance"
    yield ""
    yield f"Exported with {versions}."
    yield ""
    drawn = [source for source in plan.sources if source.splits is None]
    if drawn:
        shares = " ".join(f"{share:g}" for share in request.split)
        yield (
            f"Splits: {shares} of train, val and test, in blocks of {request.split_block} frames, "
            f"drawn with seed {request.split_seed}."
        )
    if len(drawn) < len(plan.sources):
        some = " of those datasets that bring their own" if drawn else ""
        yield f"Splits{some}: as `splits.csv` beside their frames has them."
    yield ""
    yield "| | dataset | case | Sun | target | frames | streams | hash of its public half |"
    yield "|---|---|---|---|---|---|---|---|"
    for source in plan.sources:
        yield _row(source)
    yield ""
    for source in plan.sources:
        told = "; ".join(
            f"{_plain(key)} {_plain(value)}"
            for key, value in source.dataset.info.provenance.items()
        )
        yield f"- {source.number}: {told or 'nothing told'}"
    yield ""
    yield (
        "`files.sha256` has the hash of every file, and `export.json` the options; scenarios, with "
        "all seeds, are in `provenance/`, and sensor tables, estimates and truth in `tables/`."
    )


def _row(source: Source) -> str:
    info = source.dataset.info
    cells = [
        str(source.number),
        as_path(source.folder),
        info.case,
        info.sun,
        info.target,
        str(info.frames),
        " ".join(f"{each.name} ({each.kind})" for each in info.streams),
        source.fingerprint[:16],
    ]
    return f"| {' | '.join(map(_plain, cells))} |"


def _plain(text: str) -> str:
    """Return text of others so that Markdown takes it literally, on one line."""
    line = " ".join(text.split()).replace("|", "\\|").replace("`", "'")
    for mark in "*_[]":
        line = line.replace(mark, f"\\{mark}")
    return html.escape(line, quote=False)
