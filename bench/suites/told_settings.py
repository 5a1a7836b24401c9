"""What shaped a suite, for its page: sizes as one types them, a pipeline's options in words."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from bench.suites.request import SuiteRequest

DATACLASS = re.compile(r"[A-Z]\w*\(")
TYPED = frozenset(field.name for field in fields(SuiteRequest))


def told_settings(settings: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return names and words: ``--paper-runs 20`` where it is an option of the command line.

    Parameters
    ----------
    settings : mapping
        Of ``suite.json``.
    """
    told = []
    for key, value in settings.items():
        name = f"--{key.replace('_', '-')}" if key in TYPED else key.replace("_", " ")
        if isinstance(value, dict):
            told += [(f"{name}: {own}", told_value(text)) for own, text in value.items()]
        else:
            told.append((name, told_value(value)))
    return told


def told_value(value: Any) -> str:
    """Return a value as one would type or say it; of a dataclass's repr, names and values."""
    if value is None:
        return "as the suite has it"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.12g}"
    if isinstance(value, list | tuple):
        return " ".join(map(told_value, value))
    if isinstance(value, str):
        try:
            is_code = DATACLASS.match(value) is not None
            return _told_code(ast.parse(value, mode="eval").body) if is_code else value
        except (SyntaxError, ValueError, RecursionError):
            return value
    return str(value)


def _told_code(node: ast.expr) -> str:
    """Return options that were written as code in words."""
    if isinstance(node, ast.Call):
        own = [_told_code(each) for each in node.args]
        own += [f"{each.arg} {_nested(each.value)}" for each in node.keywords]
        return ", ".join(own)
    if isinstance(node, ast.Tuple | ast.List | ast.Set):
        return " ".join(map(_nested, node.elts))
    if isinstance(node, ast.Constant):
        return "none" if node.value is None else told_value(node.value)
    return ast.unparse(node)


def _nested(node: ast.expr) -> str:
    told = _told_code(node)
    is_group = isinstance(node, ast.Call) and (len(node.args) + len(node.keywords)) > 1
    return f"({told})" if is_group else told
