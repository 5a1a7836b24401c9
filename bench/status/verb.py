"""``rvbench status``: the verb with its options."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Annotated

from tyro.conf import FlagCreatePairsOff, Positional, arg

from bench.verbs import DONE, Folder
from models.reading.shown import shown_line


@dataclass(frozen=True)
class Status:
    """Tell what of a folder is done, runs, failed and why, and is left to do.

        rvbench status out/demo
        rvbench status out/suite-pesce2019 --json

    Of what `run`, `render`, `sweep`, `dataset`, `suite` and `export` write, while they write and
    afterwards. It is `running` while a process is at work in the folder, on this machine or, where
    the disk is shared and knows locks, on another; `done`; `failed`, if the last command ended with
    a message; or `stopped`: the command that began it goes on from there.
    """

    folder: Positional[Folder]
    """what one of those verbs wrote"""
    json: Annotated[FlagCreatePairsOff[bool], arg(help_behavior_hint="")] = False
    """print JSON: `state`, `running`, `stages` (each with `done`, `of`, `left`) and `failed`"""

    def run(self) -> int:
        """Print it."""
        from bench.status.readers import status_of

        status = status_of(self.folder)
        if self.json:
            print(json.dumps(status.to_json(), indent=1))
            return DONE
        print(f"{status.folder}: {status.kind} {shown_line(status.name)}: {status.state}")
        for stage in status.stages:
            of = "" if stage.of is None else f" of {stage.of}"
            left = "" if stage.of is None else f", {stage.of - stage.done} left"
            first = f" (first: {shown_line(stage.left[0])})" if stage.left else ""
            print(f"  {stage.name}: {stage.done}{of}{left}{first}")
        for each in status.failed:
            print(f"  failed: {_plain(each['what'])}: {_plain(each['why'])}")
        if status.running is None:
            print("  whether a process is at work cannot be told: this disk knows no locks")
        return DONE


def _plain(text: str) -> str:
    """Return a message whole, on one line and printable."""
    line = " ".join(text.split())
    return line if line.isprintable() else ascii(line)[1:-1]
