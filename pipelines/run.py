"""One pipeline through a run of frames."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from time import perf_counter

from models.estimate import Estimate
from models.frame import Frame
from pipelines.chaser_fixed.knowledge import FlightKnowledge
from pipelines.chaser_fixed.options import ChaserFixedOptions
from pipelines.chaser_fixed.pipeline import ChaserFixed


def estimate_frames(
    frames: Iterable[Frame],
    knowledge: FlightKnowledge,
    options: ChaserFixedOptions,
    on_frame: Callable[[Estimate], None] | None = None,
) -> tuple[list[Estimate], dict[int, float]]:
    """Estimate the pose at every frame, in order.

    Parameters
    ----------
    frames : iterable of Frame
        In time; read one at a time.
    knowledge : FlightKnowledge
    options : ChaserFixedOptions
        See ``pipelines.chaser_fixed.options.options_for``.
    on_frame : callable, optional
        Told of every estimate as it is made.

    Returns
    -------
    estimates : list of Estimate
    runtime_ms : dict of int to float
        Milliseconds by frame number, reading not counted.

    Raises
    ------
    DatasetError
        If an image is not of the camera's size.
    """
    pipeline = ChaserFixed(knowledge, options)
    estimates: list[Estimate] = []
    runtime_ms: dict[int, float] = {}
    for frame in frames:
        began = perf_counter()
        estimate = pipeline.process(frame)
        runtime_ms[frame.index] = 1e3 * (perf_counter() - began)
        estimates.append(estimate)
        if on_frame is not None:
            on_frame(estimate)
    return estimates, runtime_ms
