"""Progress on stderr, so that results can be piped: a bar on a terminal, else a line at times."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from models.plain_console import plain_console
from models.progress_lines import ProgressLines


@contextmanager
def frame_progress(
    title: str, total: int, console: Console | None = None
) -> Iterator[Callable[[], None]]:
    """Tell how many of ``total`` frames are done; call what it yields after each.

    Parameters
    ----------
    title : str
    total : int
    console : Console, optional
        Where it goes; stderr unless given.
    """
    console = console or plain_console(stderr=True)
    if not console.is_terminal:
        yield ProgressLines(title, total, partial(console.print, soft_wrap=True)).advance
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as progress:
        task = progress.add_task(title, total=total)
        yield lambda: progress.advance(task)
