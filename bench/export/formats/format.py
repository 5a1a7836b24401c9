"""What a format is to the exporter: files for each image, then files made of all records."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from bench.export.labels import Label
from bench.export.picture import Picture
from bench.export.plan import Plan
from bench.export.records import Records

Files: TypeAlias = dict[str, bytes]
"""Bytes by path in the export."""
Streamed: TypeAlias = Iterator[tuple[str, Iterable[bytes]]]
"""Paths with their bytes, piece by piece."""


@dataclass
class Findings:
    """What reopening an export came to.

    Attributes
    ----------
    images, objects, keypoints : int
        How many were opened, and how many labels and keypoints held against them.
    reprojection_px : float, px
        The largest distance between a keypoint as written and as projected anew.
    faults : list of str
    """

    images: int = 0
    objects: int = 0
    keypoints: int = 0
    reprojection_px: float = 0.0
    faults: list[str] = field(default_factory=list)


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
        ``finish(records)``: the files that tell of all; those of the images are there by then.
    check : callable
        ``check(folder)``: opens what was written, and tells how much it found.
    refuse : callable
        ``refuse(plan)``: raises ``ScenarioError`` where a plan does not fit the format.
    staged : bool
        Whether ``exposure`` gives files that ``finish`` packs into others, and that go then.
    """

    name: str
    title: str
    bits: int
    exposure: Callable[[Plan, Label, Picture], Files]
    finish: Callable[[Records], Streamed]
    check: Callable[[Path], Findings]
    refuse: Callable[[Plan], None] = lambda plan: None
    staged: bool = False
