"""A reference of every key of a scenario, made from its tables.

``python -m bench.scenario_reference`` writes ``docs/scenario.md``; a house test holds that file to
the tables.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import tomli_w
from pydantic.fields import FieldInfo

from models.motion.pose_table import pose_columns
from renders.scenario.scenario import Scenario
from renders.scenario.table import Table

PLACE = Path(__file__).resolve().parents[1] / "docs" / "scenario.md"
HEAD = """\
# The keys of a scenario

Made from the tables in `renders/scenario/` by `python -m bench.scenario_reference`; do not edit.

A scenario is a TOML file. What is left out has its default; a key that is not here is refused. A
path to such a file works wherever the name of a case does, and `bench/cases/` holds some to start
from. Units stand at the end of a key. Files that a scenario names lie beside it, and what they say
is written into the resolved scenario, `truth/scenario.toml` in a dataset.
"""
EXAMPLE = """\
name = "mine"
target = "maxar1300"
markers = "markers.toml"        # places and normals of your own, in tables [[marker]]

[camera]
width = 1920
height = 1200
fx = 2210.0
fy = 2190.0
cx = 987.3                      # pixel centres are integers
cy = 571.8
k1 = -0.22

[detector]
pixel_pitch_um = 3.45

[motion]
file = "poses.csv"              # each row a frame; poses = "interpolated" flies through them

[sun]
default = "0.3,-0.5,1"          # "table": that of each row, sun_x,sun_y,sun_z

[told.camera]
fx = { sigma = 1.0 }            # drawn in every run, and the pipeline is told how widely
fy = { sigma = 1.0 }
cx = { offset = 0.5 }           # of which it knows nothing

[told.markers]
place_m = { sigma = 0.001 }
"""
"""A scenario of one's own; a test reads it."""
ABOUT_EXAMPLE = """\
## A scenario of your own

```toml
{example}```

The first line of `poses.csv` says which way the poses map; quaternions are scalar first:

```
{columns}
```

or the same with `target_from_cam`. `sun_x,sun_y,sun_z` (towards the Sun, target axes, length 1) and
`exposure_ms` may stand beside them, and what is behind: `earth_x,earth_y,earth_z` (towards the
Earth's centre, or three zeros for none; with `[earth] shines = true`) and `stars` (1 or 0; with
`[stars] shine = true`). Rows that follow each other at one pose, under other Suns, are traced
together. Camera axes are x right, y down, z forward. `--width` renders a
camera of your own at fewer columns, its field of view kept, for a first look.

`rvbench run` goes on to the pipelines, and refuses at once what none takes. Of targets with markers
ours take image pairs (`frame.kind = "pairs"`), or images in colour of white dots; of those without
they need the chaser's orbit, which `[tumble]` brings: single images at poses of a table are for
`rvbench render`, and for pipelines of your own (`rvbench new pipeline NAME`).
"""
COLUMNS = ("key", "type", "unit", "default", "range", "meaning")
UNITS = {
    "m": "m", "km": "km", "um": "um", "px": "px", "deg": "deg", "s": "s", "ms": "ms", "hz": "Hz",
    "e": "e", "dn": "DN", "ppm": "1e-6", "e_s": "e/s", "e_dn": "e/DN", "e_um": "e/um",
    "w_sr": "W/sr", "1_sr": "1/sr", "cm2_s": "1/cm2/s", "m_s": "m/s", "deg_s": "deg/s",
    "deg_h": "deg/h", "kg_m2": "kg m2",
}  # fmt: skip
IN_PIXELS = {"width", "height", "rendered_width", "fx", "fy", "cx", "cy"}
ENDS = {"ge": "from {:g}", "gt": "above {:g}", "le": "to {:g}", "lt": "below {:g}"}
KINDS = {float: "number", int: "whole number", bool: "true or false", str: "text"}


def reference() -> str:
    """Return the whole reference, as Markdown."""
    uses = Counter(kind for _, kind in _walk(Scenario, ""))
    shared = [kind for kind, count in uses.items() if count > 1]
    sections = [_section("At the top", Scenario, shared)]
    for name, kind in _walk(Scenario, ""):
        if kind not in shared:
            title = f"`[[{name}]]`" if _is_list_at(name) else f"`[{name}]`"
            sections.append(_section(title, kind, shared))
    sections += [_section(_title(kind), kind, shared) for kind in shared]
    columns = ",".join(pose_columns("cam_from_target"))
    return "\n".join([HEAD, ABOUT_EXAMPLE.format(example=EXAMPLE, columns=columns), *sections])


def main() -> None:
    """Write the reference."""
    PLACE.write_text(reference())


def _walk(table: type[Table], within: str) -> Iterator[tuple[str, type[Table]]]:
    """Walk the tables within a table: their names, and what they are."""
    for key, field in table.model_fields.items():
        if (inner := _inner(field)) is not None:
            yield f"{within}{key}", inner
            yield from _walk(inner, f"{within}{key}.")


def _section(title: str, table: type[Table], shared: list[type[Table]]) -> str:
    rows = []
    for key, field in table.model_fields.items():
        inner = _inner(field)
        if inner is None:
            rows.append(_row(key, field))
        elif inner in shared:
            about = f"[{_title(inner)}](#{_title(inner).replace(' ', '-')})"
            unit, meaning = _unit(key), field.description or ""
            rows.append((f"`{key}`", about, unit, _default(field), "", meaning))
    text = [f"## {title}", "", _prose(table)]
    if rows:
        lines = [COLUMNS, tuple("---" for _ in COLUMNS), *rows]
        text += ["", *("| " + " | ".join(row) + " |" for row in lines)]
    return "\n".join([*text, ""])


def _row(key: str, field: FieldInfo) -> tuple[str, ...]:
    meaning = (field.description or "").replace("|", "\\|")
    return f"`{key}`", _kind(field), _unit(key), _default(field), _range(field), meaning


def _inner(field: FieldInfo) -> type[Table] | None:
    """Return the table that a field holds, alone or in a list; None if it holds none."""
    for kind in _kinds(field.annotation):
        if isinstance(kind, type) and issubclass(kind, Table):
            return kind
    return None


def _kinds(annotation: Any) -> Iterator[Any]:
    """Walk everything that an annotation names."""
    yield annotation
    for inner in get_args(annotation):
        yield from _kinds(inner)


def _is_list_at(name: str) -> bool:
    table: type[Table] = Scenario
    *outer, last = name.split(".")
    for key in outer:
        inner = _inner(table.model_fields[key])
        assert inner is not None
        table = inner
    return any(get_origin(kind) is tuple for kind in _kinds(table.model_fields[last].annotation))


def _title(table: type[Table]) -> str:
    """Return a table's class as words: ``VectorDifference`` is a vector difference."""
    return re.sub(r"(?<!^)(?=[A-Z])", " ", table.__name__.removesuffix("Table")).lower()


def _prose(table: type[Table]) -> str:
    said = re.sub(r"``([^`]*)``", r"`\1`", table.__doc__ or "")
    return "\n".join(line.strip() for line in said.strip().splitlines())


def _unit(key: str) -> str:
    if key in IN_PIXELS:
        return "px"
    parts = key.split("_")
    for start in range(1, len(parts)):  # the longest suffix says it
        unit = UNITS.get("_".join(parts[start:]))
        if unit is not None:
            return unit
    return ""


def _kind(field: FieldInfo) -> str:
    return _words(field.annotation)


def _words(annotation: Any) -> str:
    origin, inner = get_origin(annotation), get_args(annotation)
    if annotation in KINDS:
        return KINDS[annotation]
    if origin is Annotated:
        return _words(inner[0])
    if origin is Literal:
        return "one of " + ", ".join(f"`{word}`" for word in inner)
    if origin is tuple:
        many = Ellipsis in inner
        item = _words(inner[0])
        plural = item.replace("list of ", "lists of ") if "list of" in item else f"{item}s"
        plural = "texts" if plural == "texts" else plural
        return f"list of {plural}" if many else f"list of {len(inner)} {plural}"
    alternatives = [kind for kind in inner if kind is not NoneType]
    assert len(alternatives) == 1, annotation
    assert origin is Union or NoneType in inner, annotation
    return _words(alternatives[0])


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    if field.default is None:
        return "left out"
    if isinstance(field.default, Table):
        return "as it is"
    text = tomli_w.dumps({"x": _plain(field.default)}).removeprefix("x = ").strip()
    flat = " ".join(text.split()).replace("[ ", "[").replace(", ]", "]")
    return f"`{flat}`"


def _plain(value: Any) -> Any:
    return [_plain(item) for item in value] if isinstance(value, tuple) else value


def _range(field: FieldInfo) -> str:
    """Return the range of a number, or of each in a list."""
    facts = [*field.metadata, *(fact for kind in _kinds(field.annotation) for fact in _said(kind))]
    ends = {
        end: getattr(fact, end)
        for fact in facts
        for end in ENDS
        if getattr(fact, end, None) is not None
    }
    return " ".join(ENDS[end].format(ends[end]) for end in ENDS if end in ends)


def _said(annotation: Any) -> Iterator[Any]:
    """Walk the facts that an ``Annotated`` states, those of a ``Field`` among them."""
    for fact in getattr(annotation, "__metadata__", ()):
        yield from fact.metadata if isinstance(fact, FieldInfo) else (fact,)


if __name__ == "__main__":
    main()
