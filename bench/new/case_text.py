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

from renders.scenario.case_files import case_path
from renders.scenario.scenario import Scenario, read_scenario

WIDTH = 100
FREE_TARGET = "xmm-tumble"  # the shipped case whose values show what [tumble] looks like
SHORT = 3  # keys of a table that is written in one line
LIMITS = {"ge": "from {}", "gt": "above {}", "le": "up to {}", "lt": "below {}"}
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
    parts, optional = [HEAD.format(name=name, quoted=_value(name))], [NEED_NOT]
    for key, field in Scenario.model_fields.items():
        table = _table(field)
        if table is None or key in NOT_TYPED:
            continue
        if field.default is None:
            free = read_scenario(case_path(FREE_TARGET)).model_dump()[key]
            lines = _commented_table(key, table, free or {})
            optional.append(NOTES.get(key, "") + "\n".join(lines) + "\n")
        else:
            parts.append("\n".join(_lines(key, table, SMALL.get(key, {}))) + "\n")
    return "\n".join(parts + optional)


def _lines(key: str, table: type[BaseModel], given: Mapping[str, Any]) -> Iterator[str]:
    yield from _prose(table)
    yield f"[{key}]"
    for name, field in table.model_fields.items():
        if name in given:
            default = f"default {_value(field.default)}"
            yield _with_note(f"{name} = {_value(given[name])}", field, default)
        else:
            yield _with_note(_key(name, _shown(field)), field)


def _commented_table(
    key: str, table: type[BaseModel], values: Mapping[str, Any], brackets: str = "[{}]"
) -> Iterator[str]:
    yield from _prose(table)
    yield "#" + brackets.format(key)
    below = []
    for name, field in table.model_fields.items():
        own, each = _table(field), _table_of_list(field)
        if each is not None:
            below.append(_commented_table(f"{key}.{name}", each, {}, "[[{}]]"))
        elif own is not None and not _is_short(own):
            inner = values.get(name) or {}
            below.append(_commented_table(f"{key}.{name}", own, inner))
        else:
            shown = _value(values[name]) if values.get(name) is not None else _shown(field)
            default = "required" if field.is_required() else ""
            if not default and shown != _shown(field):
                default = f"default {_value(field.default)}"
            yield _with_note(_key(name, shown), field, default)
    for lines in below:
        yield "#"
        yield from lines


def _key(name: str, shown: str | None) -> str:
    """Return a key in its comment; one without a value to show has no default."""
    return f"# {name} = ..." if shown is None else f"#{name} = {shown}"


def _shown(field: FieldInfo) -> str | None:
    """Return the value that stands for a key as TOML, or None if there is none."""
    own = _table(field)
    if own is not None and _is_short(own):
        inner = (f"{name} = {_value(each.default)}" for name, each in own.model_fields.items())
        return f"{{{', '.join(inner)}}}"
    if field.default is None or field.is_required():
        choices = _choices(field)
        return _value(choices[0]) if choices and field.is_required() else None
    return _value(field.default)


def _is_short(table: type[BaseModel]) -> bool:
    """Tell whether a table fits into a line: it holds plain values, and each has a default."""
    return len(table.model_fields) <= SHORT and all(
        _table(field) is None and not field.is_required() and field.default is not None
        for field in table.model_fields.values()
    )


def _with_note(text: str, field: FieldInfo, default: str = "") -> str:
    """Return a key with what there is to say of it: beside it, or above where it is too long."""
    choices = " or ".join(_value(choice) for choice in _choices(field)[1:] and _choices(field))
    said = [field.description or "", choices or _limits(field), default]
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
    words = re.sub(r";? see ``[^`]*``", "", " ".join(first.split())).replace("``", "`")
    return textwrap.wrap(f"# {words}", WIDTH, subsequent_indent="# ")


def _table(field: FieldInfo) -> type[BaseModel] | None:
    kinds = [kind for kind in get_args(field.annotation) if kind is not NoneType]
    kind = kinds[0] if len(kinds) == 1 else field.annotation
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def _table_of_list(field: FieldInfo) -> type[BaseModel] | None:
    """Return what a list of tables is a list of."""
    kinds = get_args(field.annotation) if get_origin(field.annotation) in (tuple, list) else ()
    kind = kinds[0] if kinds else None
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def _choices(field: FieldInfo) -> list[Any]:
    kinds = [field.annotation, *get_args(field.annotation)]
    return [c for kind in kinds if get_origin(kind) is Literal for c in get_args(kind)]


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
