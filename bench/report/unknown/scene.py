"""What the scene of an unknown target shows: the points found, in the true axes."""

from __future__ import annotations

from bench.chains.chain import EstimatesByPipeline
from bench.estimating.runs import Run
from bench.pictures.frame_record import FrameRecords
from bench.report.scene_addition import SceneAddition
from bench.scoring.unknown.judged_unknown import judge_run, read_true_unknown, true_unknown
from bench.scoring.unknown.parts import last_cloud


def scene(records: FrameRecords, estimates: EstimatesByPipeline) -> SceneAddition:
    """Return each pipeline's last cloud and the turn of its axes; nothing without a truth half.

    Parameters
    ----------
    records : FrameRecords
    estimates : mapping of str to mapping of int to Estimate
        Of run 0, by pipeline.
    """
    if not true_unknown(records.dataset):
        return SceneAddition()
    truth, turns, clouds = read_true_unknown(records.dataset), {}, {}
    for label, said in estimates.items():
        judged = judge_run(Run(0, label, dict(said), {}), truth)
        turn, cloud = judged[0].true_from_own, last_cloud(judged)
        if turn is not None:
            turns[label] = turn
        if cloud is not None:
            clouds[label] = cloud[0]
    return SceneAddition(true_from_own=turns, clouds=clouds)
