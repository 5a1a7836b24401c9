"""What a chaser that navigates for itself adds to a score of its target: its own state, honesty."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from bench.scoring.flights.judged_instants import INTEGRITY, JudgedInstant, TrueInstant
from bench.scoring.flights.judged_instants import judged_instant as judged
from bench.scoring.flights.parts import Navigation, Protection
from bench.scoring.flights.parts import integrity as of_levels
from bench.scoring.flights.parts import navigation as of_errors
from bench.scoring.tumble.judged_images import JudgedImage, TrueImages
from models.motion.perturbed_orbit import lvlh_axes
from models.motion.relative_state import relative_state

RELATIVE_PROTECTION = "relative_protection_m"
Runs = Sequence[Sequence[JudgedImage]]


def navigation(judged_images: Runs, truth: TrueImages, label: str) -> Navigation:
    """Summarise the errors of the chaser's own orbit and attitude.

    Parameters
    ----------
    judged_images : sequence of sequences of JudgedImage
        Run by run.
    truth : TrueImages
    label : str
        Of the pipeline.
    """
    return of_errors(_instants(judged_images, truth), truth, label)


def integrity(judged_images: Runs, truth: TrueImages, label: str) -> Protection:
    """Count where the protection levels of the chaser's position held.

    Parameters
    ----------
    judged_images, truth, label : as for ``navigation``
    """
    return of_levels(_instants(judged_images, truth), truth, label)


def relative_integrity(judged_images: Runs, truth: TrueImages, label: str) -> Protection:
    """Count where those of the target's relative position held.

    Parameters
    ----------
    judged_images, truth, label : as for ``navigation``
    """
    errors, levels = [], []
    for each in (image for run in judged_images for image in run):
        state = relative_state(each.estimate)
        told = _relative_level(each)
        if state is None or told is None:
            continue
        was = truth.by_frame[each.estimate.frame].state
        errors.append(np.abs(state.rho_in_lvlh - was.rho_in_lvlh))
        levels.append(told)
    if not levels:
        return Protection(0, 0, None)
    beyond = sum(bool((error > level).any()) for error, level in zip(errors, levels, strict=True))
    return Protection(len(levels), beyond, np.mean(levels, axis=0).tolist())


def frame_rows(judged_images: Runs, truth: TrueImages) -> list[dict[str, Any]]:
    """Return what each frame of run 0 adds: the target's row, and the chaser's errors."""
    chaser = _instants(judged_images[:1], truth)[0]
    return [
        {**image.row(), "along_m": own.along_m, "protection_m": own.protection_m,
         "speed_m_s": own.speed_m_s}
        for image, own in zip(judged_images[0], chaser, strict=True)
    ]  # fmt: skip


def _instants(judged_images: Runs, truth: TrueImages) -> list[list[JudgedInstant]]:
    return [[_instant(image, truth) for image in run] for run in judged_images]


def _instant(image: JudgedImage, truth: TrueImages) -> JudgedInstant:
    """Judge what is said of the chaser; its body keeps to its local frame."""
    was = truth.by_frame[image.estimate.frame]
    position, velocity = was.chaser.position_in_inertial, was.chaser.velocity_in_inertial
    turn = Rotation.from_matrix(lvlh_axes(position, velocity)).as_quat(scalar_first=True)
    return judged(image.run, image.estimate, TrueInstant(was.time_s, position, velocity, turn))


def _relative_level(image: JudgedImage) -> np.ndarray | None:
    states = image.estimate.states
    told = states[INTEGRITY].values.get(RELATIVE_PROTECTION) if INTEGRITY in states else None
    return None if told is None or np.shape(told) != (3,) else np.asarray(told)
