"""What stands in backquotes and names a module or a member leads to its page of the API.

So that a page reads as well where it is not built: it says ``models/camera.py`` or
``models.pose.RigidTransform``, and nothing else is typed. Languages of blocks are taught, too.
"""

from __future__ import annotations

import re

from docutils import nodes
from pygments.lexers.data import JsonLexer
from pygments.lexers.shell import BashLexer
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

ROOMS = r"(?:models|renders|pipelines|bench)"
PATH = re.compile(rf"{ROOMS}(?:/\w+)+(?:\.py|/)?")
DOTTED = re.compile(rf"{ROOMS}(?:\.\w+)+")


def dotted(text: str) -> str:
    """Return the name that a text in backquotes may be of, or nothing."""
    if PATH.fullmatch(text):
        return text.removesuffix(".py").removesuffix("/").replace("/", ".")
    return text if DOTTED.fullmatch(text) else ""


def lead_there(app: Sphinx, doctree: nodes.document, page: str) -> None:
    """Make links of the names of a page."""
    python = app.env.domains["py"]
    known = {**dict.fromkeys(python.data["modules"]), **python.data["objects"]}
    for literal in list(doctree.findall(nodes.literal)):
        name = dotted(literal.astext())
        if name not in known or isinstance(literal.parent, nodes.reference | nodes.title):
            continue
        if name in python.data["modules"]:
            place = python.data["modules"][name]
        else:
            place = python.data["objects"][name]
        if place.docname == page and literal.parent is None:
            continue
        where = app.builder.get_relative_uri(page, place.docname)
        link = nodes.reference("", "", internal=True, refuri=f"{where}#{place.node_id}")
        literal.replace_self(link)
        link += literal


def setup(app: Sphinx) -> dict[str, bool]:
    """Have Sphinx use it."""
    app.connect("doctree-resolved", lead_there)
    app.add_lexer("jsonl", JsonLexer)
    app.add_lexer("csv", TextLexer)
    app.add_lexer("console", BashLexer)  # commands are typed without a prompt
    return {"parallel_read_safe": True, "parallel_write_safe": True}
