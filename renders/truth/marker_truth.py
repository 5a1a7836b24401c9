"""Where the markers truly are in an image, and what each gets of light."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from models.errors import ScenarioError
from models.lights.led_beam import LedRing
from models.pose import RigidTransform
from renders.truth.exposure_truth import ExposureTruth
from renders.truth.pixel_truth import marker_light, outline_centres_px
from renders.world.exposure import Exposure
from renders.world.world import World


def exposure_truth(
    scene: Any, world: World, exposure: Exposure, cam_from_target: RigidTransform
) -> ExposureTruth:
    """Return the sealed record of one exposure of a pair.

    Parameters
    ----------
    scene : mitsuba.Scene
        As it was for the exposure.
    world : World
    exposure : Exposure
    cam_from_target : RigidTransform

    Raises
    ------
    ScenarioError
        If the target has no markers.
    """
    markers, camera = world.target.markers, world.camera
    if markers is None:
        raise ScenarioError(f"expected a target with markers, {world.target.name} has none")
    sun = world.sun_at(world.sun, exposure.time_s)
    light = marker_light(
        scene,
        markers,
        camera,
        cam_from_target,
        _ring(world, exposure),
        {sun.name: sun.direction_in_target},
    )
    if markers.paint:  # a dot needs some light, whatever sends it
        light = replace(light, lamp_lit=np.maximum(light.lamp_lit, light.sun_lit[sun.name]))
    return ExposureTruth(
        frame=exposure.frame,
        band=exposure.band,
        time_s=exposure.time_s,
        cam_from_target=cam_from_target,
        sun_dir_in_target=np.array(sun.direction_in_target),
        markers_px=camera.project(cam_from_target @ markers.points_in_target),
        marker_outlines_px=outline_centres_px(markers, camera, cam_from_target),
        visible=light.visible,
        lamp_lit=light.lamp_lit,
        sun_lit=light.sun_lit[sun.name],
    )


def _ring(world: World, exposure: Exposure) -> LedRing | None:
    """Return the lamps by which the markers are seen: their own, else an illuminator, or none."""
    stream = world.sensor.stream(exposure.band)
    lamps = stream.own_lamps or next(iter(stream.floodlights), None)
    return None if lamps is None else lamps.ring
