"""Which satellites a receiver tracks along an orbit, and how well."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from models.arrays import Floats, Mask
from models.gnss.constellation import Constellation
from models.gnss.link_budget import LinkBudget, ReceiveAntenna
from models.gnss.signal_path import OPAQUE_HEIGHT_M, lowest_height_m

CHUNK = 2000  # instants at a time, to bound memory


@dataclass(frozen=True)
class Receiver:
    """A receiver.

    Attributes
    ----------
    antenna : ReceiveAntenna
    sensitivity_dbhz : float, dB-Hz
        Weaker signals are not tracked.
    channels : int
        At most so many satellites, the strongest.
    link : LinkBudget
    """

    antenna: ReceiveAntenna
    sensitivity_dbhz: float
    channels: int = 30
    link: LinkBudget = field(default_factory=LinkBudget)


@dataclass(frozen=True, eq=False)
class Reception:
    """What is tracked at each instant.

    Attributes
    ----------
    times_s : (m,) array, s
    cn0_dbhz : (m, n) array, dB-Hz
    tracked : (m, n) array of bool
    lowest_height_m : (m, n) array, m
        Of the signal's way above the Earth.
    """

    times_s: Floats
    cn0_dbhz: Floats
    tracked: Mask
    lowest_height_m: Floats


def reception(
    receiver: Receiver,
    constellation: Constellation,
    times_s: Floats,
    positions: Floats,
    boresights: Floats,
    sun: Floats,
) -> Reception:
    """Return what a receiver tracks.

    Parameters
    ----------
    receiver : Receiver
    constellation : Constellation
    times_s : (m,) array, s
    positions, boresights : (m, 3) array, m and unit vectors
        Inertial: of the receiver, and where its antenna looks.
    sun : (m, 3) array
        Unit vectors.
    """
    parts = [
        _part(receiver, constellation, times_s[own], positions[own], boresights[own], sun[own])
        for own in _chunks(len(times_s))
    ]
    return Reception(times_s, *(np.concatenate(each) for each in zip(*parts, strict=True)))


def _chunks(count: int) -> Iterator[slice]:
    return (slice(first, min(first + CHUNK, count)) for first in range(0, count, CHUNK))


def _part(
    receiver: Receiver,
    constellation: Constellation,
    times_s: Floats,
    positions: Floats,
    boresights: Floats,
    sun: Floats,
) -> tuple[Floats, Mask, Floats]:
    senders = constellation.states(times_s)[..., :3]
    cn0 = receiver.link.cn0_dbhz(positions, boresights, senders, sun, receiver.antenna)
    height = lowest_height_m(positions[:, None, :], senders)
    heard = (cn0 >= receiver.sensitivity_dbhz) & (height > OPAQUE_HEIGHT_M)
    ranked = np.sort(np.where(heard, cn0, -np.inf), axis=1)[:, ::-1]
    weakest = ranked[:, min(receiver.channels, len(constellation)) - 1]
    return cn0, heard & (cn0 >= weakest[:, None]), height
