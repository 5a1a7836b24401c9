"""How deep lists and tables lie in one another: counted before a parser descends into them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from models.errors import UnreadableError

MOST_LEVELS = 32  # no file of the house has more than six

_JSON = re.compile(r'"(?:[^"\\]|\\.)*+"|(?P<bracket>[\[\]{}])', re.DOTALL)

_BASIC, _LITERAL = r'"(?:[^"\\\n]|\\.)*+"', r"'[^'\n]*+'"
_PART = rf"(?:[\w-]++|{_BASIC}|{_LITERAL})"
_TOML = re.compile(
    rf"(?P<dotted>{_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{MOST_LEVELS}}})"
    r'|"""(?:[^"\\]|\\.|"(?!""))*+"""' + r"|'''(?:[^']|'(?!''))*+'''"
    rf"|{_BASIC}|{_LITERAL}|\#[^\n]*+|[\w-]++|(?P<bracket>[\[\]{{}}])",
    re.DOTALL,
)


def check_json_nesting(path: Path, text: str, line: int | None = None) -> None:
    """Refuse JSON nested more than 32 deep.

    Parameters
    ----------
    path : Path
        For the message.
    text : str
    line : int, optional
        That of the text in its file, if it is but one.

    Raises
    ------
    UnreadableError
    """
    if text.count("[") + text.count("{") > MOST_LEVELS:
        _check(path, text, _JSON, line)


def check_toml_nesting(path: Path, text: str) -> None:
    """Refuse TOML whose lists, tables or dotted keys nest more than 32 deep.

    Raises
    ------
    UnreadableError
    """
    if text.count("[") + text.count("{") + text.count(".") > MOST_LEVELS:
        _check(path, text, _TOML, None)


def _check(path: Path, text: str, tokens: re.Pattern[str], line: int | None) -> None:
    level = 0
    for token in tokens.finditer(text):
        if token.lastgroup is None:
            continue
        bracket = token["bracket"]
        if bracket is None:
            level = MOST_LEVELS + 1
        elif bracket in "[{":
            level += 1
        else:
            level = max(level - 1, 0)
        if level > MOST_LEVELS:
            if line is None:
                line = text.count("\n", 0, token.start()) + 1
            raise UnreadableError(path, f"nested more than {MOST_LEVELS} deep", line)


def too_deep(value: Any) -> bool:
    """Tell whether parsed lists and tables nest more than 32 deep."""
    layer = [value]
    for _ in range(MOST_LEVELS):
        if not layer:
            return False
        below: list[Any] = []
        for item in layer:
            if isinstance(item, dict):
                below.extend(item.values())
            elif isinstance(item, list):
                below.extend(item)
        layer = [item for item in below if isinstance(item, dict | list)]
    return bool(layer)
