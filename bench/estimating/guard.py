"""A pipeline under guard: whatever it does with a frame, what comes back is an estimate.

One that raises, says what cannot be, or takes longer than it may loses that frame, with the reason.
Other packages' pipelines run in a process of their own, which is ended when it hangs; the pipeline
then starts anew, with no memory, at the next frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from types import TracebackType
from typing import Protocol

from bench.estimating.answer import no_estimate, told, too_much
from bench.estimating.contenders import Contender
from bench.estimating.pipeline_process import Hung, PipelineProcess
from models.dataset.estimates_file import impossible
from models.errors import RvbenchError, ScenarioError
from models.estimate import Estimate
from models.frame import Frame
from models.onboard import OnboardKnowledge
from models.plain_console import plain_console
from pipelines.registry import registered_pipeline

SAME_INSTANT_S = 1e-6
MOST_REASON = 1000


@dataclass(frozen=True, eq=False)
class Said:
    """An estimate, how long it took, and whether the pipeline failed.

    Attributes
    ----------
    estimate : Estimate
    runtime_ms : float, ms
    failed : bool
        It raised, hung or said what cannot be; the estimate has the reason.
    """

    estimate: Estimate
    runtime_ms: float
    failed: bool


class Guarded(Protocol):
    """A pipeline that never fails."""

    def process(self, frame: Frame) -> Said:
        """Take a frame."""
        ...

    def close(self) -> None:
        """End it."""
        ...


class InThisProcess:
    """One of the house's own pipelines; a dataset that it cannot use is the user's to mend.

    Parameters
    ----------
    contender : Contender
    onboard : OnboardKnowledge
    """

    def __init__(self, contender: Contender, onboard: OnboardKnowledge) -> None:
        self._pipeline = registered_pipeline(contender.pipeline).make(onboard, contender.variant)
        self._known = known_points(onboard)

    def process(self, frame: Frame) -> Said:
        """Take a frame.

        Raises
        ------
        RvbenchError
            If the frames are not what the pipeline was made for.
        """
        began = perf_counter()
        try:
            said = self._pipeline.process(frame)
        except RvbenchError:
            raise
        except Exception as error:
            return _failed(frame, told(error), 1e3 * (perf_counter() - began))
        spent_ms = 1e3 * (perf_counter() - began)
        estimate = checked(said, frame, self._known)
        return Said(estimate, spent_ms, failed=estimate is not said)

    def close(self) -> None:
        """Nothing is to be ended."""


class InAnotherProcess:
    """Anybody's pipeline, with a limit on the time that a frame may take.

    Parameters
    ----------
    contender : Contender
    onboard : OnboardKnowledge
    limit_s : float, s

    Raises
    ------
    ScenarioError
        If it cannot be made from what is on board.
    """

    def __init__(self, contender: Contender, onboard: OnboardKnowledge, limit_s: float) -> None:
        self._start: Callable[[], PipelineProcess] = lambda: PipelineProcess(
            contender.pipeline, contender.place, contender.variant, onboard
        )
        self._limit_s = limit_s
        self._known = known_points(onboard)
        self._given_up = ""
        try:
            self.running: PipelineProcess | None = self._start()
        except Hung as hung:
            raise ScenarioError(
                f"pipeline {contender.pipeline}: expected it to be made, got: {hung}"
            ) from hung

    def process(self, frame: Frame) -> Said:
        """Take a frame."""
        began = perf_counter()
        if self.running is None and not self._given_up:
            self._start_again()
        if self.running is None:
            return _failed(frame, self._given_up, 1e3 * (perf_counter() - began))
        try:
            answer = self.running.ask(frame, self._limit_s)
        except Hung as hung:
            self.close()
            return _failed(frame, str(hung), 1e3 * (perf_counter() - began))
        if answer.estimate is None:
            return _failed(frame, answer.reason, answer.runtime_ms)
        estimate = checked(answer.estimate, frame, self._known)
        return Said(estimate, answer.runtime_ms, failed=estimate is not answer.estimate)

    def close(self) -> None:
        """End the process."""
        running, self.running = self.running, None
        if running is not None:
            running.end()

    def _start_again(self) -> None:
        try:
            self.running = self._start()
        except (Hung, RvbenchError) as error:  # once made, it cannot be again: it is given up
            self._given_up = f"the pipeline could not be made again: {error}"


class Guards:
    """Everybody who takes part, under guard; use it as a context.

    One of another package that cannot be made is left out, and told of on stderr; one that was
    asked for by name is an error.

    Parameters
    ----------
    taking_part : list of Contender
    onboard : OnboardKnowledge
    limit_s : float, optional, s
        Most that a frame may take; with one, the house's own run in processes of their own too.
    """

    def __init__(
        self, taking_part: list[Contender], onboard: OnboardKnowledge, limit_s: float | None
    ) -> None:
        self._taking_part, self._onboard, self._limit_s = taking_part, onboard, limit_s
        self.by_label: dict[str, Guarded] = {}

    def __enter__(self) -> dict[str, Guarded]:
        try:
            for each in self._taking_part:
                self._make(each)
            if not self.by_label:
                raise ScenarioError("expected a pipeline that can be made, found none")
        except BaseException:
            self._close()
            raise
        return self.by_label

    def _make(self, contender: Contender) -> None:
        if contender.is_ours and self._limit_s is None:
            self.by_label[contender.label] = InThisProcess(contender, self._onboard)
            return
        limit = DEFAULT_LIMIT_S if self._limit_s is None else self._limit_s
        try:
            made = InAnotherProcess(contender, self._onboard, limit)
        except ScenarioError as error:
            if contender.is_ours or contender.asked:
                raise
            console = plain_console(stderr=True)
            console.print(f"left out: {printable(str(error))}", soft_wrap=True, highlight=False)
            return
        self.by_label[contender.label] = made

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._close()

    def _close(self) -> None:
        for guarded in self.by_label.values():
            guarded.close()


DEFAULT_LIMIT_S = 60.0


def checked(said: object, frame: Frame, known: int | None = None) -> Estimate:
    """Return an estimate if it is one of a frame and can be; else that the frame is lost.

    Parameters
    ----------
    said : object
    frame : Frame
    known : int, optional
        How many markers or landmarks there are to name.
    """
    if not isinstance(said, Estimate):
        return lost(frame, no_estimate(said))
    if much := too_much(said):
        return lost(frame, much)
    wrong = impossible(said)
    if wrong is not None:
        return lost(frame, f"the pipeline said what cannot be: {wrong}")
    if said.frame != frame.index or not math.isclose(
        said.time_s, frame.time_s, rel_tol=0.0, abs_tol=SAME_INSTANT_S
    ):
        return lost(
            frame,
            f"the pipeline spoke of frame {said.frame} at {said.time_s} s, "
            f"not of {frame.index} at {frame.time_s} s",
        )
    highest = max(said.detected.marker, default=-1)
    if known is not None and highest >= known:
        return lost(frame, f"the pipeline named the marker {highest}, there are {known}")
    return said


def known_points(onboard: OnboardKnowledge) -> int | None:
    """Return how many markers or landmarks a detection may name; None where none are known."""
    counts = [len(each) for each in (onboard.markers, onboard.wireframe) if each is not None]
    return max(counts, default=None)


def lost(frame: Frame, reason: str) -> Estimate:
    """Return that a frame is lost, and why."""
    return Estimate(frame.index, frame.time_s, reason=printable(reason)[:MOST_REASON])


def _failed(frame: Frame, reason: str, spent_ms: float) -> Said:
    return Said(lost(frame, reason), spent_ms, failed=True)


def printable(text: str) -> str:
    """Return text in one line."""
    return "".join(each if each.isprintable() else " " for each in text)
