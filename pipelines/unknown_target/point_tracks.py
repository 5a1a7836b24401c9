"""Which track is which point: tracks are born, lost, found again and given up."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Indices, Mask
from pipelines.unknown_target.observation_rows import Placed
from pipelines.unknown_target.sightings import Sightings

FEW = 8  # observations, below which no point is judged
MOST_WAITING = 24  # sightings of a track that is no point yet; older ones are forgotten


class PointTracks:
    """Names of points, and tracks that are not yet any.

    Parameters
    ----------
    births : int
        Sightings that must agree before a track is a point.
    """

    def __init__(self, births: int) -> None:
        self._births = births
        self._waiting: dict[int, list[tuple[int, Floats, float]]] = {}
        self._place: dict[int, int] = {}
        self._refused: set[int] = set()
        self.names: list[int] = []

    @property
    def live(self) -> Mask:
        """(n,) bool array: the points that still go by their track's name."""
        live = np.zeros(len(self.names), dtype=bool)
        live[list(self._place.values())] = True
        return live

    def sort(self, frame: int, tracks: Indices, seen: Floats, sigma: Floats) -> Sightings:
        """Return the sightings of points; those of other tracks wait.

        Parameters
        ----------
        frame : int
            Place among the epochs.
        tracks : (m,) int array
        seen : (m, 2) array
            Undistorted, in units of the focal length.
        sigma : (m,) array
        """
        names = tracks.tolist()
        known = np.array([name in self._place for name in names], dtype=bool)
        for place in np.flatnonzero(~known):
            if names[place] in self._refused:
                continue
            waiting = self._waiting.setdefault(names[place], [])
            waiting.append((frame, seen[place], float(sigma[place])))
            del waiting[:-MOST_WAITING]
        places = [self._place[name] for name in names if name in self._place]
        return Sightings.of([frame] * len(places), places, seen[known], sigma[known])

    def ripe(self, frame: int) -> tuple[list[int], Sightings]:
        """Return tracks that were seen often enough, lately in a frame, with all of theirs.

        ``who`` of the sightings counts in the tracks returned.
        """
        tracks = [
            name
            for name, waiting in self._waiting.items()
            if waiting[-1][0] == frame and len(waiting) >= self._births
        ]
        rows = [(when, who, *what) for who, name in enumerate(tracks)
                for when, *what in self._waiting[name]]  # fmt: skip
        return tracks, Sightings.of(*(list(zip(*rows, strict=True)) or [(), (), (), ()]))

    def give_birth(self, name: int) -> int:
        """Make a track a point; return its place."""
        del self._waiting[name]
        self._place[name] = len(self.names)
        self.names.append(name)
        return self._place[name]

    def give_births(
        self, tracks: list[int], who: Indices, places: Floats, reach_m: float
    ) -> tuple[Indices, Floats]:
        """Make points of the tracks of which enough sightings agree.

        Returns
        -------
        (m,) int array, (k, 3) array
            The point of each sighting, -1 where it is of none; and the places of the new points, m.

        Parameters
        ----------
        tracks : list of int
            Names.
        who : (m,) int array
            The track of each sighting, a place among the names.
        places : (m, 3) array, m
            Where each has its point.
        reach_m : float, m
            How far apart they may be.
        """
        point, first = np.full(len(who), -1, dtype=np.int64), []
        for place, name in enumerate(tracks):
            of_track = np.flatnonzero(who == place)
            of_track = of_track[agreeing(places[of_track], reach_m)]
            if len(of_track) >= self._births:
                point[of_track] = self.give_birth(name)
                first.append(np.median(places[of_track], axis=0))
        return point, np.array(first).reshape(-1, 3)

    def give_up(self, points: Indices, again: bool = True) -> None:
        """Let the tracks of some points go.

        Parameters
        ----------
        points : (k,) int array
        again : bool
            Whether they begin anew, as others; what slides does not, for it is no place at all.
        """
        gone = set(points.tolist())
        if not again:
            self._refused |= {self.names[place] for place in gone}
        self._place = {name: place for name, place in self._place.items() if place not in gone}


def first_places(where: Placed, seen: Sightings) -> Floats:
    """Return where each sighting has its point, (m, 3) m: as far as the centre of mass.

    Parameters
    ----------
    where : Placed
    seen : Sightings
        ``frame`` counts in ``where``.
    """
    depth = where.t_cam_from_target[seen.frame, 2]
    in_cam = np.column_stack([seen.seen * depth[:, None], depth])
    away = in_cam - where.t_cam_from_target[seen.frame]
    return np.einsum("mji,mj->mi", where.R_cam_from_target[seen.frame], away)


def agreeing(places: Floats, reach_m: float) -> Mask:
    """Return which of some (m, 3) places lie where most of them do, (m,).

    Parameters
    ----------
    places : (m, 3) array, m
        Of one track, sighting by sighting.
    reach_m : float, m
    """
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)
    near = apart < reach_m
    return np.asarray(near[near.sum(axis=1).argmax()])
