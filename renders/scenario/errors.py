"""What is wrong with a scenario, said so that its writer can mend it: expected, came, perhaps."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping
from types import NoneType
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from models.reading.bounds import MOST_NAME
from models.reading.shown import shown, shown_line

MOST_SAID = 10  # faults in one message

EXPECTATIONS = {
    "greater_than": "above {gt:g}",
    "greater_than_equal": "of at least {ge:g}",
    "less_than": "below {lt:g}",
    "less_than_equal": "of at most {le:g}",
    "int_parsing_size": "to be a whole number of fewer digits",
    "string_too_long": "to be at most {max_length} characters",
    "string_pattern_mismatch": "of {letters}",
    "not_printable": "to be printable text",
    "not_a_name": "to be printable text on one line",
    "finite_number": "to be finite",
    "int_type": "to be a whole number",
    "int_parsing": "to be a whole number",
    "int_from_float": "to be a whole number",
    "float_type": "to be a number",
    "float_parsing": "to be a number",
    "bool_type": "to be true or false",
    "bool_parsing": "to be true or false",
    "string_type": "to be text",
    "literal_error": "as one of {expected}",
    "tuple_type": "to be a list",
    "model_type": "to be a table",
    "too_long": "to be a list of {max_length}",
    "too_short": "to be a list of at least {min_length}",
    "missing": "to be a list of {length}",
}
"""What pydantic's kinds of error come to, in the words of someone who writes TOML."""
ENDS = ("ge", "gt", "le", "lt")
OUT_OF_RANGE = {
    "finite_number",
    "greater_than",
    "greater_than_equal",
    "less_than",
    "less_than_equal",
}


def explain(
    where: str, error: ValidationError, root: type[BaseModel], options: Mapping[str, str]
) -> str:
    """Return everything that is wrong, in one line.

    Parameters
    ----------
    where : str
        The file, or what else was read.
    error : ValidationError
    root : type of BaseModel
        Whose keys and descriptions help.
    options : mapping of str to str
        Keys that were typed as options, and the option's name.
    """
    faults = [fault for fault in error.errors() if not _follows(fault, error)]
    said = dict.fromkeys(_item(dict(item), root, options) for item in faults[:MOST_SAID])
    more = [f"and {len(faults) - MOST_SAID} more"] if len(faults) > MOST_SAID else []
    return f"{where}: " + "; ".join([*said, *more])


def _follows(fault: Any, error: ValidationError) -> bool:
    """Tell whether a list is only too short because what is in it was refused."""
    place = fault["loc"]
    return fault["type"] == "too_short" and any(
        other["loc"][: len(place)] == place and len(other["loc"]) > len(place)
        for other in error.errors()
    )


def _letters(pattern: str) -> str:
    """Return in words what a pattern such as ``^[A-Za-z0-9_-]{1,32}$`` lets through."""
    signs = re.findall(r"\[A-Za-z0-9([^A-Za-z0-9\]]*)\]", pattern)
    told = ["letters", "digits", *(signs[-1] if signs else "")]
    most = re.search(r"\{([01]),(\d+)\}\$", pattern)  # {0,n} comes after the first character
    end = f", {int(most[2]) + (most[1] == '0')} at most" if most else ""
    return f"{', '.join(told[:-1])} and {told[-1]} alone{end}"


def _item(item: dict[str, Any], root: type[BaseModel], options: Mapping[str, str]) -> str:
    location, kind, came = item["loc"], item["type"], item["input"]
    if kind == "extra_forbidden":
        return _unknown(location, root)
    too_short = kind == "missing" and isinstance(location[-1], int)
    if kind == "missing" and not too_short:
        return f"expected the key {_key(location)}, got none"
    location = location[:-1] if too_short else location
    field = _field(location, root)
    length = len(get_args(field.annotation)) if field is not None else 0
    expected = f"otherwise ({shown_line(item['msg'].lower())})"
    if kind in EXPECTATIONS:
        told = item.get("ctx", {})
        letters = _letters(told.get("pattern", ""))
        expected = EXPECTATIONS[kind].format(length=length, letters=letters, **told)
        if kind in OUT_OF_RANGE and field is not None:
            expected = _range(field) or expected
    hint = f" ({field.description})" if field is not None and field.description else ""
    key = options.get(_key(location), _key(location))
    return f"expected {key} {expected}{hint}, got {shown(came)}"


def _range(field: FieldInfo) -> str:
    """Return the whole range of a field that has two ends; nothing for another."""
    ends = {
        name: getattr(fact, name) for fact in field.metadata for name in ENDS if hasattr(fact, name)
    }
    if "le" in ends and "ge" in ends:
        return f"from {ends['ge']:g} to {ends['le']:g}"
    if len(ends) == 2:
        low = f"above {ends['gt']:g}" if "gt" in ends else f"of at least {ends['ge']:g}"
        high = f"below {ends['lt']:g}" if "lt" in ends else f"at most {ends['le']:g}"
        return f"{low} and {high}"
    return ""


def _unknown(location: tuple[Any, ...], root: type[BaseModel]) -> str:
    table = _table(location[:-1], root)
    known = list(table.model_fields) if table is not None else []
    near = difflib.get_close_matches(str(location[-1])[:MOST_NAME], known, n=1)
    hint = f"; perhaps you meant {near[0]}" if near else ""
    return f"unknown key {_key(location)}; expected one of {', '.join(known)}{hint}"


def _key(location: tuple[Any, ...]) -> str:
    return shown_line(".".join(str(part)[:MOST_NAME] for part in location))


def _field(location: tuple[Any, ...], root: type[BaseModel]) -> FieldInfo | None:
    table = _table(location[:-1], root)
    return None if table is None else table.model_fields.get(location[-1])


def _table(location: tuple[Any, ...], root: type[BaseModel]) -> type[BaseModel] | None:
    """Return the table at a location, or None if there is none."""
    table, rows = root, None
    for key in location:
        if isinstance(key, int):
            inner, rows = rows, None
        else:
            field = table.model_fields.get(key)
            inner = _without_none(field.annotation) if field is not None else None
            rows = _row(inner)
            if rows is not None:
                continue
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return None
        table = inner
    return table


def _row(annotation: Any) -> Any:
    """Return what a list of tables holds, or None for anything else."""
    kinds = [kind for kind in get_args(annotation) if kind is not Ellipsis]
    is_rows = len(kinds) == 1 and isinstance(kinds[0], type) and issubclass(kinds[0], BaseModel)
    return kinds[0] if is_rows else None


def _without_none(annotation: Any) -> Any:
    """Return what an optional table is where it is one."""
    kinds = [kind for kind in get_args(annotation) if kind is not NoneType]
    return kinds[0] if len(kinds) == 1 and NoneType in get_args(annotation) else annotation
