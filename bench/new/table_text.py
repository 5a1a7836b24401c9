"""Tables of a file to start from, made of the tables that read it: every key, range and default.

Prose is written ``# so``; a key that may be taken out of its comment, ``#key = value``.
"""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Collection, Iterator, Mapping
from types import NoneType
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

WIDTH = 100
SHORT = 3  # keys of a table that is written in one line
LIMITS = {"ge": "from {}", "gt": "above {}", "le": "up to {}", "lt": "below {}"}


def table_lines(
    key: str,
    table: type[BaseModel],
    given: Mapping[str, Any],
    brackets: str = "[{}]",
    left_out: Collection[str] = (),
) -> Iterator[str]:
    """Yield the lines of a table, with its keys: those given as they are, others in comments.

    Parameters
    ----------
    key : str
        Its name.
    table : type of BaseModel
    given : mapping
        Values by key.
    brackets : str
        ``[[{}]]`` for one of a list.
    left_out : collection of str
        Keys that are not told.
    """
    yield from _prose(table)
    yield brackets.format(key)
    for name, field in table.model_fields.items():
        is_table = table_of_list(field) is not None or table_of(field) is not None
        if is_table or name in left_out:
            continue
        if name in given:
            has_default = not field.is_required() and field.default is not None
            default = f"default {value_text(field.default)}" if has_default else ""
            yield _with_note(f"{name} = {value_text(given[name])}", field, default)
        else:
            yield _with_note(_key(name, _shown(field)), field)


def commented_table(
    key: str, table: type[BaseModel], values: Mapping[str, Any], brackets: str = "[{}]"
) -> Iterator[str]:
    """Yield the lines of a table, all of them in comments.

    Parameters
    ----------
    key : str
        Its name.
    table : type of BaseModel
    values : mapping
        What keys show instead of their defaults.
    brackets : str
        ``[[{}]]`` for one of a list.
    """
    yield from _prose(table)
    yield "#" + brackets.format(key)
    below = []
    for name, field in table.model_fields.items():
        own, each = table_of(field), table_of_list(field)
        if each is not None:
            below.append(commented_table(f"{key}.{name}", each, {}, "[[{}]]"))
        elif own is not None and not _is_short(own):
            inner = values.get(name) or {}
            below.append(commented_table(f"{key}.{name}", own, inner))
        else:
            shown = value_text(values[name]) if values.get(name) is not None else _shown(field)
            default = "required" if field.is_required() else ""
            if not default and shown != _shown(field):
                default = f"default {value_text(field.default)}"
            yield _with_note(_key(name, shown), field, default)
    for lines in below:
        yield "#"
        yield from lines


def _key(name: str, shown: str | None) -> str:
    """Return a key in its comment; one without a value to show has no default."""
    return f"# {name} = ..." if shown is None else f"#{name} = {shown}"


def _shown(field: FieldInfo) -> str | None:
    """Return the value that stands for a key as TOML, or None if there is none."""
    own = table_of(field)
    if own is not None and _is_short(own):
        inner = (f"{name} = {value_text(each.default)}" for name, each in own.model_fields.items())
        return f"{{{', '.join(inner)}}}"
    if field.default is None or field.is_required():
        choices = _choices(field)
        return value_text(choices[0]) if choices and field.is_required() else None
    return value_text(field.default)


def _is_short(table: type[BaseModel]) -> bool:
    """Tell whether a table fits into a line: it holds plain values, and each has a default."""
    return len(table.model_fields) <= SHORT and all(
        table_of(field) is None and not field.is_required() and field.default is not None
        for field in table.model_fields.values()
    )


def _with_note(text: str, field: FieldInfo, default: str = "") -> str:
    """Return a key with what there is to say of it: beside it, or above where it is too long."""
    choices = " or ".join(value_text(choice) for choice in _choices(field)[1:] and _choices(field))
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


def table_of(field: FieldInfo) -> type[BaseModel] | None:
    """Return the table that a field holds; None if it holds none."""
    kinds = [kind for kind in get_args(field.annotation) if kind is not NoneType]
    kind = kinds[0] if len(kinds) == 1 else field.annotation
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def table_of_list(field: FieldInfo) -> type[BaseModel] | None:
    """Return what a list of tables is a list of, optional or not; None for anything else."""
    kinds = [field.annotation, *get_args(field.annotation)]
    kinds += [inner for kind in kinds for inner in get_args(kind)]
    for kind in kinds:
        if get_origin(kind) in (tuple, list) and get_args(kind):
            own = get_args(kind)[0]
            if isinstance(own, type) and issubclass(own, BaseModel):
                return own
    return None


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


def value_text(value: Any) -> str:
    """Return a value as TOML, lists in one line."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list | tuple):
        return f"[{', '.join(value_text(each) for each in value)}]"
    return repr(value)
