"""How often another pose fitted the dots as well, and how clearly the one said lay ahead."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from bench.scoring.pairs.judged_pairs import JudgedFrame, TrueDataset
from models.estimate import Estimate, NamedState

STATE = "rival_pose"


@dataclass(frozen=True)
class Rivals:
    """Second poses, over all runs.

    Attributes
    ----------
    poses : int
        Frames with a pose.
    from_outline : int
        Of those, with the board's outline in place of dots.
    with_rival : int
        Of those, with another pose that fits the dots as well.
    nearest_deg : float or None, deg
        Least turn from a pose to its rival.
    least_lead : float or None
        By how much the closest rival lay further from the prediction, in sigmas squared.
    rival_was_right : int
        Frames in which the rival lies nearer to the truth than the pose that was said.
    """

    poses: int
    from_outline: int
    with_rival: int
    nearest_deg: float | None
    least_lead: float | None
    rival_was_right: int


def rivals(judged: Sequence[Sequence[JudgedFrame]], truth: TrueDataset, label: str) -> Rivals:
    """Count the second poses that a pipeline reports as the state ``rival_pose``.

    Parameters
    ----------
    judged : sequence of sequences of JudgedFrame
        Run by run.
    truth : TrueDataset
    label : str
        Of the pipeline.
    """
    said = [each for run in judged for each in run if each.estimate.pose is not None]
    pairs = [(each, each.estimate.states[STATE]) for each in said if STATE in each.estimate.states]
    turns = [_turn_deg(each.estimate, rival) for each, rival in pairs]
    leads = [float(rival.values["behind_chi2"]) for _, rival in pairs]
    return Rivals(
        poses=len(said),
        from_outline=sum(each.estimate.mode == "outline" for each in said),
        with_rival=len(pairs),
        nearest_deg=min(turns, default=None),
        least_lead=min(leads, default=None),
        rival_was_right=sum(_is_nearer(each, rival) for each, rival in pairs),
    )


def _turn_deg(said: Estimate, rival: NamedState) -> float:
    assert said.pose is not None
    turn = rival.values["R_cam_from_target"] @ said.pose.cam_from_target.rotation.T
    return float(np.rad2deg(Rotation.from_matrix(turn).magnitude()))


def _is_nearer(each: JudgedFrame, rival: NamedState) -> bool:
    true = each.frame.truth.cam_from_target
    turn = Rotation.from_matrix(rival.values["R_cam_from_target"] @ true.rotation.T).magnitude()
    return each.attitude_deg is not None and float(np.rad2deg(turn)) < each.attitude_deg
