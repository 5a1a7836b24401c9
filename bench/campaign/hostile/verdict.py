"""Whether a verb stood what it was given: one message or a right answer, and nothing else."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import NoReturn

OUR_WORD = "rvbench: "
MOST_CHARACTERS = 2500
UNPRINTABLE = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
USAGE = ("╭", "error", "usage")
REFUSED_CODES = (1, 2)


class Ended(StrEnum):
    """How a trial ended."""

    REFUSED = "refused"
    ACCEPTED = "accepted"
    FAULT = "fault"


@dataclass(frozen=True)
class Heard:
    """What a verb did.

    Attributes
    ----------
    code : int or None
        Its exit code; None if it had read all and would have begun to work.
    errors : str
        On stderr.
    escaped : str
        An exception that came out of it; empty if none.
    """

    code: int | None
    errors: str
    escaped: str = ""


@dataclass(frozen=True)
class Verdict:
    """How a trial ended, and if in a fault, which."""

    ended: Ended
    fault: str = ""


def judge(heard: Heard, *, never_right: bool, damaged: list[str], written: Path) -> Verdict:
    """Judge a trial.

    Parameters
    ----------
    heard : Heard
    never_right : bool
        Whether the verb had to refuse.
    damaged : list of str
        What it changed and should not have.
    written : Path
        Folder of what it wrote, where JSON must be JSON.
    """
    fault = _fault(heard, damaged, written)
    if fault:
        return Verdict(Ended.FAULT, fault)
    accepted = heard.code in (0, None)
    if accepted and never_right:
        return Verdict(Ended.FAULT, "accepted what cannot be")
    return Verdict(Ended.ACCEPTED if accepted else Ended.REFUSED)


def _fault(heard: Heard, damaged: list[str], written: Path) -> str:
    if heard.escaped:
        return f"escaped: {heard.escaped}"
    if "Traceback (most recent call last)" in heard.errors:
        return f"traceback: {_last_error(heard.errors)}"
    if heard.code not in (None, 0, 1, 2):
        return f"exit code {heard.code}"
    if damaged:
        return f"changed {', '.join(damaged[:3])}"
    if "Warning" in heard.errors:
        line = next(each for each in heard.errors.splitlines() if "Warning" in each)
        return f"warned: {line.strip()}"
    return fault_of_message(heard) or _fault_of_json(written)


def fault_of_message(heard: Heard) -> str:
    """Return what is wrong with the message of a verb that refused; nothing if it is one."""
    if UNPRINTABLE.search(heard.errors.replace("\x1b[", "")) and heard.code == 2:
        return "a message with control characters"
    messages = [each for each in heard.errors.splitlines() if each.startswith(OUR_WORD)]
    if heard.code == 2 and not messages and all(word in heard.errors for word in USAGE[:1]):
        return ""  # the parser of arguments told, in a box
    if heard.code == 2 and len(messages) != 1:
        return f"{len(messages)} messages"
    if heard.code == 2 and heard.errors[heard.errors.index(OUR_WORD) :].strip().count("\n"):
        return "a message of several lines"
    if messages and max(map(len, messages)) > MOST_CHARACTERS:
        return f"a message of {max(map(len, messages))} characters"
    return ""


def _fault_of_json(written: Path) -> str:
    for path in sorted(written.rglob("*.json")):
        try:
            json.loads(path.read_text(), parse_constant=_refused)
        except (ValueError, RecursionError) as error:
            return f"wrote {path.name} that is no JSON: {error}"
    return ""


def _refused(name: str) -> NoReturn:
    raise ValueError(name)


def _last_error(errors: str) -> str:
    lines = [each for each in errors.splitlines() if each and not each.startswith((" ", OUR_WORD))]
    place = next((each.strip() for each in reversed(errors.splitlines()) if 'File "' in each), "")
    return f"{lines[-1] if lines else ''} ({place})"
