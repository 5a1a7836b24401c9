"""Which exposure time each frame has: planned, fixed, or metered from the frame before.

Whatever sets it, a frame's exposure time is public: it stands in ``frames.csv``, and a flight
computer knows it. What is metered follows from the image of the frame before (of a pair the 850 nm
one), so it is the same however often a run was cut: the image lies on the disk.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from models.arrays import Image
from models.dataset.frame_table import FrameEntry
from models.onboard import PosePrior
from renders.world.world import World


class ExposureControl:
    """The rows of ``frames.csv``, all at once or as images come in.

    Parameters
    ----------
    world : World
    prior : PosePrior or None
        Of the run; a planned exposure may rest on it.

    Attributes
    ----------
    entries : list of FrameEntry
        What is known so far, from the first frame on, in true time; it grows where exposures are
        metered.
    """

    def __init__(self, world: World, prior: PosePrior | None) -> None:
        self.world = world
        self.entries = world.frame_entries(prior)
        self.detector = world.scenario.simulated_detector
        self.meter = world.plan.meter

    def resume(self, recorded: Iterable[FrameEntry]) -> None:
        """Take what an earlier run metered; rows of other frames and all after them are left.

        Parameters
        ----------
        recorded : iterable of FrameEntry
            By the clock on board, as ``frames.csv`` has them.
        """
        times_s, clock = self.world.scenario.times_s, self.world.clock(0)
        for index, entry in enumerate(recorded):
            if index < len(self.entries):
                if entry != clock.stamped(self.entries[index]):
                    return
            elif index < len(times_s) and (entry.index, entry.time_s) == (
                index,
                clock.shows(times_s[index]),
            ):
                self.entries.append(replace(entry, time_s=times_s[index]))
            else:
                return

    def entry(self, frame: int, image_of: Callable[[int], Image]) -> FrameEntry:
        """Return a frame's row.

        Parameters
        ----------
        frame : int
        image_of : callable
            Gives the (height, width) image, DN, of a frame before this one, of a pair the 850 nm
            one; asked only for what is not metered yet.
        """
        while len(self.entries) <= frame:
            before = self.entries[-1]
            image = image_of(before.index)
            exposure_ms = self.meter.next_ms(before.exposure_ms, image, self.detector)
            index = before.index + 1
            self.entries.append(FrameEntry(index, self.world.scenario.times_s[index], exposure_ms))
        return self.entries[frame]
