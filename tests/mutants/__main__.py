"""``make mutants``: put slips into our numeric code, one at a time, and see whether a test notices.

The checkout is left alone: all of it happens in a copy below the output folder.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro
from rich import box
from rich.console import Console
from rich.table import Table

from tests.mutants.harmless import EQUIVALENT, HOLE, JUDGEMENT, kind_of, read_harmless
from tests.mutants.in_copy import SURVIVED


@dataclass(frozen=True)
class Mutants:
    """Draw mutants of numeric code by a seed and try each against the tests that reach its line.

    What was tried is not tried again: the same call goes on. Exit code 1 below the score asked for.
    """

    rooms: tuple[str, ...] = ("models", "pipelines", "renders", "bench/scoring")
    """folders whose code is changed; of renders only what does not itself call the renderer"""
    tests: tuple[str, ...] = (
        "tests/models", "tests/pipelines", "tests/bench/scoring", "tests/physics", "tests/renders",
    )  # fmt: skip
    """folders whose tests judge"""
    count: int = 400
    """mutants"""
    seed: int = 0
    """of the draw"""
    most_s: float = 20.0
    """seconds of processor time of tests for a mutant; the dearest are left out"""
    most_file_s: float = 40.0
    """seconds of processor time for a file of tests while it is learned what they reach"""
    workers: int = 2
    """mutants at once"""
    again: bool = False
    """try survivors again, after tests were written"""
    least: float = 0.9
    """share that must be killed of all that is no proven equivalent or listed judgement"""
    out: Path = Path("out/mutants")
    """copy of the checkout, what tests reach, and a file of results for each seed"""

    def run(self) -> int:
        """Do it; return the exit code."""
        home, out = Path.cwd(), self.out.resolve()
        tree = out / "tree"
        _copy_checkout(home, tree)
        asked = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "least"}
        environment = {
            **os.environ,
            "PYTHONPATH": str(tree),
            "PYTHONPYCACHEPREFIX": str(out / "pycache"),
            "CI": "1",  # the same examples from one run to the next
            "OPENBLAS_NUM_THREADS": "1",
        }
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        told = json.dumps({**asked, "out": str(out)})
        command = [sys.executable, "-m", "tests.mutants.in_copy", told]
        done = subprocess.run(command, cwd=tree, env=environment, check=False)
        if done.returncode:
            return 2
        return report(read_results(out / f"seed-{self.seed}.jsonl")[-self.count :], self.least)


def read_results(path: Path) -> list[dict[str, Any]]:
    """Return the last result of each mutant of a file."""
    rows = map(json.loads, path.read_text().splitlines())
    return list({row["name"]: row for row in rows}.values())


def report(results: Sequence[dict[str, Any]], least: float) -> int:
    """Print every survivor that is a hole, a table by folder, and the score.

    Parameters
    ----------
    results : sequence of dict
    least : float
        Score, from 0 to 1, below which the exit code is 1.
    """
    console, harmless = Console(soft_wrap=True), read_harmless()
    rows = dict[str, Counter[str]]()
    for each in results:
        fate = kind_of(each, harmless) if each["fate"] in SURVIVED else "killed"
        for folder in ("/".join(Path(each["file"]).parts[:2]), "all"):
            rows.setdefault(folder, Counter())[fate] += 1
        if fate == HOLE:
            print(f"{each['file']}:{each['line']}: {each['slip']}, {each['fate']}")
            print(f"  - {each['before']}\n  + {each['after']}")
    table = Table(box=box.SIMPLE)
    for place, title in enumerate(("", "tried", "killed", EQUIVALENT, JUDGEMENT, HOLE, "score, %")):
        table.add_column(title, justify="right" if place else "left")
    for folder, own in sorted(rows.items(), key=lambda row: (row[0] == "all", row[0])):
        counted = [own[fate] for fate in ("killed", EQUIVALENT, JUDGEMENT, HOLE)]
        cells = [own.total(), *counted, f"{100.0 * score(own):.1f}"]
        table.add_row(folder, *map(str, cells))
    console.print(table)
    return int(score(rows.get("all", Counter())) < least)


def score(fates: Counter[str]) -> float:
    """Return the share killed of those that a test could kill."""
    counted = fates["killed"] + fates[HOLE]
    return fates["killed"] / counted if counted else 1.0


def _copy_checkout(home: Path, tree: Path) -> None:
    """Copy what git knows and what it does not ignore; what is as it was keeps its time."""
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=home, check=True, capture_output=True).stdout
    wanted = {name.decode() for name in names.split(b"\0") if name}
    for path in tree.rglob("*.py"):
        if str(path.relative_to(tree)) not in wanted:
            path.unlink()
    for name in wanted:
        if (home / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(home / name, tree / name)


if __name__ == "__main__":
    sys.exit(tyro.cli(Mutants, prog="python -m tests.mutants").run())
