"""``best``: all measurements since the start in one least-squares problem, kept up to date.

Nothing disturbs the motion, so that a filter and a batch would say the same if all were linear. It
is not: of depth, rates and inertia the first images know so little that what a filter drops after
each image it has dropped wrongly. Here a new image adds its rows to the normal equations (an arrow,
see ``ArrowEquations``) where they were last linearised, and all images are linearised anew when
there are so many more of them or the estimate has moved. What was linearised last is the same place
for all, so nothing is learned of what cannot be seen, such as the scale of a target without range.

References
----------
Gauss and Newton's iteration with Marquardt's damping, weights as by Holland and Welsch, Robust
Regression Using Iteratively Reweighted Least-Squares, 1977; relinearising as by Kaess et al.,
iSAM, 2008, with elimination of the points first.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.arrays import Floats, Indices
from models.camera import Camera
from pipelines.unknown_target import robust_weights
from pipelines.unknown_target.arrow_equations import ArrowEquations
from pipelines.unknown_target.batch_solution import BatchSolution
from pipelines.unknown_target.descent import Descent, bend, surprise, weights_of
from pipelines.unknown_target.facet_in_sight import facet_in_sight
from pipelines.unknown_target.free_tumble import FreeTumble
from pipelines.unknown_target.hull_planes import HullPlanes
from pipelines.unknown_target.observation_rows import (
    Epochs,
    Placed,
    Rows,
    placed,
    sighting_rows,
)
from pipelines.unknown_target.options import BatchOptions
from pipelines.unknown_target.other_starts import flat, mirrored
from pipelines.unknown_target.outline_memory import OutlineMemory
from pipelines.unknown_target.point_tracks import FEW, PointTracks, first_places
from pipelines.unknown_target.range_rows import hull_sigma_m, range_rows
from pipelines.unknown_target.sightings import Ranges, Sightings, facets_found
from pipelines.unknown_target.start_guess import StartGuess
from pipelines.unknown_target.tracked_frame import TrackedFrame
from pipelines.unknown_target.unknowns import (
    CHART,
    OMEGA,
    SHARED,
    Prior,
    Unknowns,
    within_reach,
)

AHEAD_S = 30.0  # the tumble is followed at least so far beyond the last frame
SETTLED = 0.01  # square of a step in sigmas, below which it is none
MISFIT = 1.6  # sigmas of most sightings, above which they are not explained; of a third false: 1.4
CARVINGS = 2  # of the hull, each followed by a descent
REFUSED = 0.1  # weight below which an observation is refused


class BatchEstimator:
    """One target, followed from the first frame on.

    Parameters
    ----------
    camera : Camera
    mean_motion_rad_s : float, rad/s
        Of the target's circular orbit.
    start : StartGuess
    options : BatchOptions
    """

    def __init__(
        self, camera: Camera, mean_motion_rad_s: float, start: StartGuess, options: BatchOptions
    ) -> None:
        self._camera, self._motion, self._options = camera, mean_motion_rad_s, options
        self._prior = Prior(start, options.inertia_sigma)
        self._tracks = PointTracks(options.births)
        self._at = Unknowns(self._prior.mean.copy(), np.zeros((0, 3)))
        self._equations = self._prior.equations(self._at)
        self._solved = self._equations.solve()
        self._sightings, self._ranges = Sightings.none(), Ranges.none()
        self._outlines = OutlineMemory(camera, options.outline_px, options.gate_sigmas)
        self._frozen: tuple[ArrowEquations, Unknowns] | None = None
        self._epochs: Epochs | None = None
        self._start_s, self._linearised_at = 0.0, 0
        self._looked_at = options.every_frame_until

    def add(self, frame: TrackedFrame) -> None:
        """Take in a frame; its time is after those of all before."""
        self._note(frame)
        epochs, number = self._known_epochs, len(self._known_epochs.times_s) - 1
        if frame.covered is not None and self._options.range_to == "hull":
            self._outlines.add(number, frame.covered)
        if epochs.times_s[-1] > self._tumble.until_s:
            self._linearise()
        seen = self._camera.normalise(frame.points_px)
        sigma = frame.sigma_px / self._camera.fx
        known = self._tracks.sort(number, frame.tracks, seen, sigma)
        self._take_sightings(known)
        self._give_birth(number)
        self._sightings = self._sightings.followed_by(known)
        if frame.range_m is not None and frame.range_sigma_m is not None:
            self._take_range(number, frame.range_m, frame.range_sigma_m, known)
        self._take_outline(number)
        self._solved = self._equations.solve()
        count, options = number + 1, self._options
        if (
            count <= options.every_frame_until
            or count >= options.growth * self._linearised_at
            or count * self._bend(known) > options.bend
        ):
            self._linearise()

    def solution(self) -> BatchSolution:
        """Return what is known by now."""
        last = self._known_epochs.take(slice(-1, None))
        return BatchSolution(
            self._at,
            placed(self._at, self._tumble, last),
            self._equations,
            self._solved,
            self._prior,
            tuple(self._tracks.names),
            self._tracks.live,
            self._options.lost_share,
            self._options.most_sigma_m,
            self._options.shape_sigma_m,
        )

    @property
    def _known_epochs(self) -> Epochs:
        if self._epochs is None:
            raise ValueError("expected a frame before anything is asked")
        return self._epochs

    def _note(self, frame: TrackedFrame) -> None:
        if self._epochs is None:
            self._start_s = frame.time_s
        after_s = frame.time_s - self._start_s
        epoch = Epochs.of(after_s, frame.R_cam_from_lvlh, self._motion)
        if self._epochs is None:
            self._epochs = epoch
            self._tumble = self._followed(self._at)
        elif not after_s > self._epochs.times_s[-1]:
            raise ValueError(f"expected a frame after {self._epochs.times_s[-1]} s, got {after_s}")
        else:
            self._epochs = self._epochs.followed_by(epoch)

    def _followed(self, at: Unknowns) -> FreeTumble:
        epochs = self._known_epochs
        until_s = self._options.growth * float(epochs.times_s[-1]) + AHEAD_S
        first = epochs.R_cam_from_start[0].T
        return FreeTumble(at.shared[OMEGA], at.shared[CHART], first, self._motion, until_s)

    def _placed(self, frames: Indices) -> tuple[Placed, Indices]:
        """Return where the target is at the frames named, each once, and which is whose."""
        own, back = np.unique(frames, return_inverse=True)
        return placed(self._at, self._tumble, self._known_epochs.take(own)), back

    def _take_sightings(self, known: Sightings) -> None:
        """Add the rows of points that are known."""
        if not len(known):
            return
        where, frame = self._placed(known.frame)
        rows = sighting_rows(where, self._at.points, frame, known.who, known.seen, known.sigma)
        sizes = surprise(rows, self._solved)
        young = len(self._known_epochs.times_s) <= 2 * self._options.every_frame_until
        spread = robust_weights.spread(sizes, 2) if young else 1.0
        weights = robust_weights.weights(sizes, self._options.gate_sigmas * spread)
        self._add(rows, weights / self._options.alike_sightings)

    def _bend(self, known: Sightings) -> float:
        if not len(known):
            return 0.0
        where, frame = self._placed(known.frame)
        return bend(where, self._at.points, replace(known, frame=frame), self._solved)

    def _give_birth(self, number: int) -> None:
        """Make points of the tracks whose sightings agree; false ones among them are dropped."""
        tracks, waiting = self._tracks.ripe(number)
        if not tracks:
            return
        where, frame = self._placed(waiting.frame)
        own = Sightings(frame, waiting.who, waiting.seen, waiting.sigma)
        reach_m = self._options.birth_reach * self._prior.point_information**-0.5
        places = first_places(where, own)
        point, first = self._tracks.give_births(tracks, waiting.who, places, reach_m)
        if len(first):
            self._make_room(first)
            kept = point >= 0
            born = Sightings(waiting.frame, point, waiting.seen, waiting.sigma).take(kept)
            rows = sighting_rows(
                where, self._at.points, frame[kept], born.who, born.seen, born.sigma
            )
            sizes = rows.sizes
            gate = self._options.gate_sigmas * robust_weights.spread(sizes, 2)
            weights = robust_weights.weights(sizes, gate)
            self._add(rows, weights / self._options.alike_sightings)
            self._sightings = self._sightings.followed_by(born)
            self._solved = self._equations.solve()

    def _make_room(self, places: Floats) -> None:
        before = len(self._at.points)
        self._at = self._at.with_points(places)
        self._equations.grow(len(places))
        if self._frozen is not None:
            self._frozen[0].grow(len(places))
            self._frozen = self._frozen[0], self._frozen[1].with_points(places)
        prior = self._prior.equations(self._at)
        self._equations.D[before:] += prior.D[before:]
        self._equations.d[before:] += prior.d[before:]

    def _take_range(self, number: int, range_m: float, sigma_m: float, known: Sightings) -> None:
        facet = facet_in_sight(known.seen, known.who)
        plane = (
            self._planes(np.array([number])) if self._outlines.hull_known else HullPlanes.none(1)
        )
        self._ranges = self._ranges.with_one(number, range_m, sigma_m, facet, plane)
        if not len(self._at.points):
            return
        where, place = self._placed(np.array([number, max(int(plane.view[0]), 0)]))
        plane = replace(plane, view=np.where(plane.known, place[1:], plane.view))
        one = replace(self._ranges.take(slice(-1, None)), frame=place[:1], planes=plane)
        for rows in self._range_rows(where, one, self._at):
            sizes = surprise(rows, self._solved)
            weights = robust_weights.weights(sizes, self._options.gate_sigmas)
            self._add(rows, weights / self._options.alike_ranges)

    def _take_outline(self, number: int) -> None:
        """Add the rows of the last frame's outline with those of earlier ones."""
        frames = self._outlines.frames
        if number not in frames[-1:] or not len(self._at.points):
            return
        where, _ = self._placed(frames)
        rows = self._outlines.last_rows(where)
        weights = robust_weights.weights(surprise(rows, self._solved), self._options.gate_sigmas)
        self._add(rows, weights / self._options.alike_outlines)

    def _range_rows(self, where: Placed, ranges: Ranges, at: Unknowns) -> tuple[Rows, Rows]:
        live = self._tracks.live
        spread_m = hull_sigma_m(self._solved, live, self._prior)
        return range_rows(where, ranges, at, live, spread_m, self._options, 1.0 / self._camera.fx)

    def _add(self, rows: Rows, weights: Floats) -> None:
        kept = rows.weighted(weights)
        self._equations.add_rows(kept.by_shared, kept.by_point, kept.error, kept.who)

    def _linearise(self) -> None:
        """Linearise everything anew about the solution; look elsewhere if that explains nothing."""
        if self._options.range_to in ("facet", "hull"):
            self._ranges = facets_found(self._ranges, self._sightings, self._tracks.live)
        best = self._descended(
            self._at.moved(*within_reach(self._solved.shared, self._solved.points))
        )
        if self._options.range_to == "hull":
            best = self._by_hull(best)
        count = len(self._known_epochs.times_s)
        if best.misfit > MISFIT and count >= self._options.growth * self._looked_at:
            self._looked_at = count
            others = (mirrored(best.at, self._known_epochs), flat(best.at, self._prior.mean))
            for start in others:
                other = self._descended(start)
                best = other if other.misfit < best.misfit else best
        weights = weights_of(best.rows, self._options, best.opened)
        self._at, self._tumble = best.at, best.tumble
        self._equations = self._summed(best.at, best.rows, weights)
        self._solved = self._equations.solve()
        self._linearised_at = count
        self._give_up(weights[0] * self._options.alike_sightings)
        self._freeze(best.rows, weights)

    def _by_hull(self, best: Descent) -> Descent:
        """Carve the hull as the target is now placed, read the ranges by it, and go on down."""
        for _ in range(CARVINGS):
            where = placed(best.at, best.tumble, self._known_epochs)
            points = best.at.points[self._tracks.live]
            planes = self._outlines.carve(where, self._ranges.frame, points, best.rows[3])
            self._ranges = replace(self._ranges, planes=planes)
            if not self._outlines.hull_known:
                break
            best = self._descended(best.at)
        return best

    def _planes(self, frames: Indices) -> HullPlanes:
        """Return the outlines' planes at which the beams of some frames enter the hull."""
        if not self._outlines.hull_known:
            return HullPlanes.none(len(frames))
        at = self._at.moved(self._solved.shared, self._solved.points)
        where = placed(self._at, self._tumble, self._known_epochs).moved(self._solved.shared)
        points = at.points[self._tracks.live]
        return self._outlines.planes(where, frames, points)

    def _descended(self, at: Unknowns) -> Descent:
        """Go down from somewhere until nothing moves any more.

        While all is wrong the gates are as wide as errors are; then they close, so that what agrees
        with most is kept and the rest is left out (graduated non-convexity; Blake and Zisserman,
        Visual Reconstruction, 1987).
        """
        damping, opened = 0.0, np.inf
        tumble = self._followed(at)
        if len(self._outlines.frames):
            epochs = self._known_epochs.take(self._outlines.frames)
            self._outlines.pair(placed(at, tumble, epochs))
        rows = self._all_rows(at, tumble)
        for _ in range(self._options.iterations):
            weights = weights_of(rows, self._options, opened)
            equations = self._summed(at, rows, weights)
            solved = equations.damped(damping).solve()
            step = within_reach(solved.shared, solved.points)
            if equations.square(*step) < SETTLED:
                if opened == 1.0:
                    break
                widest = max(robust_weights.spread(r.sizes, r.error.shape[1]) for r in rows)
                opened = max(1.0, 0.5 * min(opened, widest))
                continue
            next_at = at.moved(*step)
            next_tumble = self._followed(next_at)
            next_rows = self._all_rows(next_at, next_tumble)
            if self._cost(next_at, next_rows, weights) <= self._cost(at, rows, weights):
                at, tumble, rows = next_at, next_tumble, next_rows
                damping = 0.1 * damping if damping > 1e-6 else 0.0
            else:
                damping = max(1e-4, 10.0 * damping)
        return Descent(at, tumble, rows, opened, robust_weights.spread(rows[0].sizes, 2))

    def _all_rows(self, at: Unknowns, tumble: FreeTumble) -> tuple[Rows, ...]:
        """Return the rows of all that is not frozen: sightings, ranges, outlines."""
        where = placed(at, tumble, self._known_epochs)
        own = self._sightings
        seen = sighting_rows(where, at.points, own.frame, own.who, own.seen, own.sigma)
        if not len(at.points):
            return seen, *[Rows.none()] * 3
        ranged = (Rows.none(), Rows.none())
        if len(self._ranges):
            ranged = self._range_rows(where, self._ranges, at)
        return seen, *ranged, self._outlines.rows(where.take(self._outlines.frames))

    def _summed(
        self, at: Unknowns, rows: tuple[Rows, ...], weights: list[Floats]
    ) -> ArrowEquations:
        equations = self._prior.equations(at)
        if self._frozen is not None:
            old, there = self._frozen
            equations = equations.plus(
                old.moved(at.shared - there.shared, at.points - there.points)
            )
        for each, own in zip(rows, weights, strict=True):
            kept = each.weighted(own)
            equations.add_rows(kept.by_shared, kept.by_point, kept.error, kept.who)
        return equations

    def _cost(self, at: Unknowns, rows: tuple[Rows, ...], weights: list[Floats]) -> float:
        cost = self._prior.cost(at)
        if self._frozen is not None:
            old, there = self._frozen
            away = at.shared - there.shared, at.points - there.points
            cost += old.square(*away) - 2.0 * float(old.a @ away[0] + np.sum(old.d * away[1]))
        for each, own in zip(rows, weights, strict=True):
            counted = own > 0.0
            cost += float(own[counted] @ np.sum(each.error[counted] ** 2, axis=1))
        return cost if np.isfinite(cost) else np.inf

    def _give_up(self, weights: Floats) -> None:
        """Let go of points of which too much is refused: their tracks were of two points."""
        who, points = self._sightings.who, len(self._at.points)
        seen = np.bincount(who, minlength=points)
        refused = np.bincount(who[weights < REFUSED], minlength=points)
        bad = (seen >= FEW) & (refused > self._options.bad_share * seen) & self._tracks.live
        if bad.any():
            self._tracks.give_up(np.flatnonzero(bad), again=self._options.second_chances)
            self._sightings = self._sightings.take(~bad[who])

    def _freeze(self, rows: tuple[Rows, ...], weights: list[Floats]) -> None:
        """Keep the older half as it was linearised, once there is too much."""
        if len(self._sightings) <= self._options.most_observations or len(weights[0]) != len(
            self._sightings
        ):
            return
        middle = int(np.median(self._sightings.frame))
        old = ArrowEquations.empty(SHARED, len(self._at.points))
        if self._frozen is not None:
            before, there = self._frozen
            old = before.moved(self._at.shared - there.shared, self._at.points - there.points)
        ranged = [self._ranges.frame[: len(each.who)] for each in rows[1:3]]
        for each, own, frame in zip(
            rows[:3], weights[:3], (self._sightings.frame, ranged[0], ranged[1]), strict=True
        ):
            kept = each.weighted(np.where(frame < middle, own, 0.0))
            old.add_rows(kept.by_shared, kept.by_point, kept.error, kept.who)
        self._frozen = old, self._at
        self._sightings = self._sightings.take(self._sightings.frame >= middle)
        self._ranges = self._ranges.take(self._ranges.frame >= middle)
