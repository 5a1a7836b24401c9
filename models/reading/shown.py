"""What came, in a message: short, on one line, whatever it is."""

from __future__ import annotations

import re
import reprlib
from typing import Any

MOST_SHOWN = 120  # characters of what came
CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f\ud800-\udfff]")  # a terminal obeys them, or breaks
TURNS = re.compile(r"[\u2028\u2029\u200e\u200f\u202a-\u202e\u2066-\u2069]")  # lines or their sense


class _Short(reprlib.Repr):
    def __init__(self) -> None:
        super().__init__()
        self.maxlevel, self.maxdict, self.maxlist, self.maxtuple = 2, 4, 6, 6
        self.maxstring = self.maxother = MOST_SHOWN

    def repr_int(self, x: int, level: int) -> str:
        """Return a whole number, or how long it is: Python refuses to write thousands of digits."""
        digits = x.bit_length() * 0.30103
        return repr(x) if digits < MOST_SHOWN else f"a whole number of some {digits:.0f} digits"

    def repr_str(self, x: str, level: int) -> str:
        """Return the text as Python would type it: control characters are escaped."""
        short = ascii if not x[:MOST_SHOWN].isprintable() else repr
        return short(x) if len(x) < MOST_SHOWN else short(x[: MOST_SHOWN - 6]) + "..."


_SHORT = _Short()


def is_plain(text: str, *, lines: bool = False) -> bool:
    """Tell whether text has no control characters; with ``lines`` it may have ends and tabs."""
    return not CONTROLS.search(text.replace("\n", "").replace("\t", "") if lines else text)


def reads_as_written(text: str) -> bool:
    """Tell whether a reader sees text in the order in which it stands, on one line."""
    return not TURNS.search(text)


def shown(value: Any) -> str:
    """Return ``repr(value)``, shortened to one line of 120 characters without building it all."""
    text = _SHORT.repr(value).replace("\n", " ")
    return text if len(text) <= MOST_SHOWN else text[: MOST_SHOWN - 3] + "..."


def shown_line(text: str) -> str:
    """Return text of others, such as a parser's words, on one line and printable."""
    line = " ".join(text.split())
    line = line if line.isprintable() else ascii(line)[1:-1]
    return line if len(line) <= 2 * MOST_SHOWN else line[: 2 * MOST_SHOWN - 3] + "..."
