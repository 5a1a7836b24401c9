"""Ctrl-C: prompt, whatever the process is in, and told truly, verb by verb.

Python sees a signal between two of its own steps; a kernel that traces light, or a pool whose
workers finish what they have in hand, can keep it for many seconds. So a thread of its own waits
for the signal, gives the process a moment to end by itself, and then ends it: files are whole or
absent at every moment, as they are for a run that is killed.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import NoReturn

from models.atomic_file import drop_scratch

INTERRUPTED = 130
GRACE_S = 1.0  # to end by itself
SHOW_CURSOR = "\x1b[?25h"  # a progress bar hides it

GOES_ON = "every file written so far is whole and kept, and the same command goes on from there"
STARTS_OVER = (
    "estimates are written once every frame was seen, so none of these were kept, and what stood "
    "there before still does; the same command starts over"
)
WHAT_IS_KEPT = {
    "run": f"{GOES_ON}; estimates that were not finished start over",
    "render": GOES_ON,
    "sweep": GOES_ON,
    "dataset": GOES_ON,
    "suite": f"{GOES_ON}; what was in hand is done again",
    "estimate": STARTS_OVER,
    "score": "score.json is as it was before, or new and whole",
    "compare": "each file of the comparison is as it was before, or new and whole",
    "report": "report.html is as it was before, or new and whole",
    "view": "nothing was changed",
    "export": GOES_ON,
    "fuse": "the file of estimates is as it was before, or new and whole",
    "inspect": "each file is as it was before, or new and whole",
    "show": "the picture is as it was before, or new and whole",
    "cancel": "what the jobs have done is whole and kept",
    "store": "every entry that was not deleted is whole",
    "status": "nothing was changed",
    "list": "nothing was changed",
    "doctor": "nothing was changed",
    "new": "what was written is whole",
}


def told(verb: str) -> str:
    """Return the message of an interrupted verb."""
    return f"rvbench: interrupted; {WHAT_IS_KEPT.get(verb, 'every file written so far is whole')}"


@contextmanager
def prompt_interrupts(verb: str) -> Iterator[None]:
    """End the process soon after Ctrl-C, with code 130, even where Python does not get to see it.

    Parameters
    ----------
    verb : str
        Whose message is told.
    """
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    before = signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    over = threading.Event()
    threading.Thread(target=_watch, args=(reader, verb, over), daemon=True).start()
    try:
        yield
    finally:
        over.set()
        signal.set_wakeup_fd(before)
        os.close(writer)  # which ends the thread


def leave(code: int) -> NoReturn:
    """End the process at once: what is left to do at its end could take seconds, and writes none.

    A kernel in hand would be waited for, and every library unloaded.
    """
    drop_scratch()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(code)


def _watch(reader: int, verb: str, over: threading.Event) -> None:
    with suppress(OSError):
        while (came := os.read(reader, 1)) and came[0] != signal.SIGINT:
            pass
        if came and not over.wait(GRACE_S):
            _end_now(verb)
        os.close(reader)


def _end_now(verb: str) -> None:
    drop_scratch()
    show = SHOW_CURSOR if os.isatty(2) else ""
    with suppress(OSError):
        os.write(2, f"{show}\n{told(verb)}\n".encode())
    os._exit(INTERRUPTED)
