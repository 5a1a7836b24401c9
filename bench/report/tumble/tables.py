"""The tables of a tumble's report, as rows of text made from its ``score.json``."""

from __future__ import annotations

from typing import Any

from bench.report.numbers import NONE, count, number, share
from bench.report.tables import TITLES, Table, variants_of

Score = dict[str, Any]

MEANINGS = {
    "frames": "Images in the dataset.",
    "with a state": "Frames at which the pipeline had a state.",
    "first state": "The frame of the first state.",
    "lost": "Frames from there on whose image gave no pose that was believed; the filter goes on.",
    "position error, median": "Length of the filtered state's position error.",
    "position error, p95": "95 of 100 frames are better than this.",
    "attitude error, median": "Angle between estimated and true attitude, filtered.",
    "attitude error, p95": "95 of 100 frames are better than this.",
    "velocity error, median": "Of the filtered relative velocity, in the local frame.",
    "rate error, median": "Of the filtered relative angular rate, in target axes.",
    "pose alone, position": "Median error of the image's own pose, before any filter.",
    "pose alone, attitude": "The same of its attitude.",
    "wrong states": "States more than 1 m or 10 deg from the truth.",
    "longest wrong": "Most of them in a row: how long a wrong pose is held.",
    "NEES, translation": "Mean of e'P⁻¹e / 6 with the covariance that the filter states: 1 is "
    "honest, above is overconfident. For an H-infinity filter P is a bound, no covariance.",
    "NEES, rotation": "The same of attitude and rate.",
    "visible landmarks": "Mean number of the target's landmarks that an image holds unhidden.",
    "sunlit, of those": "Share that the Sun reaches past the target's own faces.",
    "corners found": "Mean number of corners that the image processing gave.",
    "repeatability": "Share of the visible landmarks that have a corner within 3 px of their true "
    "place.",
    "of the sunlit": "The same of the sunlit ones.",
    "of those in shadow": "The same of those in the target's own shadow or facing away.",
    "corner error": "Root mean square per axis of those corners' distances.",
    "corners that are landmarks": "Those corners, over all corners found.",
}
SECTIONS = {0: "frames", 4: "filtered state", 10: "image alone", 12: "wrong", 14: "consistency",
            16: "image processing"}  # fmt: skip


def headline_table(score: Score) -> Table:
    """Compare the variants on the same images."""
    variants = variants_of(score)
    columns = [_column(score["pipelines"][variant]) for variant in variants]
    rows = [[term, *(column[place] for column in columns)] for place, term in enumerate(MEANINGS)]
    head = ["", *(TITLES.get(variant, variant) for variant in variants)]
    return Table(head, rows, MEANINGS, SECTIONS)


def _column(one: dict[str, Any]) -> list[str]:
    corners = one["corners"]
    velocity = one["velocity_m_s"]["median"]
    return [
        count(one["frames"]),
        count(one["with_state"]),
        NONE if one["first_state"] is None else count(one["first_state"]),
        f"{one['lost']} ({share(one['lost_share'])})",
        _unit(one["position_m"]["median"], "m"),
        _unit(one["position_m"]["p95"], "m"),
        _unit(one["attitude_deg"]["median"], "deg"),
        _unit(one["attitude_deg"]["p95"], "deg"),
        _unit(None if velocity is None else 1e3 * velocity, "mm/s"),
        _unit(one["rate_deg_s"]["median"], "deg/s"),
        _unit(one["raw_position_m"]["median"], "m"),
        _unit(one["raw_attitude_deg"]["median"], "deg"),
        _counted(one["wrong"], one["confusions"]),
        f"{one['longest_wrong']} frames",
        number(one["nees"]["translation"]["mean"]),
        number(one["nees"]["rotation"]["mean"]),
        number(corners["visible"]),
        share(corners["lit_share"]),
        number(corners["detected"]),
        share(corners["repeatability"]),
        share(corners["repeatability_lit"]),
        share(corners["repeatability_dark"]),
        _unit(corners["rms_px"], "px"),
        share(corners["precision"]),
    ]


def check_table(score: Score) -> Table:
    """Set what was asked of this target beside what was measured."""
    rows = []
    for variant in variants_of(score):
        for check in score["pipelines"][variant]["checks"]:
            measured = check["measured"]
            text = (
                share(measured)
                if check["what"] in ("starts acquired rightly", "frames lost once acquired")
                else number(measured)
            )
            holds = {True: "holds", False: "does not hold", None: "nothing to judge"}
            rows.append(
                [TITLES.get(variant, variant), check["what"], check["asked"], text,
                 holds[check["holds"]]]
            )  # fmt: skip
    return Table(["variant", "what", "asked", "measured", ""], rows, {}, {})


def starts_table(score: Score) -> Table:
    """List what came of the starts."""
    head = [
        "", "starts", "right on the first image", "right within all", "images each may look at",
        "wrong", "no pose", "median, m", "median, deg", "time, median s", "p95 s",
    ]  # fmt: skip
    rows = []
    for variant in variants_of(score):
        one = score["pipelines"][variant]["starts"]
        if one is None:
            continue
        rows.append(
            [
                TITLES.get(variant, variant),
                count(one["starts"]),
                f"{one['first_image']} ({share(one['first_image'] / one['starts'])})",
                f"{one['within']} ({share(one['within'] / one['starts'])})",
                count(one["most_images"]),
                _counted(one["wrong"], one["confusions"]),
                count(one["none"]),
                number(one["position_m"]["median"]),
                number(one["attitude_deg"]["median"]),
                number(one["seconds"]["median"]),
                number(one["seconds"]["p95"]),
            ]
        )
    return Table(head, rows, {}, {})


def limit_table(score: Score, variant: str) -> Table:
    """Show the image's own pose by what may limit it."""
    head = ["", "frames", "with a pose", "position, median m", "attitude, median deg"]
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    last = ""
    for one in score["pipelines"][variant]["limits"]:
        if one["of"] != last:
            sections[len(rows)] = last = one["of"]
        low, high = (
            share(edge) if one["of"] != "visible landmarks" else number(edge)
            for edge in one["span"]
        )
        rows.append(
            [
                low if low == high else f"{low} to {high}",
                count(one["frames"]),
                count(one["poses"]),
                number(one["position_m"]),
                number(one["attitude_deg"]),
            ]
        )
    return Table(head, rows, {}, sections)


def reason_table(score: Score) -> Table:
    """List why images gave no pose, in the run and at the starts."""
    rows = []
    for variant in variants_of(score):
        one = score["pipelines"][variant]
        tried = [] if one["starts"] is None else [("starts", one["starts"]["reasons"])]
        for what, reasons in [("run", one["reasons"]), *tried]:
            rows += [
                [TITLES.get(variant, variant), what, count(times), reason]
                for reason, times in reasons.items()
            ]
    return Table(["variant", "in", "frames", "reason"], rows, {}, {})


def _unit(value: float | None, unit: str) -> str:
    return NONE if value is None else f"{number(value)} {unit}"


def _counted(times: int, kinds: dict[str, int]) -> str:
    told = ", ".join(f"{many} {kind}" for kind, many in kinds.items())
    return f"{times} ({told})" if told else count(times)
