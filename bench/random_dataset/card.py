"""The card of a random dataset: what it holds, what was refused, and what to do with it."""

from __future__ import annotations

from collections import Counter
from importlib.metadata import version

from bench.random_dataset.plan import SPLITS, Plan


def card(plan: Plan, left: int, variant: str) -> str:
    """Return the text of its README.

    Parameters
    ----------
    plan : Plan
    left : int
        Frames that are not there yet.
    variant : str
        That rendered.
    """
    spec = plan.spec
    frames = Counter((shot.part, shot.split) for shot in plan.shots)
    lines = [
        f"# {spec.name}",
        "",
        f"{spec.frames} frames of {spec.poses} poses, {spec.suns_per_pose} Suns a pose, drawn with "
        f"seed {spec.seed}; splits with seed {spec.split.seed}. Rendered by rvbench "
        f"{version('rvbench')}, {variant}.",
    ]
    if left:
        lines += ["", f"{left} frames are not there yet: the same command goes on."]
    else:
        lines += ["", "![Some frames](frames.png)"]
    lines += ["", "![How it is spread](coverage.png)", "", f"| folder | {' | '.join(SPLITS)} |"]
    lines += ["|---|---|---|---|"]
    for part in plan.used:
        counts = " | ".join(str(frames[part.number, split]) for split in SPLITS)
        lines.append(f"| {part.name} | {counts} |")
    lines += ["", "Each folder is a dataset. All of them, with their splits:", ""]
    lines += ["```console", "rvbench export . --as coco --out coco", "```", ""]
    if plan.refused:
        lines += ["| draws that were refused | |", "|---|---|"]
        lines += [f"| {reason} | {count} |" for reason, count in plan.refused.most_common()]
    else:
        lines += ["No draw was refused."]
    return "\n".join(lines) + "\n"
