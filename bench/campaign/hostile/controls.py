"""Nothing spoilt: what a kind types must be accepted, or its trials end for another reason."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from bench.campaign.hostile.kinds import COMMAND_LINE, KINDS
from bench.campaign.hostile.trial import hear, lay_out, typed_of
from bench.campaign.hostile.typed import LINES
from models.errors import RvbenchError


def check_controls(grounds: Path, folder: Path, only: str | None, *, full: bool) -> None:
    """Have every command line of the campaign read what is right.

    Parameters
    ----------
    grounds : Path
    folder : Path
        Made anew for each, and left as it is.
    only : str, optional
        The only kind.
    full : bool
        With the kinds whose ground takes a minute to make.

    Raises
    ------
    RvbenchError
        If one is not accepted.
    """
    chosen = [kind for kind in KINDS if (full or not kind.full) and only in (None, kind.name)]
    rows = [(kind.name, typed) for kind in chosen for typed in _lines_of(kind.name, grounds)]
    if only in (None, COMMAND_LINE):
        rows += [(COMMAND_LINE, list(line)) for line in LINES]
    for name, typed in rows:
        heard = hear(typed, lay_out(name, grounds, folder))
        if heard.code not in (0, None) or heard.escaped:
            raise RvbenchError(
                f"expected `rvbench {' '.join(typed)}` of {name} to be accepted while nothing is "
                f"spoilt, got: {heard.escaped or heard.errors.strip()}"
            )


def _lines_of(name: str, grounds: Path) -> Iterator[list[str]]:
    """Return a kind's command lines, those that name a file once for each of its files."""
    kind = next(kind for kind in KINDS if kind.name == name)
    ground = grounds / kind.ground
    files = sorted({str(p.relative_to(grounds)) for each in kind.files for p in ground.glob(each)})
    told = set[tuple[str, ...]]()
    for number in range(len(kind.commands)):
        for file in files:
            typed = typed_of(kind, file, number)
            if tuple(typed) not in told:
                told.add(tuple(typed))
                yield typed
