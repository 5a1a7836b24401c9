"""What is told of a folder: stages, each with how much of it is there, and what went wrong."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

MOST_LEFT = 20  # names that are told; the number tells of all


@dataclass(frozen=True)
class Stage:
    """A part of the work.

    Attributes
    ----------
    name : str
    done : int
    of : int or None
        None where nothing in the folder says how many there will be.
    left : tuple of str
        Names of the first that are not there.
    needed : bool
        Whether the folder is not done without it.
    """

    name: str
    done: int
    of: int | None
    left: tuple[str, ...] = ()
    needed: bool = True

    @property
    def is_done(self) -> bool:
        """Whether all of it is there."""
        return self.of is not None and self.done >= self.of


@dataclass(frozen=True)
class FolderStatus:
    """What is told of a folder.

    Attributes
    ----------
    folder : str
    kind : str
        dataset, sweep, random dataset, suite or export.
    name : str
        Of the case, suite or format.
    running : bool or None
        Whether a process is at work in it; None where its disk knows no locks.
    stages : tuple of Stage
    failed : tuple of dict
        ``what`` and ``why``.
    """

    folder: str
    kind: str
    name: str
    running: bool | None
    stages: tuple[Stage, ...]
    failed: tuple[dict[str, str], ...] = field(default=())

    @property
    def state(self) -> str:
        """Return running, done, failed or stopped."""
        if self.running:
            return "running"
        if all(stage.is_done for stage in self.stages if stage.needed):
            return "done"
        return "failed" if self.failed else "stopped"

    def to_json(self) -> dict[str, Any]:
        """Return all of it, ready for JSON."""
        table = asdict(self)
        for stage, own in zip(table["stages"], self.stages, strict=True):
            stage["left"] = list(own.left)
            stage["is_done"] = own.is_done
        return {"state": self.state, **table}


def stage_of(name: str, wanted: list[str], there: set[str], *, needed: bool = True) -> Stage:
    """Return a stage of things that are told by name.

    Parameters
    ----------
    name : str
    wanted : list of str
    there : set of str
    needed : bool
    """
    left = [each for each in wanted if each not in there]
    return Stage(name, len(wanted) - len(left), len(wanted), tuple(left[:MOST_LEFT]), needed)
