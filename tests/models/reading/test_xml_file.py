"""XML that would take the memory, the disk or another file is refused before it does."""

from __future__ import annotations

import pytest

from models.errors import UnreadableError
from models.reading.xml_file import MOST_ELEMENTS, MOST_LEVELS, parse_xml


def bomb(levels: int) -> str:
    """Return a text whose entities would grow tenfold a level."""
    lines = ['<!ENTITY e0 "ha">']
    lines += [f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, levels)]
    return f"<!DOCTYPE r [{''.join(lines)}]><r>&e{levels - 1};</r>"


REFUSED = {
    "a bomb": (bomb(12), "document type"),
    "another file": (
        '<!DOCTYPE r [<!ENTITY f SYSTEM "file:///etc/hostname">]><r>&f;</r>',
        "DOCTYPE",
    ),
    "too deep": ("<a>" * (MOST_LEVELS + 1) + "</a>" * (MOST_LEVELS + 1), "nested more than"),
    "too many": (f"<r>{'<a/>' * MOST_ELEMENTS}</r>", "more than"),
    "cut off": ("<r><a>", "mine.xml"),
    "nothing": ("", "mine.xml"),
    "two roots": ("<r/><r/>", "mine.xml"),
}


@pytest.mark.parametrize("why", REFUSED)
def test_what_must_not_be_read_is_refused(why):
    text, said = REFUSED[why]
    with pytest.raises(UnreadableError) as raised:
        parse_xml(text, "mine.xml")
    assert said in str(raised.value)
    assert str(raised.value).startswith("mine.xml")


def test_what_is_plain_is_read():
    root = parse_xml('<?xml version="1.0"?><r name="x"><a>1</a><!-- no --><a>2</a></r>', "mine.xml")
    assert root.get("name") == "x"
    assert [each.text for each in root] == ["1", "2"]
