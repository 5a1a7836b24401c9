"""What a chain adds to the scene of its page: a cloud of points, axes of one's own, an orbit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from models.arrays import Floats


@dataclass(frozen=True, eq=False)
class OrbitScene:
    """An orbit about the Earth, by frame; what is None is not known.

    Attributes
    ----------
    true_m : sequence of (3,) arrays or None
        Where the satellite truly was, inertial.
    said_m : mapping of str to sequence of (3,) arrays or None
        Where each pipeline said it was.
    senders_m : sequence of (n, 3) arrays or None
        The satellites that were heard.
    """

    true_m: Sequence[Floats | None]
    said_m: Mapping[str, Sequence[Floats | None]]
    senders_m: Sequence[Floats | None]


@dataclass(frozen=True, eq=False)
class SceneAddition:
    """What is drawn besides target, camera and Sun, all by pipeline, of run 0.

    Attributes
    ----------
    true_from_own : mapping of str to (3, 3) array
        Turns a pipeline's own target axes into the true ones, where it has axes of its own.
    clouds : mapping of str to (n, 3) array, m
        Points of the target that it ends with, true axes.
    orbit : OrbitScene or None
        Drawn beside a target, or alone.
    """

    true_from_own: Mapping[str, Floats] = field(default_factory=dict)
    clouds: Mapping[str, Floats] = field(default_factory=dict)
    orbit: OrbitScene | None = None
