"""The parts of what is on board, each as it is told in a run: true, plus its errors."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.camera import Camera
from models.markers import MarkerPattern
from models.onboard import FlightExpectations
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe
from renders.scenario.camera_tables import check_detector
from renders.scenario.told_tables import (
    ToldCameraTable,
    ToldDetectorTable,
    ToldMarkersTable,
    ToldMountTable,
    ToldOpticsTable,
    ToldTargetTable,
)
from renders.world.told_draws import drawn, error_of, errors_of

Part = TypeVar("Part", Camera, Detector)


def told_camera(true: Camera, table: ToldCameraTable | None, run: int) -> Camera:
    """Return the camera as told in a run.

    Parameters
    ----------
    true : Camera
    table : ToldCameraTable or None
        None where it is told as it is.
    run : int

    Raises
    ------
    ValueError, ScenarioError
        If it cannot be.
    """
    return _shifted(true, table, "camera", run)


def told_detector(true: Detector, table: ToldDetectorTable | None, run: int) -> Detector:
    """Return the detector as told in a run.

    Parameters
    ----------
    true : Detector
    table : ToldDetectorTable or None
        None where it is told as it is.
    run : int

    Raises
    ------
    ValueError, ScenarioError
        If it cannot be.
    """
    detector = _shifted(true, table, "detector", run)
    if not (detector.gain_e_dn > 0.0 and detector.bias_dn >= 0.0 and detector.read_noise_e >= 0.0):
        raise ValueError(
            f"a detector with a gain of {detector.gain_e_dn:g} e/DN, a bias of "
            f"{detector.bias_dn:g} DN and a read noise of {detector.read_noise_e:g} e"
        )
    if table is not None:
        check_detector(detector, "the detector as told")
    return detector


def told_psf_sigma_px(true: float | None, table: ToldOpticsTable | None, run: int) -> float | None:
    """Return the blur as told in a run.

    Parameters
    ----------
    true : float or None, px
    table : ToldOpticsTable or None
        None where nobody is told.
    run : int

    Returns
    -------
    float or None, px
        None where nobody is told, or there is no true one.

    Raises
    ------
    ValueError
        If it is below zero.
    """
    if table is None or true is None:
        return None
    measured = true + error_of(table.psf_sigma_px, run, "optics.psf_sigma_px")
    if measured < 0.0:
        raise ValueError(f"a blur of {measured:g} px")
    return measured


def told_markers(
    true: MarkerPattern | None, table: ToldMarkersTable | None, run: int
) -> MarkerPattern | None:
    """Return the markers as surveyed in a run.

    Parameters
    ----------
    true : MarkerPattern or None
    table : ToldMarkersTable or None
        None where they are told as they are.
    run : int

    Raises
    ------
    ValueError
        If they cannot be.
    """
    if true is None or table is None:
        return true
    count = len(true)
    points = true.points_in_target + errors_of(table.place_m, run, "markers.place_m", count)
    turns_deg = errors_of(table.normal_deg, run, "markers.normal_deg", count)
    normals = true.normals_in_target
    if turns_deg.any():
        turned = Rotation.from_rotvec(turns_deg, degrees=True).apply(normals)
        normals = turned / np.linalg.norm(turned, axis=1, keepdims=True)
    cubes = true.cubes
    if cubes is not None and cubes.edges_in_target is not None and turns_deg.any():
        edges = Rotation.from_rotvec(turns_deg, degrees=True).apply(cubes.edges_in_target)
        cubes = replace(cubes, edges_in_target=edges)
    radius_m = true.radius_m + error_of(table.radius_m, run, "markers.radius_m")
    return MarkerPattern(true.names, points, normals, radius_m, true.paint, cubes)


def told_wireframe(
    true: Wireframe | None, table: ToldTargetTable | None, run: int
) -> Wireframe | None:
    """Return the target as drawn about the centre of mass that it is told to have.

    Its origin is that centre, so a centre told too far along +x leaves every corner too far along
    -x. Symmetries are still those about the true one.

    Parameters
    ----------
    true : Wireframe or None
    table : ToldTargetTable or None
        None where it is told as it is.
    run : int
    """
    if true is None or table is None or table.centre_of_mass_m is None:
        return true
    error = errors_of(table.centre_of_mass_m, run, "target.centre_of_mass_m")[0]
    return replace(
        true,
        points_in_target=true.points_in_target - error,
        triangles_in_target=true.triangles_in_target - error,
    )


def told_expectations(
    true: FlightExpectations | None,
    mount: ToldMountTable | None,
    target: ToldTargetTable | None,
    run: int,
) -> FlightExpectations | None:
    """Return what was expected before flight: another mount, another inertia.

    Parameters
    ----------
    true : FlightExpectations or None
    mount : ToldMountTable or None
    target : ToldTargetTable or None
        None where it is told as it is.
    run : int

    Raises
    ------
    ValueError
        If an inertia is no body's.
    """
    if true is None:
        return None
    return replace(
        told_sun(true, run),
        cam_from_lvlh=_mounted(true.cam_from_lvlh, mount, run),
        inertia_kg_m2=_inertia(true.inertia_kg_m2, target, run),
    )


def told_sun(true: FlightExpectations, run: int) -> FlightExpectations:
    """Return what was expected before flight, with the Sun turned by a run's draw of its sigma.

    Parameters
    ----------
    true : FlightExpectations
    run : int
    """
    if true.sun_dir_in_inertial is None:
        return true
    turn = np.deg2rad(true.sun_sigma_deg) * drawn(run, "knowledge.sun_dir_in_inertial", 3)
    sun = Rotation.from_rotvec(turn).apply(true.sun_dir_in_inertial)
    return replace(true, sun_dir_in_inertial=sun)


def _shifted(true: Part, table: Any, name: str, run: int) -> Part:
    """Return a part with an error added to each number that its table names."""
    keys = () if table is None else type(table).model_fields
    changes = {
        key: getattr(true, key) + error_of(getattr(table, key), run, f"{name}.{key}")
        for key in keys
        if getattr(table, key) is not None
    }
    return replace(true, **changes)


def _mounted(
    cam_from_lvlh: RigidTransform, table: ToldMountTable | None, run: int
) -> RigidTransform:
    if table is None:
        return cam_from_lvlh
    turn_deg = errors_of(table.turn_deg, run, "mount.turn_deg")[0]
    place_m = errors_of(table.place_m, run, "mount.place_m")[0]
    return cam_from_lvlh.perturbed(np.deg2rad(turn_deg), place_m)


def _inertia(true: Floats | None, table: ToldTargetTable | None, run: int) -> Floats | None:
    if true is None or table is None:
        return true
    scale = 1.0 + error_of(table.inertia_scale, run, "target.inertia_scale")
    if not scale > 0.0:
        raise ValueError(f"an inertia of {scale:g} times the true one")
    turn_deg = errors_of(table.inertia_axes_deg, run, "target.inertia_axes_deg")[0]
    turn = Rotation.from_rotvec(turn_deg, degrees=True).as_matrix()
    turned = scale * turn @ true @ turn.T
    return np.asarray(0.5 * (turned + turned.T))
