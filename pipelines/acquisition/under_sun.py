"""Poses that an image allows under a Sun that is known, the likeliest first.

Views are told apart by what shines in them; the likeliest are laid on the image's edges, and so are
their twins, half a turn about each axis of the target away; each is held against the image's light
and against the edges at which a step in brightness is due. Nothing is decided here: rivals go on
into the next image (``pipelines.acquisition.rivals``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from models.arrays import Floats, Image
from models.camera import Camera
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.brightness_search import FULL_DN, THIN_POINTS, BrightnessSearch
from pipelines.acquisition.candidate import Candidate
from pipelines.acquisition.daylight import Daylight
from pipelines.acquisition.image_part import cut_out, lit_extent_rad, phase_rad
from pipelines.acquisition.light_likelihood import (
    ImageLight,
    ToldLight,
    brightness,
    explained,
    image_light,
    preference,
    shading,
    told_light,
)
from pipelines.acquisition.light_placing import coarse_light, placed
from pipelines.acquisition.lit_edges import LitEdges
from pipelines.acquisition.sunlit_views import (
    SeenViews,
    SunlitViews,
    even_views,
    search_sunlit_views,
    seen_views,
    sunlit_views,
)
from pipelines.acquisition.surface_cloud import kept_shadows, shape_of, surface_cloud
from pipelines.acquisition.under_sun_options import UnderSunOptions
from pipelines.tracking.edge_fit import EdgeImage, fit_edges, search_steps
from pipelines.tracking.model_edges import ModelEdges
from pipelines.tracking.pose_check import check_pose

NEAR_RADII, FAR_RADII = 3.5, 6.0  # ranges from which views are made, for their perspective
NEAR_BEYOND = 0.43  # of the range: what shines is wider across only of a near target
RANGE_SLACK = 1.25  # beyond the coarse range that is known
PHASE_STEP_DEG = 2.0  # templates of a phase angle serve all within this
NEAR_PX = 2.0  # an edge this near to its step is found,
SHARP_SHARE, SHARP_PX = 0.01, (0.5, 1.2)  # and counts by how near: in this share of the radius
SPARSE_POINTS, ROUGH_CELLS = 5_000, 2.0  # of a cloud for cells so much larger
POLISH_RAD, POLISH_ASIDE, POLISH_RANGE = 0.09, 0.04, 0.04  # rad, radii, of the range
POLISHED_REACH_PX = 5.0
POLISH_WORK = 1.2
SATURATES = 0.98  # of the way to the converter's or the well's end
FEWEST_DUE = 12  # samples of edges: fewer tell nothing
TEMPLATE_WORK, SEARCH_WORK, PLACE_WORK, LIGHT_WORK, FIT_WORK = 14.0, 6.0, 0.05, 0.15, 1.0  # in fits


@dataclass(frozen=True, eq=False)
class Looked:
    """What an image allows.

    Attributes
    ----------
    image : EdgeImage
        Cut out and with its edges.
    light : ImageLight or None
    candidates : tuple of Candidate
        Different poses, the likeliest first.
    reason : str
        Why there is none; empty where there is one.
    work : float
        That it took, in fits.
    """

    image: EdgeImage
    light: ImageLight | None
    candidates: tuple[Candidate, ...]
    reason: str
    work: float


def make_views(wireframe: Wireframe, options: UnderSunOptions) -> None:
    """Look at a target from all around, once for all: what is loaded before flight.

    Parameters
    ----------
    wireframe : Wireframe
    options : UnderSunOptions
    """
    shape = shape_of(wireframe)
    for rung in (NEAR_RADII, FAR_RADII):
        even_views(seen_views(shape, rung, options.directions))
    if wireframe.finish is not None:
        kept_shadows(surface_cloud(shape, THIN_POINTS))


class UnderSun:
    """Looks for one target; its views are made at the first image, unless ``make_views`` did.

    Parameters
    ----------
    wireframe : Wireframe
    camera : Camera
    detector : Detector or None
    options : UnderSunOptions
    range_m : (float, float), optional, m
        Nearest and farthest, if known.
    """

    def __init__(
        self,
        wireframe: Wireframe,
        camera: Camera,
        detector: Detector | None,
        options: UnderSunOptions,
        range_m: tuple[float, float] | None = None,
    ) -> None:
        self._wireframe, self._camera, self._detector = wireframe, camera, detector
        self._options = options
        self._shape = shape_of(wireframe)
        self._cloud = surface_cloud(self._shape)
        self._thin_cloud = surface_cloud(self._shape, SPARSE_POINTS)
        self._edges = ModelEdges(wireframe)
        self._full_dn = (
            FULL_DN if detector is None else SATURATES * (detector.saturation_dn - detector.bias_dn)
        )
        self._range_m = range_m
        self._seen: SeenViews | None = None
        self._lit: SunlitViews | None = None
        axes = [
            np.diag(signs) for signs in ((1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0))
        ]
        self._half_turns = [turn for turn in axes if not self._is_symmetry(turn)]

    def look(
        self,
        image: Image,
        daylight: Daylight,
        expected: tuple[RigidTransform, ...] = (),
        enough: float = np.inf,
    ) -> Looked:
        """Return the poses that an image allows.

        Parameters
        ----------
        image : (height, width) uint16 array, DN
        daylight : Daylight
        expected : tuple of RigidTransform
            Poses to be tried beside those of the search.
        enough : float
            Share of the light with which one of them is followed, and little else tried.
        """
        options, sun_in_cam = self._options, daylight.sun_in_cam
        cut = cut_out(image, self._camera, self._detector, options.fine_width)
        if not cut.target:
            return Looked(cut, None, (), "nothing in the image stands out of the sky", 0.0)
        effort = options.anew
        if expected:
            light = image_light(cut.target, self._radius_px(cut, expected[0]))
            shares = [self._light(cut, light, pose, sun_in_cam) for pose in expected]
            effort = options.quick if max(shares) >= enough else options.anew
        rung = NEAR_RADII if lit_extent_rad(cut) > NEAR_BEYOND else FAR_RADII
        seen = seen_views(self._shape, rung, options.directions)
        phase, work = phase_rad(cut, sun_in_cam), SEARCH_WORK
        off_rad = np.inf if self._lit is None else abs(self._lit.phase_rad - phase)
        if self._lit is None or off_rad > np.deg2rad(PHASE_STEP_DEG) or self._seen is not seen:
            self._seen, self._lit = seen, sunlit_views(seen, phase)
            work += TEMPLATE_WORK
        shine = np.sqrt(np.minimum(brightness(cut.target), 1.0)).astype(np.float32)
        views = search_sunlit_views(
            shine, cut.camera, seen, self._lit, sun_in_cam, self._wireframe.radius_m, effort.views
        )
        even = search_sunlit_views(
            cut.target.lit.astype(np.float32),
            cut.camera,
            seen,
            even_views(seen),
            sun_in_cam,
            self._wireframe.radius_m,
            effort.views,
        )
        views = [view for view in (*views, *even) if self._in_range(view.cam_from_target)]
        if not views:
            return Looked(cut, None, (), "no view of the target shines like the image", work)
        radius_px = float(np.median([self._radius_px(cut, v.cam_from_target) for v in views]))
        if radius_px < options.least_radius_px:
            reason = f"the target is too small: its radius seems to be {radius_px:.0f} px"
            return Looked(cut, None, (), reason, work)
        light = image_light(cut.target, radius_px)
        coarse = coarse_light(light, radius_px)
        views = [
            placed(coarse, cut.camera, seen, view, sun_in_cam, self._wireframe.radius_m)
            for view in views
        ]
        work += PLACE_WORK * len(views)
        views.sort(key=lambda view: -view.likeness)
        starts = [view.cam_from_target for view in views[: effort.held]] + list(expected)
        starts = [start for start in starts if self._in_range(start)]
        shares = [self._light(cut, light, start, sun_in_cam) for start in starts]
        work += LIGHT_WORK * len(starts)
        order = np.argsort(-np.array(shares), kind="stable")[: effort.laid]
        chosen = [starts[each] for each in order] + list(expected)
        reach = float(np.clip(0.14 * radius_px, 5.0, 16.0))
        laid = [self._laid(cut, light, start, sun_in_cam, reach) for start in chosen]
        found = self._different([one for one in laid if one is not None])
        twins = [
            RigidTransform(one.pose.rotation @ turn, one.pose.translation)
            for one in found[: effort.twinned]
            for turn in self._half_turns
        ]
        laid = [self._laid(cut, light, twin, sun_in_cam, reach) for twin in twins]
        work += FIT_WORK * (len(chosen) + len(twins))
        found = self._different([*found, *(one for one in laid if one is not None)])
        rough = image_light(cut.target, ROUGH_CELLS * radius_px)
        near = [self._nearby(cut, rough, one.pose, sun_in_cam) for one in found[: effort.polished]]
        laid = [self._laid(cut, light, pose, sun_in_cam, POLISHED_REACH_PX) for pose in near]
        work += (FIT_WORK + POLISH_WORK) * len(near)
        found = self._different([*found, *(one for one in laid if one is not None)])
        if not found:
            reason = "no view of the target can be laid on the image's edges"
            return Looked(cut, light, (), reason, work)
        finals = found[: options.finalists]
        told = finals[0].told
        weighed = [replace(one, preferred=preference(light, one.told, told)) for one in finals]
        if daylight.white_dn is not None and self._wireframe.finish is not None:
            search = BrightnessSearch(
                cut, self._full_dn, self._wireframe, self._cloud, daylight, radius_px
            )
            weighed = [self._by_brightness(search, one) for one in weighed]
            work += search.work
        weighed.sort(key=lambda one: -one.score)
        return Looked(cut, light, tuple(weighed), "", work)

    @staticmethod
    def _by_brightness(search: BrightnessSearch, one: Candidate) -> Candidate:
        """Say how likely the brightness is about a pose, which stays where its edges lie."""
        nearby = search.polished(one.pose)
        return replace(one, brightness=max(search.share(one.pose), search.share(nearby)))

    def same(self, pose: RigidTransform, other: RigidTransform) -> bool:
        """Tell whether two poses are near each other, a symmetry of the target aside."""
        away = float(np.linalg.norm(pose.translation - other.translation))
        if away > self._options.apart_share * other.translation[2]:
            return False
        least = 1.0 + 2.0 * np.cos(np.deg2rad(self._options.apart_deg))
        turns = (np.eye(3), *self._wireframe.symmetries)
        return any(
            float(np.trace(pose.rotation @ turn @ other.rotation.T)) > least for turn in turns
        )

    def _laid(
        self,
        cut: EdgeImage,
        light: ImageLight,
        start: RigidTransform,
        sun_in_cam: Floats,
        reach_px: float,
    ) -> Candidate | None:
        reaches = (reach_px, max(0.5 * reach_px, 4.0), 4.0)
        edges = LitEdges(self._edges, self._cloud, light, sun_in_cam)
        fit = fit_edges(cut, edges, start, reaches)
        if fit is None or not self._in_range(fit.cam_from_target):
            return None
        pose = fit.cam_from_target
        told = told_light(light, self._cloud, cut.camera, pose, sun_in_cam)
        return Candidate(
            fit=fit,
            check=check_pose(cut, self._edges, pose),
            light=explained(light, told),
            steps=self._steps(cut, edges, pose, told),
            shading=shading(light, told),
            told=told,
        )

    def _nearby(
        self, cut: EdgeImage, light: ImageLight, start: RigidTransform, sun_in_cam: Floats
    ) -> RigidTransform:
        """Return a pose near another at which the light is likelier: a search along each axis."""

        def share(pose: RigidTransform) -> float:
            told = told_light(light, self._thin_cloud, cut.camera, pose, sun_in_cam)
            return explained(light, told)

        pose, best = start, share(start)
        away = float(start.translation[2])
        aside = POLISH_ASIDE * self._wireframe.radius_m
        steps = np.diag([POLISH_RAD] * 3 + [aside, aside, POLISH_RANGE * away])
        for size in (1.0, 0.5):
            for step in size * steps:
                for way in (1.0, -1.0):
                    tried = pose.perturbed(way * step[:3], way * step[3:])
                    found = share(tried)
                    if found > best:
                        pose, best = tried, found
                        break
        return pose

    def _light(
        self, cut: EdgeImage, light: ImageLight, pose: RigidTransform, sun_in_cam: Floats
    ) -> float:
        return explained(light, told_light(light, self._cloud, cut.camera, pose, sun_in_cam))

    def _steps(
        self, cut: EdgeImage, edges: LitEdges, pose: RigidTransform, told: ToldLight
    ) -> float:
        """Return how many of the steps in brightness that a pose has are found, and how near."""
        samples = self._edges.shown(cut.camera, pose)
        due = edges.due(samples, told)
        if len(due) < FEWEST_DUE:
            return 0.0
        steps = search_steps(cut, due, NEAR_PX)
        sharp = float(np.clip(SHARP_SHARE * self._radius_px(cut, pose), *SHARP_PX))
        away = np.where(steps.found, steps.distance_px, np.inf)
        return float(np.exp(-0.5 * (away / sharp) ** 2).mean())

    def _different(self, found: list[Candidate]) -> list[Candidate]:
        kept: list[Candidate] = []
        for one in sorted(found, key=lambda each: -each.fitness):
            if not any(self.same(one.pose, other.pose) for other in kept):
                kept.append(one)
        return kept

    def _radius_px(self, cut: EdgeImage, pose: RigidTransform) -> float:
        return float(cut.camera.fx * self._wireframe.radius_m / pose.translation[2])

    def _in_range(self, pose: RigidTransform) -> bool:
        if self._range_m is None:
            return True
        nearest, farthest = self._range_m
        return bool(nearest / RANGE_SLACK < pose.translation[2] < farthest * RANGE_SLACK)

    def _is_symmetry(self, turn: Floats) -> bool:
        return any(np.trace(turn @ own.T) > 2.99 for own in self._wireframe.symmetries)
