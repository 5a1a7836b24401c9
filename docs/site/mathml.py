"""Equations as MathML, which browsers set by themselves: no script, no font, no network."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

LEFT_OVER = re.compile(r">(&|\\[A-Za-z]*)<")


def as_mathml(node: nodes.Node, *, block: bool) -> str:
    """Return an equation's MathML.

    Raises
    ------
    ExtensionError
        If it is written in a way that is not understood.
    """
    try:
        made = convert(node.astext(), display="block" if block else "inline")
    except Exception as error:
        raise ExtensionError(f"no MathML of {node.astext()!r}: {error}") from error
    if LEFT_OVER.search(made):  # an environment or a command that it does not know
        raise ExtensionError(f"no MathML of {node.astext()!r}: something of it is left as typed")
    return made


def in_line(translator: Any, node: nodes.Node) -> None:
    """Write an equation in a line of text."""
    translator.body.append(as_mathml(node, block=False))
    raise nodes.SkipNode


def displayed(translator: Any, node: nodes.Node) -> None:
    """Write an equation on a line of its own."""
    translator.body.append(f'<div class="math">{as_mathml(node, block=True)}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Have Sphinx use it."""
    app.add_html_math_renderer("mathml", (in_line, None), (displayed, None))
    app.config["html_math_renderer"] = "mathml"
    return {"parallel_read_safe": True, "parallel_write_safe": True}
