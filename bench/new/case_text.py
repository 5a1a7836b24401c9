"""A case to start from, made of the scenario's own tables: each key, its range and default."""

from __future__ import annotations

from typing import Any

from bench.new.table_text import (
    commented_table,
    table_lines,
    table_of,
    table_of_list,
    value_text,
)
from renders.scenario.case_files import case_path
from renders.scenario.scenario import Scenario, read_scenario

FREE_TARGET = "xmm-tumble"  # the shipped case whose values show what [tumble] looks like
SMALL: dict[str, dict[str, Any]] = {
    "camera": {"width": 512},
    "sun": {"default": "S2"},
    "motion": {"start_s": 240.0, "end_s": 290.0, "rate_hz": 0.08},
    "render": {"samples": 16, "marker_samples": 1024},
}
"""What the file sets: five small image pairs, a minute's work."""

NOT_TYPED = ("own_target",)  # stands in resolved scenarios alone

HEAD = """\
# A case of your own: `rvbench run {name}.toml --out out/{name}` renders and scores it as it is.
#
# `#key = value` shows a default: take away the # to change it. `# key = ...` has none. What the
# file does not name keeps its default; an unknown key is refused, whatever it was meant to do.

name = {quoted}
description = "What it is for, in a line or two."
# `rvbench list` names the targets; a .toml file is one of your own, see `rvbench inspect --help`.
target = "maxar1300"
# a named set of errors that a mission would have, in place of [prior], [calibration], [told] and
# [drift]: "table5", "realistic" and others (docs/formats.md)
# errors = ...
"""
NEED_NOT = """\
# What a case need not have: whole tables, each to be taken out of its comments.
"""
NOTES = {
    "tumble": """\
# Name another target too (hispasat, xmm), give sun.default as a vector "x,y,z", set exposure.mode
# to "auto" or "fixed", and take render.marker_samples away, which is for markers alone.
""",
}


def case_text(name: str) -> str:
    """Return the text of a case that runs as it is."""
    parts, optional = [HEAD.format(name=name, quoted=value_text(name))], [NEED_NOT]
    for key, field in Scenario.model_fields.items():
        table, each = table_of(field), table_of_list(field)
        if each is not None:
            optional.append("\n".join(commented_table(key, each, {}, "[[{}]]")) + "\n")
        if table is None or key in NOT_TYPED:
            continue
        if field.default is None:
            free = read_scenario(case_path(FREE_TARGET)).model_dump()[key]
            lines = commented_table(key, table, free or {})
            optional.append(NOTES.get(key, "") + "\n".join(lines) + "\n")
        else:
            parts.append("\n".join(table_lines(key, table, SMALL.get(key, {}))) + "\n")
    return "\n".join(parts + optional)
