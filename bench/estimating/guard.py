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

from bench.estimating.contenders import Contender
from bench.estimating.pipeline_process import Hung, PipelineProcess
from models.dataset.estimates_file import impossible
from models.errors import RvbenchError
from models.estimate import Estimate
from models.frame import Frame
from models.onboard import OnboardKnowledge

SAME_INSTANT_S = 1e-6


@dataclass(frozen=True, eq=False)
class Said:
    """An estimate, and how long it took, ms."""

    estimate: Estimate
    runtime_ms: float


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
        self._pipeline = contender.registered.make(onboard, contender.variant)

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
            said = _lost(frame, f"the pipeline raised {type(error).__name__}: {error}")
        spent_ms = 1e3 * (perf_counter() - began)
        return Said(checked(said, frame), spent_ms)

    def close(self) -> None:
        """Nothing is to be ended."""


class InAnotherProcess:
    """Anybody's pipeline, with a limit on the time that a frame may take.

    Parameters
    ----------
    contender : Contender
    onboard : OnboardKnowledge
    limit_s : float, s
    """

    def __init__(self, contender: Contender, onboard: OnboardKnowledge, limit_s: float) -> None:
        self._start: Callable[[], PipelineProcess] = lambda: PipelineProcess(
            contender.pipeline, contender.variant, onboard
        )
        self._limit_s = limit_s
        self._running: PipelineProcess | None = None

    def process(self, frame: Frame) -> Said:
        """Take a frame."""
        began = perf_counter()
        try:
            if self._running is None:
                self._running = self._start()
            answer = self._running.ask(frame, self._limit_s)
        except Hung as hung:
            self.close()
            return Said(_lost(frame, str(hung)), 1e3 * (perf_counter() - began))
        if isinstance(answer.said, str):
            if answer.over:
                self.close()
            return Said(_lost(frame, answer.said), answer.runtime_ms)
        return Said(checked(answer.said, frame), answer.runtime_ms)

    def close(self) -> None:
        """End the process."""
        if self._running is not None:
            self._running.end()
            self._running = None


class Guards:
    """Everybody who takes part, under guard; use it as a context.

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
        self.by_label: dict[str, Guarded] = {}
        for each in taking_part:
            if each.is_ours and limit_s is None:
                self.by_label[each.label] = InThisProcess(each, onboard)
            else:
                limit = DEFAULT_LIMIT_S if limit_s is None else limit_s
                self.by_label[each.label] = InAnotherProcess(each, onboard, limit)

    def __enter__(self) -> dict[str, Guarded]:
        return self.by_label

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for guarded in self.by_label.values():
            guarded.close()


DEFAULT_LIMIT_S = 60.0


def checked(said: object, frame: Frame) -> Estimate:
    """Return an estimate if it is one of a frame and can be; else that the frame is lost."""
    if not isinstance(said, Estimate):
        return _lost(frame, f"the pipeline said {said!r:.100}, which is no Estimate")
    if said.frame != frame.index or not math.isclose(
        said.time_s, frame.time_s, rel_tol=0.0, abs_tol=SAME_INSTANT_S
    ):
        return _lost(
            frame,
            f"the pipeline spoke of frame {said.frame} at {said.time_s} s, "
            f"not of {frame.index} at {frame.time_s} s",
        )
    wrong = impossible(said)
    return said if wrong is None else _lost(frame, f"the pipeline said what cannot be: {wrong}")


def _lost(frame: Frame, reason: str) -> Estimate:
    printable = "".join(each if each.isprintable() else " " for each in reason)
    return Estimate(frame.index, frame.time_s, reason=printable[:1000])
