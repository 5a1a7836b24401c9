"""Pipelines that a guard has to bear, to be registered by their place."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

from models.estimate import Estimate
from models.frame import Frame
from pipelines.pipeline import RegisteredPipeline

HERE = "tests.support.odd_pipelines"
MADE = "made"  # a file of this name in the folder that is on board, once it was made


def folder(onboard: Any) -> Path:
    """Return where a pipeline may write; a table on board says it."""
    return Path(onboard.tables["odd.toml"]["folder"])


class Loops:
    """It never comes back from frame 0; of others it gives a reason."""

    def process(self, frame: Frame) -> Estimate:
        while frame.index == 0:
            pass
        return Estimate(frame.index, frame.time_s, reason="seen")


def never_made(onboard: Any, variant: str) -> Any:
    """Never return."""
    threading.Event().wait()


def made_once(onboard: Any, variant: str) -> Loops:
    """Refuse to be made a second time."""
    (folder(onboard) / MADE).touch(exist_ok=False)
    return Loops()


class Deaf:
    """After frame 0 nobody takes what is sent: a thread holds the process still."""

    def process(self, frame: Frame) -> Estimate:
        threading.Thread(target=stop_soon, daemon=True).start()
        return Estimate(frame.index, frame.time_s, reason="seen")


def stop_soon() -> None:
    """Stop this process once it has answered; whoever waits for it is to end it."""
    import os
    import signal

    time.sleep(0.5)
    os.kill(os.getpid(), signal.SIGSTOP)


LOOPS = RegisteredPipeline("loops", lambda onboard, variant: Loops(), ("s",))
NEVER_MADE = RegisteredPipeline("never-made", never_made, ("s",))
MADE_ONCE = RegisteredPipeline("made-once", made_once, ("s",))
DEAF = RegisteredPipeline("deaf", lambda onboard, variant: Deaf(), ("s",))
