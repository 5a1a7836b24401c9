"""Stars behind everything: points of light through the lens, at the fraction of a pixel they hit.

A star of irradiance ``E`` puts ``E pi/4 (f/N)^2 cos(off axis) tau QE / (h c / lambda)`` electrons a
second on the chip: the entrance pupil's area, foreshortened, where a scene's radiance has the
fourth power of the cosine (the other three are a pixel's solid angle, which a point does not know).
They fall as ``renders.detector.point_lights`` has it. A lens with a focus adds the circle that
infinity has.

While the shutter is open a star moves as the camera turns among the stars: in the approach by 0.01
to 0.07 px a second (who is on a straight way to a target sees it stand before the stars), by 1.1 px
late in it, where the aim slews. Above a tenth of a pixel it is drawn at several instants. What a
lens spreads widely of them (veiling glare) is lost: it is less than an electron anywhere.

Hidden is a star whose central pixel meets a part (depth), or that stands behind the Earth where
``[earth]`` shines. The Sun, the Moon and the planets hide none.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Mask, Radiance
from models.camera import Camera
from models.errors import ScenarioError
from models.lights.earth import EARTH_RADIUS_KM
from models.sensors.camera_chip import Detector, Optics, photon_energy_j
from models.sky.star_catalogue import bright_stars
from renders.detector.defocus import circle_of_confusion_px, defocused
from renders.detector.expose import SUNLIGHT_NM, pixel_response
from renders.detector.point_lights import add_points
from renders.world.world import World

STILL_PX = 0.1  # a star that moves less is drawn once
STEP_PX = 0.25  # from one instant of a moving star to the next


def electrons_per_irradiance(optics: Optics, camera: Camera, detector: Detector) -> float:
    """Return electrons per second for 1 W/m2 of a distant point on axis.

    Parameters
    ----------
    optics : Optics
    camera : Camera
        Its focal length sets the size of the pupil.
    detector : Detector
    """
    focal_m = camera.fx * detector.pixel_pitch_um * 1e-6
    pupil_m2 = 0.25 * np.pi * (focal_m / optics.f_number) ** 2
    passed = optics.transmission * detector.quantum_efficiency / photon_energy_j(SUNLIGHT_NM)
    return float(pupil_m2 * passed)


def star_electrons(
    world: World, time_s: float, exposure_ms: float, depth_m: Radiance | None
) -> Floats:
    """Return the charge that starlight leaves in each pixel of an exposure, (height, width), e.

    Parameters
    ----------
    world : World
    time_s : float, s
        Middle of the exposure.
    exposure_ms : float, ms
    depth_m : (height, width) array, m
        Of each pixel, 0 in space.

    Raises
    ------
    ScenarioError
        If there is no depth: nothing would hide them.
    """
    if depth_m is None:
        raise ScenarioError(
            "expected the depth of each pixel, which the stars need to be hidden by what flies in "
            "front of them, got light alone; set stars.shine to false"
        )
    camera = world.camera
    optics, detector = world.scenario.simulated_optics, world.scenario.simulated_detector
    charge = np.zeros((camera.height, camera.width))
    instants = _instants(world, time_s, exposure_ms * 1e-3)
    for instant in instants:
        pixels, off_axis, irradiance = stars_in_view(world, instant, depth_m)
        per_second = irradiance * electrons_per_irradiance(optics, camera, detector)
        if optics.vignetting:
            per_second = per_second * off_axis
        electrons = per_second * (exposure_ms * 1e-3 / len(instants))
        add_points(charge, pixels, electrons, optics.psf_sigma_px)
    if optics.focus_m > 0.0:
        infinity = circle_of_confusion_px(np.zeros_like(charge), optics, camera, detector)
        charge = defocused(charge, infinity)
    charge *= 1.0 - optics.veiling_glare
    if detector.prnu > 0.0:
        charge *= pixel_response(camera.height, camera.width, detector.prnu)
    return charge


def stars_in_view(world: World, time_s: float, depth_m: Radiance) -> tuple[Floats, Floats, Floats]:
    """Return the stars that the camera sees at an instant.

    Parameters
    ----------
    world : World
    time_s : float, s
    depth_m : (height, width) array, m
        0 where there is nothing; a star behind something is left out.

    Returns
    -------
    pixels : (n, 2) array, px
    off_axis : (n,) array
        Cosines of the angles off the boresight.
    irradiance_w_m2 : (n,) array, W/m2
        In the passband.
    """
    stars, camera = bright_stars(), world.camera
    in_target = stars.directions_in_icrs @ world.sky.turning.target_from_icrs(time_s).T
    in_cam = world.trajectory.cam_from_target(time_s).rotate(in_target)
    seen = _in_field(in_cam, camera) & ~_behind_the_earth(world, in_target, time_s)
    seen[seen] = camera.contains(camera.project(in_cam[seen]))
    pixels = camera.project(in_cam[seen])
    column, row = np.rint(pixels).astype(np.int64).T
    clear = depth_m[row, column] <= 0.0
    return pixels[clear], in_cam[seen, 2][clear], stars.irradiance_w_m2[seen][clear]


def _in_field(in_cam: Floats, camera: Camera) -> Mask:
    """Tell which directions lie no farther off axis than a corner: beyond, distortion may fold."""
    ends = np.array(
        [[u, v] for u in (-0.5, camera.width - 0.5) for v in (-0.5, camera.height - 0.5)]
    )
    return np.asarray(in_cam[:, 2] >= camera.rays(ends)[:, 2].min())


def _behind_the_earth(world: World, in_target: Floats, time_s: float) -> Mask:
    if not world.sky.shows_earth(time_s):
        return np.zeros(len(in_target), dtype=bool)
    direction, radius_km = world.earth_at(time_s)
    sine = EARTH_RADIUS_KM / radius_km
    return np.asarray(in_target @ direction > np.sqrt(1.0 - sine**2))


def _instants(world: World, time_s: float, exposure_s: float) -> Floats:
    """Return the instants, s, at which an exposure draws its stars: evenly within it."""
    ends = [time_s - 0.5 * exposure_s, time_s + 0.5 * exposure_s]
    cam_from_icrs = [
        world.trajectory.cam_from_target(end).rotation @ world.sky.turning.target_from_icrs(end)
        for end in ends
    ]
    turn = cam_from_icrs[1] @ cam_from_icrs[0].T
    farthest_px = float(np.linalg.norm(turn - np.eye(3), 2)) * max(world.camera.fx, world.camera.fy)
    count = 1 if farthest_px < STILL_PX else int(np.ceil(farthest_px / STEP_PX)) + 1
    return time_s + exposure_s * ((np.arange(count) + 0.5) / count - 0.5)
