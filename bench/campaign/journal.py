"""What was tried, a line of JSON a trial: a campaign that was ended goes on from there."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

from bench.campaign.grounds import HOUSE, code_of_the_house
from models.errors import StorageError, cause

FAULT = "fault"


@dataclass(frozen=True)
class Tried:
    """A trial.

    Attributes
    ----------
    kind : str
    seed : int
    ended : str
        ``fault``, or a word of its part for a trial that stood.
    fault : str
    kills : int
        That found a verb alive.
    processor_s : float, s
        Of all processes that it took.
    code : str
        What it tried, see ``code_version``.
    """

    kind: str
    seed: int
    ended: str
    fault: str = ""
    kills: int = 0
    processor_s: float = 0.0
    code: str = ""


class Journal:
    """A file of trials, in the order in which they ended.

    Parameters
    ----------
    path : Path
        A last line that was cut, as a campaign was killed, is left out, and its trial done again.

    Raises
    ------
    StorageError
        If there is a file that is none.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            text = path.read_text() if path.exists() else ""
            whole = text[: text.rfind("\n") + 1]
            self.tried = [Tried(**json.loads(line)) for line in whole.splitlines()]
            if whole != text:
                path.write_text(whole)
        except (OSError, ValueError, TypeError) as error:
            raise StorageError(
                f"expected what a campaign has tried in {path}, got: {cause(error)}; move it away, "
                "or choose another --out"
            ) from error
        self.seen = {(each.kind, each.seed) for each in self.tried}

    def keep(self, tried: Tried) -> None:
        """Add a trial, under the version of the code that stands here."""
        tried = Tried(**{**asdict(tried), "code": code_version()})
        self.tried.append(tried)
        self.seen.add((tried.kind, tried.seed))
        with self.path.open("a") as file:
            file.write(json.dumps(asdict(tried)) + "\n")

    def left(self, asked: Iterable[tuple[str, int]]) -> list[tuple[str, int]]:
        """Return the kinds and seeds that have not been tried, by whatever code."""
        return [each for each in asked if each not in self.seen]


@lru_cache(maxsize=1)
def code_version() -> str:
    """Return the commit that stands here, and a hash of the code where it has been changed."""
    commit, changed = _git("rev-parse", "--short", "HEAD"), _git("status", "--porcelain")
    if commit and not changed:
        return commit
    return f"{commit}+{code_of_the_house()[:8]}" if commit else code_of_the_house()[:8]


def _git(*typed: str) -> str:
    try:
        done = subprocess.run(
            ["git", "-C", str(HOUSE), *typed], capture_output=True, text=True, check=False
        )
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
