"""One pose of a sweep with all that is to be tried on it: Suns, exposures, lamp powers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from bench.sweep.folder import depth_path
from bench.sweep.plan import SweepPlan, SweepPose, has_lamps
from bench.sweep.shots import Shot, read_shot
from bench.sweep.table import Setting
from models.onboard import OnboardKnowledge
from renders.batches.studio import Studio
from renders.batches.sweep_batches import PoseLight, scenario_at
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore
from renders.world.world import World


@dataclass(eq=False)
class PoseWork:
    """One pose with everything that is to be tried on it.

    Attributes
    ----------
    pose : SweepPose
    light : PoseLight
    onboards : tuple of OnboardKnowledge
        By draw.
    settings : list of Setting
    shots : list of lists of Shot
        By Sun, then as ``settings``.
    again : list of lists of lists of Shot
        The same light drawn anew, by Sun, setting and draw; for the maps' pipeline alone.
    """

    pose: SweepPose
    light: PoseLight
    onboards: tuple[OnboardKnowledge, ...]
    settings: list[Setting]
    shots: list[list[Shot]]
    again: list[list[list[Shot]]]

    @property
    def every_shot(self) -> list[Shot]:
        """All shots under all Suns."""
        return [shot for sun in range(len(self.shots)) for shot in self.shots_under(sun)]

    def shots_under(self, sun: int) -> list[Shot]:
        """Return the shots under one Sun, those of the first draw first."""
        return [*self.shots[sun], *(shot for own in self.again[sun] for shot in own)]

    def missing_shots(self, out: Path, sun: int) -> list[Shot]:
        """Return the shots under one Sun that have not been taken."""
        return [shot for shot in self.shots_under(sun) if read_shot(out, shot) is None]


def pose_work(
    plan: SweepPlan, pose: SweepPose, world: World, store: RadianceStore, variant: str
) -> PoseWork:
    """Return the work on a pose.

    Parameters
    ----------
    plan : SweepPlan
    pose : SweepPose
    world : World
        Of that one frame; see ``renders.batches.sweep_batches.scenario_at``.
    store : RadianceStore
    variant : str
        The full name of Mitsuba's.
    """
    onboards = tuple(world.onboard(run=run) for run in range(plan.request.draws))
    keys = LightKeys(world, "scalar" if variant.startswith("scalar") else "jit")
    light = PoseLight(Studio(world, store, keys, world.target.markers), plan.suns)
    own_lamps_w_sr = plan.scenario.lamps.intensity_w_sr if has_lamps(world) else 0.0
    own_ms = world.frame_entries(onboards[0].prior)[0].exposure_ms
    settings = [
        Setting(pose.time_s, pose.range_m, exposure_ms, lamp_w_sr)
        for exposure_ms, lamp_w_sr in product(
            dict.fromkeys(plan.request.exposure_ms or (own_ms,)),
            dict.fromkeys(plan.request.lamp_w_sr or (own_lamps_w_sr,)),
        )
    ]
    bands = world.bands if plan.scenario.needs_depth else ()
    depth = {band: depth_path(plan.request.out, pose, band) for band in bands}
    shots = [
        [
            Shot(
                scenario=scenario_at(plan.scenario, pose.time_s, sun.text),
                store=store.folder,
                light=light.keys(number),
                exposure_ms=setting.exposure_ms,
                lamp_factor=setting.lamp_w_sr / own_lamps_w_sr if own_lamps_w_sr else 1.0,
                pipelines=plan.pipelines,
                depth=depth,
            )
            for setting in settings
        ]
        for number, sun in enumerate(plan.suns)
    ]
    shown = (plan.map_pipeline,)
    again = [
        [
            [replace(shot, run=run, pipelines=shown) for run in range(1, plan.request.draws)]
            for shot in own
        ]
        for own in shots
    ]
    return PoseWork(pose, light, onboards, settings, shots, again)
