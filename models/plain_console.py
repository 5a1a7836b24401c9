"""A rich console on which text is text: no `[brackets]` of a name are taken for a style."""

from __future__ import annotations

from rich.console import Console


def plain_console(*, stderr: bool = False, width: int | None = None) -> Console:
    """Return a console that prints every text as it is, on stdout or stderr.

    Parameters
    ----------
    stderr : bool
    width : int, optional
        Columns; those of the terminal unless given.
    """
    return Console(stderr=stderr, width=width, markup=False, emoji=False)
