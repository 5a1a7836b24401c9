"""Docstrings as they are written in the house, made ready for Sphinx.

They are prose to be read in an editor: an indented paragraph is a formula or a command, and a bar
is a bar. A type is called by the name by which its module knows it; links are looked up there.
"""

from __future__ import annotations

import importlib
import re
from typing import Any

from docutils import nodes
from sphinx.addnodes import pending_xref, pending_xref_condition
from sphinx.application import Sphinx

ROOMS = ("models", "renders", "pipelines", "bench")
QUOTED = re.compile(r"(``[^`]*``|`[^`]*`)")
UNDERLINE = re.compile(r"-{3,}$")


def make_ready(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]
) -> None:
    """Set indented paragraphs as code, and keep bars and stars as they are; in place.

    Parameters
    ----------
    app, what, name, thing, options
        As autodoc has it.
    lines : list of str
        The docstring, changed in place.
    """
    made: list[str] = []
    in_sections = in_code = False
    for place, line in enumerate(lines):
        following = lines[place + 1] if place + 1 < len(lines) else ""
        in_sections |= bool(line and UNDERLINE.match(following))
        indented = line.startswith("    ")
        if in_sections:
            made.append(line if UNDERLINE.match(line) else plain(line))
            continue
        if indented and not in_code and (not made or not made[-1].strip()):
            if not any(each.rstrip().endswith("::") for each in made[-2:]):
                made += ["::", ""]
            in_code = True
        elif line.strip() and not indented:
            in_code = False
        made.append(line if in_code else plain(line))
    lines[:] = made


def plain(line: str) -> str:
    """Return a line whose bars are bars."""
    if line.startswith(("===", "+--", "| ")):
        return line
    pieces = QUOTED.split(line)
    return "".join(
        piece if place % 2 else piece.replace("|", r"\|") for place, piece in enumerate(pieces)
    )


def spell_out(app: Sphinx, doctree: nodes.document) -> None:
    """Give every type that is called by a short name its whole one, or no link at all."""
    for link in list(doctree.findall(pending_xref)):
        if link.get("refdomain") != "py" or link.get("reftype") in ("mod", "func", "meth"):
            continue
        target = link["reftarget"]
        if target.split(".")[0] in ROOMS:
            continue
        whole = whole_name(link.get("py:module"), target)
        if whole is None:
            link.replace_self(said_short(link))
        else:
            link["reftarget"] = whole
            link["refspecific"] = False


def said_short(link: pending_xref) -> list[nodes.Node]:
    """Return what a link shows: of a short and a long name the short one."""
    for child in link.children:
        if isinstance(child, pending_xref_condition) and child["condition"] == "resolved":
            return list(child.children)
    return list(link.children)


def whole_name(module: str | None, name: str) -> str | None:
    """Return the dotted name of what a module of the house calls so; None if it is not ours."""
    if not module or not name.isidentifier():
        return None
    thing = getattr(importlib.import_module(module), name, None)
    home = getattr(thing, "__module__", "") or ""
    if not isinstance(thing, type) or home.split(".")[0] not in ROOMS:
        return None
    return f"{home}.{thing.__qualname__}"


def setup(app: Sphinx) -> dict[str, bool]:
    """Have Sphinx use it."""
    app.connect("autodoc-process-docstring", make_ready, priority=400)
    app.connect("doctree-read", spell_out)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
