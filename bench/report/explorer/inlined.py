"""Scripts and data as text that may stand in a page, and the policy that lets only them run."""

from __future__ import annotations

import base64
import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
LIBRARIES = ("vendored/libraries.min.js",)
SCRIPTS = (
    "frames.js", "marks.js", "picture.js", "plots.js", "stage.js", "scene.js", "orbit.js",
    "start.js",
)  # fmt: skip
STYLES = ("vendored/uplot.min.css", "explorer.css")
ESCAPED = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"}


@dataclass(frozen=True)
class Inlined:
    """What a page holds for its explorer.

    Attributes
    ----------
    data : str
        JSON that closes no element and opens no comment.
    scripts : tuple of str
        In their order.
    style : str
    """

    data: str
    scripts: tuple[str, ...]
    style: str


def inlined(data: dict[str, Any]) -> Inlined:
    """Return data and the scripts that show it.

    Parameters
    ----------
    data : dict
        Plain values, every number finite.
    """
    libraries = "".join((HERE / name).read_text() for name in LIBRARIES)
    own = "\n".join((HERE / name).read_text() for name in SCRIPTS)
    style = "\n".join((HERE / name).read_text() for name in STYLES)
    return Inlined(safe_json(data), (libraries, f'"use strict";\n(() => {{\n{own}}})();\n'), style)


def safe_json(value: Any) -> str:
    """Return JSON that no text in it can break out of a ``script`` element.

    Parameters
    ----------
    value : plain values

    Raises
    ------
    ValueError
        If a number is not finite.
    """
    text = json.dumps(value, separators=(",", ":"), allow_nan=False)
    for sign, escape in ESCAPED.items():
        text = text.replace(sign, escape)
    return text


def policy(scripts: tuple[str, ...]) -> str:
    """Return a content security policy: these scripts run, and nothing is ever asked of a network.

    Parameters
    ----------
    scripts : tuple of str
        As they stand in the page.
    """
    digests = [hashlib.sha256(each.encode()).digest() for each in scripts]
    allowed = " ".join(f"'sha256-{base64.b64encode(each).decode()}'" for each in digests)
    return (
        "default-src 'none'; img-src data:; style-src 'unsafe-inline'; "
        f"script-src {allowed or repr('none')}; base-uri 'none'; form-action 'none'"
    )
