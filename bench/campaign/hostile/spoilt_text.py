"""Ways to spoil text by its tokens: TOML, JSON, CSV, XML, OBJ alike.

A token is a number, a text in quotes, a word or a sign; what comes in its place is what users,
other programs and those who mean harm have written there.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TypeAlias

from numpy.random import Generator

TextSpoil: TypeAlias = Callable[[Generator, str], str]
DIGITS, LEVELS, LONG = 4400, 5000, 6000
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w.])")
QUOTED = re.compile(r'"[^"\n]*"')
WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
SIGN = re.compile(r"[^\w\s]")
CELL = re.compile(r"[^,\s\[\]{}=:\"]+")
NUMBERS = (
    "nan", "NaN", "inf", "-inf", "Infinity", "-Infinity", "1e400", "-1e400", "1e308", "-1e308",
    "1e-320", "0", "-0.0", "-1", "1", "2", "0.5", "1e9", "-1e9", "1e18", "2147483648",
    "-9223372036854775809", "18446744073709551616", "9" * DIGITS, "1_000", "0x10", "1e", "--1",
    "true", "null", '"5"', "[]", "{}", "", "1,5", "\u0665", "1979-05-27",
)  # fmt: skip
TEXTS = (
    '""', '" "', '"../decoy/precious.txt"', '"../../../../../../etc/passwd"', '"/dev/zero"',
    '"/dev/stdin"', '"."', '".."', '"/"', '"\\u0000"', '"\\u001b[2J"', '"a\\nb"', '"\u202etxt"',
    f'"{"x" * LONG}"', '"\\ud800"', '"{index}"', '"{index:9999999d}"', '"{index.__class__}"',
    '"{0}"', '"%s%n"', '"[red]"', '"*"', '"a/b"', '"~"', "5", "-1", "true", "null", "[]", "{}",
    '["a"]', '{"a": 1}', "nan", "'", '"',
)  # fmt: skip
NESTS = ("[" * LEVELS + "]" * LEVELS, '{"a":' * LEVELS + "1" + "}" * LEVELS, "[" * LEVELS)


def number(random: Generator, text: str) -> str:
    """Put another number, or what is none, in a number's place."""
    return _replaced(random, text, NUMBER, NUMBERS)


def quoted(random: Generator, text: str) -> str:
    """Put another text, or what is none, in the place of one in quotes."""
    return _replaced(random, text, QUOTED, TEXTS)


def cell(random: Generator, text: str) -> str:
    """Put a number, a text or nothing in the place of any value."""
    return _replaced(random, text, CELL, (*NUMBERS, *TEXTS))


def word(random: Generator, text: str) -> str:
    """Spell a word wrongly, or put another of the text's in its place."""
    found = list(WORD.finditer(text))
    if not found:
        return cell(random, text)
    one, other = found[int(random.integers(len(found)))], found[int(random.integers(len(found)))]
    was = one[0]
    place = int(random.integers(len(was)))
    spelled = (
        other[0], was[:place] + was[place + 1 :], was[:place] + "_" + was[place:],
        was.upper(), was.swapcase(), was[::-1],
    )  # fmt: skip
    return text[: one.start()] + _one_of(random, spelled) + text[one.end() :]


def sign(random: Generator, text: str) -> str:
    """Take a sign out, or have it twice, or another in its place."""
    found = list(SIGN.finditer(text))
    if not found:
        return cell(random, text)
    one, other = found[int(random.integers(len(found)))], found[int(random.integers(len(found)))]
    return text[: one.start()] + _one_of(random, ("", one[0] * 2, other[0])) + text[one.end() :]


def line(random: Generator, text: str) -> str:
    """Take a line out, have it twice, elsewhere, cut short, or joined with the next."""
    lines = text.splitlines(keepends=True)
    if len(lines) < 2:
        return sign(random, text)
    here, there = int(random.integers(len(lines))), int(random.integers(len(lines)))
    kind, was = int(random.integers(5)), lines[here]
    if kind == 0:
        del lines[here]
    elif kind == 1:
        lines.insert(there, was)
    elif kind == 2:
        lines[here], lines[there] = lines[there], was
    elif kind == 3:
        lines[here] = was[: int(random.integers(len(was)))] + "\n"
    else:
        lines[here] = was.rstrip("\n")
    return "".join(lines)


def nested(random: Generator, text: str) -> str:
    """Put lists in lists, thousands deep, in a value's place."""
    return _replaced(random, text, CELL, NESTS)


def several(random: Generator, text: str) -> str:
    """Spoil two to six tokens."""
    for _ in range(int(random.integers(2, 7))):
        text = (number, quoted, cell, word, sign, line)[int(random.integers(6))](random, text)
    return text


TEXT_SPOILS: dict[str, TextSpoil] = {
    each.__name__: each for each in (number, quoted, cell, word, sign, line, nested, several)
}
OFTEN = (number, number, quoted, cell, word, line)


def _replaced(
    random: Generator, text: str, token: re.Pattern[str], instead: tuple[str, ...]
) -> str:
    found = list(token.finditer(text))
    if not found:
        return text + _one_of(random, instead)
    one = found[int(random.integers(len(found)))]
    return text[: one.start()] + _one_of(random, instead) + text[one.end() :]


def _one_of(random: Generator, choices: tuple[str, ...]) -> str:
    return choices[int(random.integers(len(choices)))]
