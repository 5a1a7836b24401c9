"""What there is to be seen: the target, and a chaser where it is near enough to matter.

The render world is the target frame: the target stands still in it, the chaser goes where the
camera goes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from models.spacecraft.part import Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics


@dataclass(frozen=True, eq=False)
class Bodies:
    """The spacecraft of a scene, built when first asked for: that takes two seconds.

    Attributes
    ----------
    make_target : callable
        Gives the target, in the target frame.
    optics : RetroreflectorOptics
        What its markers return.
    make_chaser : callable, optional
        Gives the chaser, in the camera's frame; None where it is too far off to matter.
    """

    make_target: Callable[[], Spacecraft]
    optics: RetroreflectorOptics
    make_chaser: Callable[[], Spacecraft] | None = None

    @cached_property
    def target(self) -> Spacecraft:
        """The target, in the target frame."""
        return self.make_target()

    @cached_property
    def chaser(self) -> Spacecraft | None:
        """The chaser, in the camera's frame."""
        return None if self.make_chaser is None else self.make_chaser()
