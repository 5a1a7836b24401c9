"""A case to start from, made of the scenario's own tables: every key, with its range and default.

Prose is written ``# so``; a key that may be taken out of its comment, ``#key = value``.
"""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterator, Mapping
from types import NoneType
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from renders.scenario.scenario import Scenario, case_path, read_scenario

WIDTH = 100
FREE_TARGET = "xmm-tumble"  # the shipped case whose values show what [tumble] looks like
LIMITS = {"ge": "from {}", "gt": "above {}", "le": "up to {}", "lt": "below {}"}
SMALL: dict[str, dict[str, Any]] = {
    "camera": {"width": 512},
    "sun": {"default": "S2"},
    "motion": {"start_s": 240.0, "end_s": 290.0, "rate_hz": 0.08},
    "render": {"samples": 16, "marker_samples": 1024},
}
"""What the file sets: five small image pairs, a minute's work."""

HEAD = """\
# A case of your own: `rvbench run {name}.toml --out out/{name}` renders and scores it as it is.
#
# A line that begins `#key = value` shows a default: take away the # to change it. What the file
# does not name keeps its default; an unknown key is refused, so a slip of the pen has no effect.

name = {quoted}
description = "What it is for, in a line or two."
# `rvbench list` names the targets.
target = "maxar1300"
"""
TUMBLE = """\
# A target without markers that turns freely, seen in single images: for this take [tumble] and what
# follows out of its comments, name another target (hispasat, xmm), give sun.default as a vector
# x,y,z, set exposure.mode to "auto" or "fixed", and take render.marker_samples away, which is for
# markers alone. The values are those of the case xmm-tumble.
"""


def case_text(name: str) -> str:
    """Return the text of a case that runs as it is."""
    parts = [HEAD.format(name=name, quoted=_value(name))]
    for key, field in Scenario.model_fields.items():
        table = _table(field)
        if table is None:
            continue
        if field.default is None:
            shown = read_scenario(case_path(FREE_TARGET)).model_dump()[key]
            parts.append(TUMBLE + "\n".join(_commented_table(key, table, shown)) + "\n")
        else:
            parts.append("\n".join(_lines(key, table, SMALL.get(key, {}))) + "\n")
    return "\n".join(parts)


def _lines(key: str, table: type[BaseModel], given: Mapping[str, Any]) -> Iterator[str]:
    yield from _prose(table)
    yield f"[{key}]"
    for name, field in table.model_fields.items():
        mark = "" if name in given else "#"
        text = f"{mark}{name} = {_value(given.get(name, field.default))}"
        default = f"default {_value(field.default)}" if name in given else ""
        yield _with_note(text, field, default)


def _commented_table(key: str, table: type[BaseModel], shown: Mapping[str, Any]) -> Iterator[str]:
    yield from _prose(table)
    yield f"#[{key}]"
    inner = {}
    for name, field in table.model_fields.items():
        own = _table(field)
        if own is not None:
            inner[name] = own
            continue
        default = "required" if field.is_required() else f"default {_value(field.default)}"
        yield _with_note(f"#{name} = {_value(shown[name])}", field, default)
    for name, own in inner.items():
        yield "#"
        yield from _commented_table(f"{key}.{name}", own, shown[name])


def _with_note(text: str, field: FieldInfo, default: str) -> str:
    """Return a key with what there is to say of it: beside it, or above where it is too long."""
    said = [field.description or "", _choices(field) or _limits(field), default]
    note = "; ".join(part for part in said if part)
    if not note:
        return text
    beside = f"{text:<36}  # {note}"
    if len(beside) <= WIDTH:
        return beside
    return "\n".join([*textwrap.wrap(f"# {note}", WIDTH, subsequent_indent="# "), text])


def _prose(table: type[BaseModel]) -> list[str]:
    """Return the first paragraph of a table's docstring, without what it says of our modules."""
    first = (table.__doc__ or "").split("\n\n")[0]
    told = re.sub(r";? see ``[^`]*``", "", " ".join(first.split())).replace("``", "`")
    return textwrap.wrap(f"# {told}", WIDTH, subsequent_indent="# ")


def _table(field: FieldInfo) -> type[BaseModel] | None:
    kinds = [kind for kind in get_args(field.annotation) if kind is not NoneType]
    kind = kinds[0] if len(kinds) == 1 else field.annotation
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def _choices(field: FieldInfo) -> str:
    if get_origin(field.annotation) is not Literal:
        return ""
    return " or ".join(_value(choice) for choice in get_args(field.annotation))


def _limits(field: FieldInfo) -> str:
    told = [
        words.format(f"{limit:.10g}")
        for name, words in LIMITS.items()
        for each in field.metadata
        if (limit := getattr(each, name, None)) is not None
    ]
    return " ".join(told)


def _value(value: Any) -> str:
    """Return a value as TOML, lists in one line."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list | tuple):
        return f"[{', '.join(_value(each) for each in value)}]"
    return repr(value)
