"""One pipeline in a process of its own, asked frame by frame."""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
import traceback
from dataclasses import dataclass
from multiprocessing.connection import Connection
from time import perf_counter
from typing import Any

from models.errors import ScenarioError
from models.frame import Frame
from models.onboard import OnboardKnowledge
from pipelines.registry import registered_pipeline

START_LIMIT_S = 600.0  # a busy machine imports slowly; who waits so long waits for a hang
LAST_WORDS = 300


class Hung(Exception):
    """It took longer than it may, or its process ended."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What came back.

    Attributes
    ----------
    said : object
        What the pipeline returned, or text: why it returned nothing.
    runtime_ms : float, ms
    over : bool
        Whether the pipeline cannot go on.
    """

    said: Any
    runtime_ms: float
    over: bool = False


class PipelineProcess:
    """A pipeline made in a new process.

    Parameters
    ----------
    pipeline, variant : str
    onboard : OnboardKnowledge

    Raises
    ------
    ScenarioError
        If the pipeline cannot be made from what is on board.
    Hung
        If it does not come to be.
    """

    def __init__(self, pipeline: str, variant: str, onboard: OnboardKnowledge) -> None:
        context = multiprocessing.get_context("spawn")
        self._ours, theirs = context.Pipe()
        self._process = context.Process(
            target=_serve, args=(theirs, pipeline, variant, onboard), daemon=True
        )
        self._process.start()
        theirs.close()
        made = self._answer(START_LIMIT_S, "made itself")
        if made.said is not None:
            self.end()
            raise ScenarioError(f"pipeline {pipeline}: expected it to be made, {made.said}")

    def ask(self, frame: Frame, limit_s: float) -> Answer:
        """Have a frame processed.

        Raises
        ------
        Hung
            If it takes longer than ``limit_s``, or the process has ended.
        """
        try:
            self._ours.send(frame)
        except OSError as error:
            raise Hung("the pipeline's process ended") from error
        return self._answer(limit_s, "took a frame")

    def end(self) -> None:
        """End the process, however busy it is."""
        self._process.kill()
        self._process.join()
        self._ours.close()

    def _answer(self, limit_s: float, what: str) -> Answer:
        try:
            if not self._ours.poll(limit_s):
                raise Hung(f"the pipeline took longer than {limit_s:g} s and was ended")
            answer: Answer = self._ours.recv()
        except (EOFError, OSError) as error:
            raise Hung(f"the pipeline's process ended while it {what}") from error
        return answer


def _serve(connection: Connection, name: str, variant: str, onboard: OnboardKnowledge) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is its parent's to act on
    try:
        pipeline = registered_pipeline(name).make(onboard, variant)
        connection.send(Answer(None, 0.0))
    except Exception as error:
        connection.send(Answer(_told(error), 0.0, over=True))
        return
    with contextlib.suppress(EOFError, OSError):  # the parent is done with it
        while True:
            frame = connection.recv()
            began = perf_counter()
            try:
                said: Any = pipeline.process(frame)
            except Exception as error:
                said = _told(error)
            spent_ms = 1e3 * (perf_counter() - began)
            try:
                connection.send(Answer(said if said is not None else "it said nothing", spent_ms))
            except (TypeError, ValueError, AttributeError) as error:  # what cannot be pickled
                connection.send(Answer(f"the pipeline's answer cannot be sent: {error}", spent_ms))


def _told(error: BaseException) -> str:
    last = traceback.extract_tb(error.__traceback__)[-1:]
    place = f" ({last[0].name}, line {last[0].lineno})" if last else ""
    return f"the pipeline raised {type(error).__name__}: {str(error)[:LAST_WORDS]}{place}"
