"""What is spoilt, and which verb is asked to read it."""

from __future__ import annotations

from dataclasses import dataclass, field

OUT = "made"
"""Folder of a trial into which verbs are asked to write."""


@dataclass(frozen=True)
class Kind:
    """A format, or a folder of ours that a verb goes on in.

    Attributes
    ----------
    name : str
        As in ``--only``.
    ground : str
        Folder of the grounds, of which a trial has a copy.
    files : tuple of str
        Patterns of the files to spoil, one of them in a trial.
    commands : tuple of tuple of str
        What may be typed, of which a trial types one; ``{file}`` is the spoilt file.
    ours : tuple of str
        Patterns of what the verb may change beside ``OUT``: only what rvbench made.
    needed : bool
        Whether the verb cannot do without the file: a pipe in its place is refused.
    share : float
        Of all trials, against 1 of the others.
    full : bool
        Whether its ground takes a minute to make, and only the whole campaign has it.
    """

    name: str
    ground: str
    files: tuple[str, ...]
    commands: tuple[tuple[str, ...], ...]
    ours: tuple[str, ...] = ()
    needed: bool = False
    share: float = 1.0
    full: bool = False
    beside: tuple[str, ...] = field(default=())
    """Other grounds that the command reads, copied beside, too."""
