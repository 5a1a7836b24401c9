"""XML files: bounded in size, depth and number of elements, and without a document type.

A document type is where XML declares entities: one of a few lines can stand for gigabytes, or for
another file. What we read needs none.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder, XMLParser
from xml.parsers import expat

from models.errors import UnreadableError
from models.reading.shown import shown_line

MOST_LEVELS = 64
MOST_ELEMENTS = 100_000


class _Refused(Exception):
    """What is in the file may not be in it."""


class _Bounded(TreeBuilder):
    """Builds a tree, up to a size."""

    def __init__(self) -> None:
        super().__init__()
        self._level = self._elements = 0

    def start(self, tag: str, attrs: dict[str, str]) -> Element:
        self._level += 1
        self._elements += 1
        if self._level > MOST_LEVELS:
            raise _Refused(f"elements nested more than {MOST_LEVELS} deep")
        if self._elements > MOST_ELEMENTS:
            raise _Refused(f"more than {MOST_ELEMENTS} elements")
        return super().start(tag, attrs)

    def end(self, tag: str) -> Element:
        self._level -= 1
        return super().end(tag)

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        raise _Refused("a document type, which may declare entities; take the DOCTYPE out")


def parse_xml(text: str, where: Path | str) -> Element:
    """Return the root element of a text.

    Parameters
    ----------
    text : str
    where : Path or str
        Its file, for messages.

    Raises
    ------
    UnreadableError
        If it is no XML, too deep or too many elements, or has a document type.
    """
    parser = XMLParser(target=_Bounded())
    try:
        parser.feed(text)
        return parser.close()
    except _Refused as error:
        raise UnreadableError(Path(where), str(error)) from error
    except (SyntaxError, expat.ExpatError, ValueError) as error:
        raise UnreadableError(Path(where), shown_line(str(error))) from error
