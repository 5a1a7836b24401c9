"""What a format is to the exporter: files for each image, then files made of all records."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from bench.export.labels import Label
from bench.export.picture import Picture
from bench.export.plan import Plan
from bench.export.record import Record

Files: TypeAlias = dict[str, bytes]
"""Bytes by path in the export."""
Streamed: TypeAlias = Iterator[tuple[str, Iterable[bytes]]]
"""Paths with their bytes, piece by piece."""
Records: TypeAlias = Callable[[], Iterator[Record]]
"""Walks all records, in the order of the plan; each is read when it is its turn."""


@dataclass(frozen=True)
class Format:
    """A format.

    Attributes
    ----------
    name : str
    title : str
        What it is, in a few words.
    bits : int
        Of its images unless others are asked for: what its usual readers take.
    exposure : callable
        ``exposure(plan, label, picture)``: the files of one image.
    finish : callable
        ``finish(plan, records, folder)``: the files that tell of all; those of the images are
        there by then.
    check : callable
        ``check(folder, record, plan)``: what is wrong with the files of one record, read back.
    refuse : callable
        ``refuse(plan)``: raises ``ScenarioError`` where a plan does not fit the format.
    staged : bool
        Whether ``exposure`` gives files that ``finish`` packs into others, and that go then.
    """

    name: str
    title: str
    bits: int
    exposure: Callable[[Plan, Label, Picture], Files]
    finish: Callable[[Plan, Records, Path], Streamed]
    check: Callable[[Path, Records], Iterator[str]]
    refuse: Callable[[Plan], None] = lambda plan: None
    staged: bool = False
