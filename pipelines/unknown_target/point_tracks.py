"""Which track is which point: tracks are born, lost, found again and given up."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Indices, Mask
from pipelines.unknown_target.observation_rows import Placed
from pipelines.unknown_target.sightings import Sightings

FEW = 8  # observations, below which no point is judged


class PointTracks:
    """Names of points, and tracks that are not yet any.

    Parameters
    ----------
    births : int
        Observations from which on a track is a point.
    """

    def __init__(self, births: int) -> None:
        self._births = births
        self._waiting: dict[int, list[tuple[int, Floats, float]]] = {}
        self._place: dict[int, int] = {}
        self.names: list[int] = []

    @property
    def live(self) -> Mask:
        """(n,) bool array: the points that still go by their track's name."""
        live = np.zeros(len(self.names), dtype=bool)
        live[list(self._place.values())] = True
        return live

    def sort(
        self, frame: int, tracks: Indices, seen: Floats, sigma: Floats
    ) -> tuple[Sightings, Sightings]:
        """Tell the points among the tracks of a frame.

        Parameters
        ----------
        frame : int
            Place among the epochs.
        tracks : (m,) int array
        seen : (m, 2) array
            Undistorted, in units of the focal length.
        sigma : (m,) array

        Returns
        -------
        known : Sightings
            Of points that were there before.
        born : Sightings
            Of new points, with all that was seen of them since they were tracks.
        """
        names = tracks.tolist()
        known = np.array([name in self._place for name in names], dtype=bool)
        places = [self._place[name] for name in names if name in self._place]
        old = Sightings.of([frame] * len(places), places, seen[known], sigma[known])
        rows: list[tuple[int, int, Floats, float]] = []
        for place in np.flatnonzero(~known):
            name = names[place]
            waiting = self._waiting.setdefault(name, [])
            waiting.append((frame, seen[place], float(sigma[place])))
            if len(waiting) >= self._births:
                self._place[name] = len(self.names)
                self.names.append(name)
                rows += [(when, self._place[name], *what) for when, *what in self._waiting.pop(name)]
        columns = list(zip(*rows, strict=True)) or [(), (), (), ()]
        return old, Sightings.of(*columns)

    def give_up(self, points: Indices) -> None:
        """Let the tracks of some points begin anew, as others.

        Parameters
        ----------
        points : (k,) int array
        """
        gone = set(points.tolist())
        self._place = {name: place for name, place in self._place.items() if place not in gone}


def first_places(where: Placed, born: Sightings, points: int) -> Floats:
    """Return where new points are thought to be, (k, 3) m: as far as the centre of mass.

    The median of what each image says by itself stands a false one among them.

    Parameters
    ----------
    where : Placed
    born : Sightings
        ``frame`` counts in ``where``.
    points : int
        How many there were before: theirs are the places up to here.
    """
    depth = where.t_cam_from_target[born.frame, 2]
    in_cam = np.column_stack([born.seen * depth[:, None], depth])
    own = np.einsum(
        "mji,mj->mi",
        where.R_cam_from_target[born.frame],
        in_cam - where.t_cam_from_target[born.frame],
    )
    return np.array(
        [np.median(own[born.who == place], axis=0) for place in range(points, born.who.max() + 1)]
    )
