"""What leaves, in which order, and into which split: decided before anything is written.

Splits are those that a dataset brings (``splits.csv``), or else drawn by a recorded seed from
blocks of frames that follow each other, so that a frame and its neighbour, nearly the same, need
not end on both sides; all streams of a frame go together.
An image without any truth goes to none of them: its split is ``unlabelled``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.export.source import Source
from models.dataset.description import Stream
from models.errors import ScenarioError

TRAIN, VAL, TEST, UNLABELLED = SPLITS = ("train", "val", "test", "unlabelled")
DRAWN = SPLITS[:3]
SUM_TOLERANCE = 1e-6
SPLIT_DRAW = 211  # purpose that keys the draw


@dataclass(frozen=True, slots=True)
class Shot:
    """One image that is to leave.

    Attributes
    ----------
    scene : int
        Number of its dataset, from 1.
    frame : int
    stream : str
    split : str
    key : str
        Names it in the export, and nothing else there.
    """

    scene: int
    frame: int
    stream: str
    split: str
    key: str

    @property
    def image_key(self) -> str:
        """What is the same in all streams of a frame."""
        return f"{self.scene:06d}_{self.frame:06d}"


@dataclass(frozen=True, eq=False)
class Plan:
    """All that leaves.

    Attributes
    ----------
    sources : tuple of Source
    shots : tuple of Shot
        By dataset, frame and stream.
    streams : tuple of str
        Names of all image streams.
    object_ids : dict of str to int
        Numbers of the targets, from 1, by name.
    depth_scale_mm : float, mm
        What one step of a 16-bit depth image stands for.
    """

    sources: tuple[Source, ...]
    shots: tuple[Shot, ...]
    streams: tuple[str, ...]
    object_ids: dict[str, int]
    depth_scale_mm: float

    def source(self, shot: Shot) -> Source:
        """Return the dataset of an image."""
        return self.sources[shot.scene - 1]

    def stream(self, shot: Shot) -> Stream:
        """Return the stream of an image."""
        return self.source(shot).dataset.info.stream(shot.stream)

    def image_path(self, shot: Shot) -> Path:
        """Return where an image lies in its dataset."""
        return self.stream(shot).path(self.source(shot).folder, shot.frame)

    @property
    def splits(self) -> tuple[str, ...]:
        """Those that hold images."""
        held = {shot.split for shot in self.shots}
        return tuple(split for split in SPLITS if split in held)

    def suffix(self, stream: str) -> str:
        """Return what tells a stream's files apart; nothing where there is but one."""
        return f"_{stream}" if len(self.streams) > 1 else ""

    def targets(self) -> list[tuple[int, Source]]:
        """Return each target's number and the first dataset that shows it."""
        first: dict[int, Source] = {}
        for source in self.sources:
            first.setdefault(self.object_ids[source.dataset.info.target], source)
        return sorted(first.items())


def make_plan(
    sources: Sequence[Source], shares: tuple[float, float, float], seed: int, block: int
) -> Plan:
    """Decide what leaves.

    Parameters
    ----------
    sources : sequence of Source
    shares : (float, float, float)
        Of train, val and test; they add up to 1.
    seed : int
    block : int
        Frames in a row that stay together.

    Raises
    ------
    ScenarioError
        If the shares do not add up to 1, or targets that differ have the same name.
    """
    if any(not 0.0 <= share <= 1.0 for share in shares) or abs(sum(shares) - 1.0) > SUM_TOLERANCE:
        told = " ".join(f"{share:g}" for share in shares)
        raise ScenarioError(f"expected --split as three shares that add up to 1, got {told}")
    _refuse_namesakes(sources)
    streams = tuple(
        dict.fromkeys(each.name for s in sources for each in s.dataset.info.image_streams)
    )
    many = len(streams) > 1
    shots: list[Shot] = []
    for source in sources:
        drawn = _drawn(source, shares, seed, block)
        for frame in source.dataset.indices:
            for stream in source.dataset.info.image_streams:
                name = stream.path(source.folder, frame).stem
                split = drawn[frame] if name in source.truth.places else UNLABELLED
                key = f"{source.number:06d}_{frame:06d}" + (f"_{stream.name}" if many else "")
                shots.append(Shot(source.number, frame, stream.name, split, key))
    names = dict.fromkeys(source.dataset.info.target for source in sources)
    return Plan(
        sources=tuple(sources),
        shots=tuple(shots),
        streams=streams,
        object_ids={name: number + 1 for number, name in enumerate(names)},
        depth_scale_mm=depth_scale_mm(max((_reach_m(source) for source in sources), default=0.0)),
    )


def depth_scale_mm(farthest_m: float) -> float:
    """Return the smallest of 0.1, 0.2, 0.5, 1, 2, 5, ... mm whose 65535 steps reach so far."""
    least = max(0.1, 1e3 * farthest_m / 65535.0)
    decade = 10.0 ** np.floor(np.log10(least) + 1e-12)
    steps = [decade * factor for factor in (1.0, 2.0, 5.0, 10.0)]
    return float(f"{next(step for step in steps if step >= least * (1.0 - 1e-12)):.6g}")


def _refuse_namesakes(sources: Sequence[Source]) -> None:
    """Refuse datasets whose targets have one name and two shapes: an export knows them by name."""
    first: dict[str, Source] = {}
    for source in sources:
        name = source.dataset.info.target
        other = first.setdefault(name, source)
        if not _same_shape(source, other):
            raise ScenarioError(
                f"expected every dataset of {name} to show the same spacecraft, with the same "
                f"markers and landmarks; {other.folder} and {source.folder} differ: export them "
                "on their own, or give one another name and render it anew"
            )


def _same_shape(one: Source, other: Source) -> bool:
    if one.target is None or other.target is None:
        return one.target is other.target
    pairs = [
        (one.target.keypoints.points_in_target, other.target.keypoints.points_in_target),
        (one.target.vertices, other.target.vertices),
        (one.target.faces, other.target.faces),
    ]
    names = one.target.keypoints.names == other.target.keypoints.names
    return names and all(np.array_equal(mine, theirs) for mine, theirs in pairs)


def _reach_m(source: Source) -> float:
    return source.truth.farthest_m + (source.target.radius_m if source.target else 0.0)


def _drawn(
    source: Source, shares: tuple[float, float, float], seed: int, block: int
) -> dict[int, str]:
    """Return each frame's split: the blocks in a drawn order, cut where the shares end."""
    frames = source.dataset.indices
    if source.splits is not None:
        return {frame: source.splits.get(frame, UNLABELLED) for frame in frames}
    blocks = [frames[start : start + block] for start in range(0, len(frames), block)]
    order = np.random.default_rng([seed, SPLIT_DRAW, source.number]).permutation(len(blocks))
    ends = np.rint(np.cumsum(shares) * len(blocks)).astype(int)
    return {
        frame: DRAWN[int(np.searchsorted(ends, rank, side="right"))]
        for rank, number in enumerate(order)
        for frame in blocks[int(number)]
    }
