"""One pipeline in a process of its own, asked frame by frame.

The process is a new Python with this one's search path: it loads the same house, shares no state,
has no terminal to read or be interrupted from, and ends with this one, however that ends.
"""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import signal
import socket
import subprocess
import sys
from typing import Any

from bench.estimating.answer import MOST_BYTES, Answer, answer_from_bytes
from bench.estimating.channel import Channel, Closed
from models.errors import ScenarioError
from models.frame import Frame
from models.onboard import OnboardKnowledge

START_LIMIT_S = 600.0  # a busy machine imports slowly; who waits so long waits for a hang
END_LIMIT_S = 10.0  # for a process that has closed its end to be gone
PROGRAM = """import json, sys
sys.path[:] = json.loads(sys.argv.pop())
from bench.estimating.pipeline_child import main
main()
"""


class Hung(Exception):
    """It took longer than it may, or its process ended."""


class _Child:
    """A new process that says what it is asked."""

    def __init__(self) -> None:
        ours, theirs = socket.socketpair()
        self.channel = Channel(ours)
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", PROGRAM, str(theirs.fileno()), str(os.getpid()),
                 json.dumps(sys.path)],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=2,
                env={**os.environ, "PYTHONUNBUFFERED": "1"},
                start_new_session=True,
            )  # fmt: skip

    def say(self, message: Any, limit_s: float, what: str) -> None:
        """Hand over anything; see ``hear``."""
        try:
            self.channel.send(pickle.dumps(message), limit_s)
        except TimeoutError as error:
            raise Hung(f"the pipeline took longer than {limit_s:g} s and was ended") from error
        except Closed as error:
            raise Hung(f"the pipeline's process ended while it {what}{self._how()}") from error

    def hear(self, limit_s: float, what: str) -> bytes:
        """Wait for its answer.

        Raises
        ------
        Hung
            If it takes longer than ``limit_s``, or the process has ended.
        """
        try:
            return self.channel.receive(limit_s, MOST_BYTES)
        except TimeoutError as error:
            raise Hung(f"the pipeline took longer than {limit_s:g} s and was ended") from error
        except Closed as error:
            raise Hung(f"the pipeline's process ended while it {what}{self._how()}") from error

    def end(self) -> None:
        """End it and all that it started, however busy they are."""
        self.channel.close()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()

    @property
    def process_id(self) -> int:
        """Of the process."""
        return self._process.pid

    def _how(self) -> str:
        try:
            code = self._process.wait(END_LIMIT_S)
        except subprocess.TimeoutExpired:
            return ""
        if code >= 0:
            return f", with exit code {code}"
        with contextlib.suppress(ValueError):
            return f", by {signal.Signals(-code).name}"
        return f", by signal {-code}"


class PipelineProcess:
    """A pipeline made in a new process.

    Parameters
    ----------
    pipeline : str
        Its name.
    place : str
        Where it stands; see ``pipelines.registry``. Not needed of ours.
    variant : str
    onboard : OnboardKnowledge
    start_limit_s : float, s
        Most that making it may take.

    Raises
    ------
    ScenarioError
        If the pipeline cannot be made from what is on board.
    Hung
        If it does not come to be.
    """

    def __init__(
        self,
        pipeline: str,
        place: str,
        variant: str,
        onboard: OnboardKnowledge,
        start_limit_s: float = START_LIMIT_S,
    ) -> None:
        asked = {
            "do": "run",
            "name": pipeline,
            "place": place,
            "variant": variant,
            "onboard": onboard,
        }
        self._child = _Child()
        try:
            self._child.say(asked, start_limit_s, "was made")
            wrong = self._child.hear(start_limit_s, "was made").decode()
        except BaseException:
            self.end()
            raise
        if wrong:
            self.end()
            raise ScenarioError(f"pipeline {pipeline}: expected it to be made, got: {wrong}")

    @property
    def process_id(self) -> int:
        """Of its process."""
        return self._child.process_id

    def ask(self, frame: Frame, limit_s: float) -> Answer:
        """Have a frame processed.

        Raises
        ------
        Hung
            If it takes longer than ``limit_s``, or the process has ended.
        """
        self._child.say(frame, limit_s, "took a frame")
        message = self._child.hear(limit_s, "took a frame")
        try:
            return answer_from_bytes(message)
        except ValueError as error:
            raise Hung("the pipeline wrote where the bench listens, and was ended") from error

    def end(self) -> None:
        """End the process, however busy it is."""
        self._child.end()


def described(name: str, place: str, limit_s: float = START_LIMIT_S) -> dict[str, Any]:
    """Have a pipeline tell of itself in a process of its own; its code runs nowhere else.

    Parameters
    ----------
    name, place : str
        As ``pipelines.registry`` has them.
    limit_s : float, s

    Returns
    -------
    dict
        ``streams``, and ``variants`` with ``name``, ``label`` and ``settings`` each.

    Raises
    ------
    ScenarioError
        If it cannot be loaded.
    """
    child = _Child()
    try:
        child.say({"do": "describe", "name": name, "place": place}, limit_s, "was loaded")
        table: dict[str, Any] = json.loads(child.hear(limit_s, "was loaded"))
    except (Hung, ValueError) as error:
        raise ScenarioError(
            f"pipeline {name} ({place}): expected it to be loaded, got: {error}; "
            "mend or uninstall its package"
        ) from error
    finally:
        child.end()
    if "wrong" in table:
        raise ScenarioError(table["wrong"])
    return table
