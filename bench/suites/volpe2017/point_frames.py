"""Tracks and ranges as the paper simulates them, and with what it leaves to the future.

Each kind of draw has a generator of its own, keyed by seed, run and frame: more false matches leave
all other draws as they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from bench.suites.volpe2017.cases import CAMERA, Case, states_of
from models.arrays import Floats, Mask
from models.camera import Camera, camera_preset
from models.motion.watched_tumble import WatchedState, WatchedTumble
from models.spacecraft.simple_target import inertia_kg_m2, range_to_surface_m
from pipelines.unknown_target.start_guess import StartGuess
from pipelines.unknown_target.tracked_frame import TrackedFrame

NOISE_DRAW, FALSE_DRAW, RANGE_DRAW, START_DRAW = 0x901E, 0xFA15, 0x0A4E, 0x57A7
SIGMA_M, SIGMA_RAD_S = 1.0, float(np.deg2rad(0.1))
SIGMA_KG_M2 = 50.0
TOUCHES_M = 0.01  # a corner lies on the surface


def camera_of() -> Camera:
    """Return the camera of all cases."""
    return camera_preset(CAMERA)


def frames_of(case: Case, seed: int, run: int) -> Iterator[tuple[TrackedFrame, WatchedState]]:
    """Yield what comes in frame after frame, with the truth beside it.

    Parameters
    ----------
    case : Case
    seed, run : int
    """
    for index, state in enumerate(states_of(case)):
        yield frame_of(case, state, index, seed, run), state


def frame_of(case: Case, state: WatchedState, index: int, seed: int, run: int) -> TrackedFrame:
    """Return what comes in at one time.

    Parameters
    ----------
    case : Case
    state : WatchedState
    index : int
        Of the frame.
    seed, run : int
    """
    camera = camera_of()
    true_px = camera.project(state.cam_from_target @ case.points_in_target)
    noise = np.random.default_rng([seed, run, NOISE_DRAW, index]).standard_normal(true_px.shape)
    seen_px = true_px + case.sigma_px * noise
    false = np.random.default_rng([seed, run, FALSE_DRAW, index])
    wrong = false.uniform(size=len(true_px)) < case.false_share
    elsewhere = false.uniform(true_px.min(axis=0), true_px.max(axis=0), true_px.shape)
    seen_px[wrong] = elsewhere[wrong]
    if case.rounded:
        seen_px = np.round(seen_px)
    there = _visible(case)[index] & camera.contains(seen_px)
    distance = _distances(case)[index]
    read: float | None = None
    if np.isfinite(distance) and case.range_finder.due(index, 1.0 / case.step_s):
        draw = np.random.default_rng([seed, run, RANGE_DRAW, index])
        read = case.range_finder.reading(float(distance), draw)
    return TrackedFrame(
        index,
        state.time_s,
        state.R_cam_from_lvlh,
        np.flatnonzero(there),
        seen_px[there],
        np.full(int(there.sum()), case.sigma_told_px),
        read,
        case.range_finder.sigma_m if read is not None else None,
    )


def start_of(motion: WatchedTumble, seed: int, run: int) -> StartGuess:
    """Return a drawn first guess; no guess of the velocity, as in the paper.

    Parameters
    ----------
    motion : WatchedTumble
    seed, run : int
    """
    draw = np.random.default_rng([seed, run, START_DRAW])
    return StartGuess(
        motion.start[:3] + SIGMA_M * draw.standard_normal(3),
        SIGMA_M,
        omega_in_target=motion.omega0_in_target + SIGMA_RAD_S * draw.standard_normal(3),
        sigma_rad_s=SIGMA_RAD_S,
        inertia_kg_m2=inertia_kg_m2() + SIGMA_KG_M2 * np.diag(draw.standard_normal(3)),
        sigma_kg_m2=SIGMA_KG_M2,
    )


@cache
def _visible(case: Case) -> Mask:
    """Return which points are in sight, (frames, points)."""
    times_s = case.times_s
    open_eyed = (times_s < case.hidden_s[0]) | (times_s >= case.hidden_s[1])
    visible = np.repeat(open_eyed[:, None], case.points, axis=1)
    if case.own_shadow:
        for index, state in enumerate(states_of(case)):
            eye = _eye(state)
            away = case.points_in_target - eye
            far = np.linalg.norm(away, axis=1)
            met = [
                range_to_surface_m(eye, ray)
                for ray in np.asarray(away / far[:, None], dtype=np.float64)
            ]
            visible[index] &= np.array(met) > far - TOUCHES_M
    return visible


@cache
def _distances(case: Case) -> Floats:
    """Return the true distances that the range finder is to read, (frames,); NaN for none."""
    if case.range_to == "none":
        return np.full(case.frames, np.nan)
    if case.range_to == "centre":
        return np.array([float(np.linalg.norm(each.rho_in_lvlh)) for each in states_of(case)])
    return np.array(
        [
            range_to_surface_m(_eye(state), state.cam_from_target.rotation[2])
            for state in states_of(case)
        ]
    )


def _eye(state: WatchedState) -> Floats:
    """Return where the camera is in target axes, (3,) m."""
    pose = state.cam_from_target
    return np.asarray(-pose.rotation.T @ pose.translation)
