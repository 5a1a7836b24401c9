"""The other side of ``pipeline_process``: it loads one pipeline and does what it is asked.

What the pipeline prints goes to stderr: stdout is for what ``rvbench`` says.
"""

from __future__ import annotations

import contextlib
import ctypes
import faulthandler
import json
import os
import pickle
import signal
import socket
import sys
import traceback
from pathlib import Path
from time import perf_counter
from typing import Any

from bench.estimating.answer import answer_to_bytes, reason_to_bytes, told
from bench.estimating.channel import Channel, Closed
from models.errors import RvbenchError
from pipelines.pipeline import RegisteredPipeline
from pipelines.registry import is_ours, pipeline_at, registered_pipeline

PARENT_DIED = 1  # PR_SET_PDEATHSIG of prctl(2)
FIRST_TO_GO = "1000"  # where memory runs out, this process goes and the bench stays


def serve(descriptor: int, parent: int) -> None:
    """Do what is asked until nobody asks any more.

    Parameters
    ----------
    descriptor : int
        Of the socket.
    parent : int
        Process id of who asks; with it this process ends.
    """
    _end_with(parent)
    faulthandler.enable()
    channel = Channel(socket.socket(fileno=descriptor))
    with contextlib.suppress(Closed):
        asked = pickle.loads(channel.receive())
        if asked["do"] == "describe":
            channel.send(_described(asked["name"], asked["place"]))
        else:
            _run(channel, asked)


def _end_with(parent: int) -> None:
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(PARENT_DIED, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)
    with contextlib.suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text(FIRST_TO_GO)


def _described(name: str, place: str) -> bytes:
    """Return what a pipeline says of itself, as JSON, or what is wrong with it."""
    try:
        found = _loaded(name, place)
        told_of = {
            "streams": [str(each) for each in found.streams],
            "variants": [
                {
                    "name": str(variant),
                    "label": str(found.labelled(variant)),
                    "settings": str(found.settings_hash(variant)),
                }
                for variant in found.variants
            ],
        }
    except RvbenchError as error:
        return json.dumps({"wrong": str(error)}).encode()
    except (Exception, SystemExit) as error:
        wrong = f"pipeline {name} ({place}): expected it to tell of itself, {_told(error)}"
        return json.dumps({"wrong": wrong}).encode()
    return json.dumps(told_of).encode()


def _loaded(name: str, place: str) -> RegisteredPipeline:
    return registered_pipeline(name) if is_ours(name) else pipeline_at(name, place)


def _run(channel: Channel, asked: dict[str, Any]) -> None:
    try:
        found = _loaded(asked["name"], asked["place"])
        pipeline = found.make(asked["onboard"], asked["variant"])
    except RvbenchError as error:
        channel.send(str(error).encode())
        return
    except (Exception, SystemExit) as error:
        channel.send(_told(error).encode())
        return
    channel.send(b"")
    while True:
        frame = pickle.loads(channel.receive())
        began = perf_counter()
        try:
            said: Any = pipeline.process(frame)
        except (Exception, SystemExit, KeyboardInterrupt) as error:
            answer = reason_to_bytes(_told(error), 1e3 * (perf_counter() - began))
        else:
            answer = answer_to_bytes(said, 1e3 * (perf_counter() - began))
            del said
        channel.send(answer)


def _told(error: BaseException) -> str:
    last = traceback.extract_tb(error.__traceback__)[-1:]
    place = f" ({Path(last[0].filename).name}, line {last[0].lineno})" if last else ""
    return told(error, place)


def main() -> None:
    """Begin as ``pipeline_process`` starts it: a descriptor and a parent follow ``-c``."""
    descriptor, parent = (int(each) for each in sys.argv[1:3])
    sys.argv[:] = ["rvbench"]
    serve(descriptor, parent)
