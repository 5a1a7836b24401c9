"""Figures where they are recorded, shown again with their day: no number is typed twice.

    ```{recorded} README.md
    :table: "root mean square over the last 1000 s"
    :machine: two cores, no GPU
    ```

shows the table whose first line holds that text. The day is that of the last change of any of its
lines, by the repository's history; without one it says so. ``{published}`` shows what
``bench/reference/opromolla2022.toml`` has of the paper's tables.
"""

from __future__ import annotations

import re
import subprocess
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

HOUSE = Path(__file__).resolve().parents[2]
DAY = re.compile(r"\b(\d{4}-\d\d-\d\d)\b")
NOT_KNOWN = "the machine is not recorded"


def table_of(path: Path, text: str) -> tuple[int, list[str]]:
    """Return the table whose first line holds a text, and the number of that line, from 1.

    Raises
    ------
    ValueError
        If there is no such table, or several.
    """
    lines = path.read_text().splitlines()
    starts = [
        place
        for place, line in enumerate(lines)
        if line.startswith("|") and text in line and not lines[place - 1].startswith("|")
    ]
    if len(starts) != 1:
        raise ValueError(f"expected one table with {text!r} in {path.name}, found {len(starts)}")
    end = starts[0]
    while end < len(lines) and lines[end].startswith("|"):
        end += 1
    return starts[0] + 1, lines[starts[0] : end]


def day_of(path: Path, first: int, last: int) -> str | None:
    """Return the day on which lines, counted from 1, were last changed; None if nothing tells."""
    command = ["git", "blame", "--date=short", f"-L{first},{last}", "--", str(path)]
    try:
        done = subprocess.run(command, cwd=HOUSE, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    days = [found[1] for line in done.stdout.splitlines() if (found := DAY.search(line))]
    return max(days, default=None)


class Recorded(SphinxDirective):
    """A table of another file of the house, with its day and its machine."""

    required_arguments = 1
    option_spec: ClassVar[Any] = {
        "table": directives.unchanged_required,
        "machine": directives.unchanged,
    }

    def run(self) -> Sequence[nodes.Node]:
        """Show it."""
        path = HOUSE / self.arguments[0]
        self.env.note_dependency(str(path))
        try:
            first, lines = table_of(path, self.options.get("table", ""))
        except ValueError as error:
            raise self.error(str(error)) from error
        day = day_of(path, first, first + len(lines) - 1)
        told = f"recorded {day}" if day else "the day is not recorded"
        machine = self.options.get("machine", NOT_KNOWN)
        return shown(self, [*lines, "", f"*{path.name}, {told}; {machine}.*"])


class Published(SphinxDirective):
    """Sequences of Opromolla et al. 2022 as printed, from the file that the suite reads."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> Sequence[nodes.Node]:
        """Show the sequences that are named."""
        path = HOUSE / "bench" / "reference" / "opromolla2022.toml"
        self.env.note_dependency(str(path))
        results = tomllib.loads(path.read_text())["results"]
        rows = ["| | mean of tx, ty, tz, cm | std | mean of alpha, beta, gamma, deg | std |"]
        rows.append("|---|---|---|---|---|")
        for name in self.arguments[0].split():
            of = results[name]
            keys = ("mean_t_cm", "std_t_cm", "mean_euler_deg", "std_euler_deg")
            cells = [", ".join(f"{number:g}" for number in of[key]) for key in keys]
            rows.append(f"| {name} | {' | '.join(cells)} |")
        return shown(self, rows)


def shown(directive: SphinxDirective, lines: list[str]) -> Sequence[nodes.Node]:
    """Return lines of Markdown as nodes."""
    holder = nodes.container()
    directive.state.nested_parse(StringList(lines, "recorded"), 0, holder)
    return holder.children


def setup(app: Sphinx) -> dict[str, bool]:
    """Have Sphinx use both."""
    app.add_directive("recorded", Recorded)
    app.add_directive("published", Published)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
