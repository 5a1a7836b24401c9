"""How far a rendering is: a bar on a terminal, else plain lines now and then."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from models.progress_lines import ProgressLines
from renders.world.exposure import Exposure

Track = Callable[[Sequence[Exposure], str], Iterable[Exposure]]


@contextmanager
def render_progress(console: Console) -> Iterator[Track]:
    """Yield what walks over exposures and tells how far it is, under a title."""
    if not console.is_terminal:
        yield partial(_lines, console)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as progress:
        yield lambda exposures, title: progress.track(
            exposures, total=len(exposures), description=title
        )


def _lines(console: Console, exposures: Sequence[Exposure], title: str) -> Iterator[Exposure]:
    lines = ProgressLines(title, len(exposures), partial(console.print, soft_wrap=True))
    for exposure in exposures:
        yield exposure
        lines.advance()
