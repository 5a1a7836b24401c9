"""Verbs in this process, stopped where they would begin to work: all that reads has read by then.

A file that is accepted is worth no minute of rendering: what comes after is held by the campaign's
kills, and by the tests.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any, NoReturn
from unittest.mock import patch

HEAVY = (
    "renders.variant.choice.activate",
    "renders.batches.studio.activate",
    "bench.sweep.stages.activate",
    "bench.sweep.stages.Sweeper.sweep",
    "bench.random_dataset.crew.Crew.work",
    "bench.suites.spread._spread",
    "bench.estimating.tumble.starts.try_starts",
)


class Reached(BaseException):
    """The verb has read everything, and would now work; no ``except Exception`` stops it."""


@contextmanager
def no_heavy_work() -> Iterator[None]:
    """Have verbs raise ``Reached`` where they would render, or do a suite's units."""
    with ExitStack() as patches:
        for name in HEAVY:
            patches.enter_context(patch(name, _reached))
        yield


def _reached(*_: Any, **__: Any) -> NoReturn:
    raise Reached
