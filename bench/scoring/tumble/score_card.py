"""The shape of what single images add to ``score.json``: dataclasses whose fields are its keys."""

from __future__ import annotations

from dataclasses import dataclass

from bench.scoring.core_score import Sizes


@dataclass(frozen=True)
class StateScore:
    """The filtered state over the frames of run 0.

    Attributes
    ----------
    with_state : int
        Frames with one.
    first_state : int or None
        The frame of the first.
    lost_share : float or None
        Frames from there on whose image gave no pose, over all from there on.
    modes : dict
        Frames by mode.
    position_m, attitude_deg, velocity_m_s, rate_deg_s : Sizes
        Of the filtered state.
    raw_position_m, raw_attitude_deg : Sizes
        Of the image's own pose.
    confusions : dict
        Wrong attitudes by kind.
    nees : dict
        By filter: mean over 6, and the share of frames below the 95 % point.
    """

    with_state: int
    first_state: int | None
    lost_share: float | None
    modes: dict[str, int]
    position_m: Sizes
    attitude_deg: Sizes
    velocity_m_s: Sizes
    rate_deg_s: Sizes
    raw_position_m: Sizes
    raw_attitude_deg: Sizes
    confusions: dict[str, int]
    nees: dict[str, dict[str, float | None]]


@dataclass(frozen=True)
class StartsScore:
    """What came of acquisition tried all over the tumble.

    Attributes
    ----------
    starts, most_images : int
    first_image, within : int
        Right poses from the first image, and within ``most_images``.
    wrong, none : int
        Wrong poses, and starts without one.
    confusions : dict
        Wrong poses by kind.
    position_m, attitude_deg : Sizes
        Of the right ones.
    seconds : Sizes
    reasons : dict
        Of the starts without a pose.
    """

    starts: int
    most_images: int
    first_image: int
    within: int
    wrong: int
    none: int
    confusions: dict[str, int]
    position_m: Sizes
    attitude_deg: Sizes
    seconds: Sizes
    reasons: dict[str, int]


@dataclass(frozen=True)
class CornerScore:
    """How many of the landmarks that an image shows were found, over all frames.

    Of a pipeline that tells of no corners only ``visible`` and ``lit_share`` are known.

    Attributes
    ----------
    repeatability, repeatability_lit, repeatability_dark : float or None
        Share of the visible landmarks with a corner within 3 px; of the sunlit, and of the others.
    rms_px : float or None
        Root mean square distance of those found, per axis.
    precision : float or None
        Those found over all corners.
    detected, visible : float
        Mean numbers a frame; ``detected`` may be None.
    lit_share : float or None
        Of the visible landmarks.
    """

    repeatability: float | None
    repeatability_lit: float | None
    repeatability_dark: float | None
    rms_px: float | None
    precision: float | None
    detected: float | None
    visible: float
    lit_share: float | None


@dataclass(frozen=True)
class Limit:
    """Errors of the image's own pose in frames that are alike in one thing.

    Attributes
    ----------
    of : str
        ``visible landmarks``, ``sunlit share`` or ``corners found``.
    span : list of 2 floats
    frames, poses : int
    position_m, attitude_deg : float or None
        Medians.
    """

    of: str
    span: list[float]
    frames: int
    poses: int
    position_m: float | None
    attitude_deg: float | None
