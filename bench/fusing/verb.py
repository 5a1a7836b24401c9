"""``rvbench fuse``: the verb with its options."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from tyro.conf import Positional, arg

from bench.verbs import DONE, File, Folder


@dataclass(frozen=True)
class Fuse:
    """Make the poses of both cameras of a chaser with an arm one, frame by frame.

        rvbench run hand.toml --out out/hand
        rvbench run chaser.toml --out out/chaser
        rvbench fuse out/hand out/chaser --out out/fused.jsonl
        rvbench score out/hand --estimates out/fused.jsonl

    Both are datasets of one flight, estimated: the same motion and [arm], but for arm.camera. What
    joints and mount are told wrong by is in the covariance. Where one camera has no pose the other
    speaks for it; where they contradict each other there is none, with a reason. With --over-time
    one state lasts from frame to frame: it learns the arm's errors while both cameras speak, and
    bridges up to 30 s in which neither does.
    """

    hand: Positional[Annotated[Folder, arg(metavar="HAND")]]
    """dataset of the camera in the arm's hand"""
    chaser: Positional[Annotated[Folder, arg(metavar="CHASER")]]
    """dataset of the camera that is fixed to the chaser"""
    out: File
    """file of the estimates, of the hand camera's frames"""
    variant: Annotated[str, arg(metavar="NAME")] = "best"
    """whose estimates"""
    over_time: bool = False
    """carry one state with its rates from frame to frame, in place of one for each frame"""
    origin_m: Annotated[
        tuple[float, float, float] | None, arg(metavar="X Y Z", help_behavior_hint="")
    ] = None
    """origin of HAND's target frame in that of CHASER's, m, where the targets are the user's own"""

    def run(self) -> int:
        """Fuse, and say by whom the frames have their poses."""
        from bench.fusing.fuse import fuse

        fused = fuse(self.hand, self.chaser, self.out, self.variant, self.origin_m, self.over_time)
        for told, count in fused.frames_by.items():
            print(f"{count} frames {told}")
        print(f"estimates: {fused.file}")
        return DONE
