"""What the pipeline for an uncooperative target must know, and the two kinds of frame it takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from models.arrays import Floats, Image
from models.camera import Camera
from models.errors import DatasetError
from models.frame import BRACKET, CHASER_ORBIT, IMAGE, POINTS, Frame, ImageReading, TableReading
from models.lights.eclipse import share_past_earth
from models.motion.perturbed_orbit import lvlh_axes
from models.motion.relative_state import CHASER_ORBIT_COLUMNS, ChaserState
from models.onboard import OnboardKnowledge, needed
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.daylight import Daylight
from pipelines.filters.camera_mount import CameraMount

NAME = "uncooperative"


@dataclass(frozen=True, eq=False)
class PointFrame:
    """Corners found in one image by somebody else, in no order and without names.

    Attributes
    ----------
    index : int
    time_s : float, s
    points_px : (n, 2) array, px
        Pixel centres are integers.
    chaser : ChaserState
        As the chaser's absolute navigation has it, errors and all.
    mount : CameraMount, optional
        By the attitude that is navigated; without it, as known before flight.
    """

    index: int
    time_s: float
    points_px: Floats
    chaser: ChaserState
    mount: CameraMount | None = None


@dataclass(frozen=True, eq=False)
class ImageFrame:
    """One image.

    Attributes
    ----------
    index : int
    time_s : float, s
        Middle of the exposure, to which an estimate is stamped.
    image : (height, width) uint16 array, DN
    chaser : ChaserState
        As the chaser's absolute navigation has it, errors and all.
    mount : CameraMount, optional
        By the attitude that is navigated; without it, as known before flight.
    exposure_ms : float, optional, ms
    bracket : tuple of ImageReading
        Further exposures of the same view.
    """

    index: int
    time_s: float
    image: Image
    chaser: ChaserState
    mount: CameraMount | None = None
    exposure_ms: float | None = None
    bracket: tuple[ImageReading, ...] = ()


Seen: TypeAlias = PointFrame | ImageFrame


def seen(frame: Frame) -> Seen:
    """Return what a frame shows: points if it has them, else its image.

    Raises
    ------
    DatasetError
        If it has neither, or the chaser's orbit does not stand in it.
    """
    orbit = frame.table(CHASER_ORBIT)
    if not len(orbit.time_s):
        raise DatasetError(f"frame {frame.index}: expected a row of {CHASER_ORBIT}, got none")
    last = np.stack([orbit.column(name) for name in CHASER_ORBIT_COLUMNS], axis=1)[-1]
    chaser = ChaserState(float(orbit.time_s[-1]), last[:3], last[3:])
    return shown(frame, chaser)


def shown(frame: Frame, chaser: ChaserState, mount: CameraMount | None = None) -> Seen:
    """Return what a frame shows to a chaser whose state is known.

    Parameters
    ----------
    frame : Frame
    chaser : ChaserState
    mount : CameraMount, optional

    Raises
    ------
    DatasetError
        If the frame has neither points nor an image.
    """
    points = frame.readings.get(POINTS)
    if isinstance(points, TableReading):
        pixels = np.stack([points.column("u_px"), points.column("v_px")], axis=1)
        return PointFrame(frame.index, frame.time_s, pixels, chaser, mount)
    reading = frame.image(IMAGE)
    bracket = tuple(
        frame.image(name) for name in sorted(frame.readings) if name.startswith(BRACKET)
    )
    return ImageFrame(
        frame.index, frame.time_s, reading.image, chaser, mount, reading.exposure_ms, bracket
    )


def image_frame(
    index: int,
    time_s: float,
    image: Image,
    exposure_ms: float,
    chaser: ChaserState,
    bracket: Sequence[tuple[Image, float]] = (),
) -> Frame:
    """Return a frame of one image, maybe in several exposures, and the chaser's orbit.

    Parameters
    ----------
    index : int
    time_s : float, s
    image : (height, width) uint16 array, DN
    exposure_ms : float, ms
    chaser : ChaserState
    bracket : sequence of (image, exposure in ms)
        Further exposures of the same view.
    """
    reading = ImageReading(image, time_s, exposure_ms)
    further = {
        f"{BRACKET}{number}": ImageReading(own, time_s, own_ms)
        for number, (own, own_ms) in enumerate(bracket)
    }
    return Frame(index, time_s, {IMAGE: reading, **further, CHASER_ORBIT: chaser.reading()})


def points_frame(index: int, time_s: float, points_px: Floats, chaser: ChaserState) -> Frame:
    """Return a frame of corners that somebody else found, and the chaser's orbit.

    Parameters
    ----------
    index : int
    time_s : float, s
    points_px : (n, 2) array, px
    chaser : ChaserState
    """
    table = TableReading(("u_px", "v_px"), np.full(len(points_px), time_s), points_px)
    return Frame(index, time_s, {POINTS: table, CHASER_ORBIT: chaser.reading()})


@dataclass(frozen=True, eq=False)
class UncooperativeKnowledge:
    """The parts of what is on board that this pipeline cannot do without.

    Attributes
    ----------
    camera : Camera
        As calibrated, not as simulated.
    target : Wireframe
        As drawn, not as built.
    cam_from_lvlh : RigidTransform
        How the camera is mounted: the chaser's body frame is its local frame.
    sigma_px : float, px
        1-sigma of a corner, per axis, as expected before flight.
    chaser_sigma_m, chaser_sigma_m_s : float, m and m/s
        1-sigma per axis of the chaser's absolute navigation.
    range_m : (float, float), optional, m
        A coarse range, nearest and farthest, if the user gives one.
    detector : Detector, optional
        As calibrated; where frames are images.
    inertia_kg_m2 : (3, 3) array, optional
        Of the target about its centre of mass, target axes, as known before flight; any multiple
        serves. Without it the filters take the rate as constant.
    sun_dir_in_inertial : (3,) array, optional
        Unit vector towards the Sun by the ephemeris on board, in the axes of the chaser's orbit.
    sun_sigma_deg : float, deg
        1-sigma per axis of that direction as the camera sees it.
    earth_shines : bool
        Whether the Earth lights the target; it stands where the chaser's orbit has it,
    earth_dir_in_inertial : (3,) array, optional
        unless this is known, a unit vector towards its centre.
    white_dn_ms : float, optional, DN/ms
        What a white matt surface that the Sun meets squarely gives the camera.
    earth_hides_sun : bool
        Whether the Sun goes out where the chaser's orbit has the Earth before it.
    """

    camera: Camera
    target: Wireframe
    cam_from_lvlh: RigidTransform
    sigma_px: float
    chaser_sigma_m: float = 0.0
    chaser_sigma_m_s: float = 0.0
    range_m: tuple[float, float] | None = None
    detector: Detector | None = None
    inertia_kg_m2: Floats | None = None
    sun_dir_in_inertial: Floats | None = None
    sun_sigma_deg: float = 0.0
    earth_shines: bool = False
    earth_dir_in_inertial: Floats | None = None
    white_dn_ms: float | None = None
    earth_hides_sun: bool = False

    def sunlit_share(self, chaser: ChaserState) -> float:
        """Return how much of the Sun's disc the Earth leaves free, by the orbit; 1 if not known.

        Parameters
        ----------
        chaser : ChaserState
        """
        if self.sun_dir_in_inertial is None or not self.earth_hides_sun:
            return 1.0
        radius_m = float(np.linalg.norm(chaser.position_in_inertial))
        down = -chaser.position_in_inertial / radius_m
        return share_past_earth(self.sun_dir_in_inertial, down, 1e-3 * radius_m)

    def daylight(
        self, chaser: ChaserState, exposure_ms: float | None, mount: CameraMount | None = None
    ) -> Daylight | None:
        """Return what lights the target in an image, where the Sun's direction is on board.

        None in the umbra, too: what shines there is none of the Sun's.

        Parameters
        ----------
        chaser : ChaserState
        exposure_ms : float or None, ms
            Of the image; None where it is not known.
        mount : CameraMount, optional
            By the attitude that is navigated; without it, as known before flight.
        """
        share = self.sunlit_share(chaser)
        if self.sun_dir_in_inertial is None or share <= 0.0:
            return None
        axes = lvlh_axes(chaser.position_in_inertial, chaser.velocity_in_inertial)
        mounted = self.cam_from_lvlh if mount is None else mount.cam_from_lvlh
        cam_from_inertial = mounted.rotation @ axes.T
        radius_m = float(np.linalg.norm(chaser.position_in_inertial))
        earth = self.earth_dir_in_inertial
        if earth is None and self.earth_shines:
            earth = -chaser.position_in_inertial / radius_m
        white_dn = None
        if self.white_dn_ms is not None and exposure_ms:
            white_dn = self.white_dn_ms * exposure_ms
        return Daylight(
            cam_from_inertial @ self.sun_dir_in_inertial,
            None if earth is None else cam_from_inertial @ earth,
            white_dn,
            1e-3 * radius_m,
            share,
        )

    @classmethod
    def of(cls, onboard: OnboardKnowledge) -> UncooperativeKnowledge:
        """Take the parts that are needed.

        Raises
        ------
        DatasetError
            If the wireframe or the expectations are not on board.
        """
        expected = needed(onboard.expectations, "knowledge.toml", NAME)
        return cls(
            camera=needed(onboard.camera, "camera.toml", NAME),
            target=needed(onboard.wireframe, "wireframe.json", NAME),
            cam_from_lvlh=expected.cam_from_lvlh,
            sigma_px=expected.sigma_px,
            chaser_sigma_m=expected.chaser_sigma_m,
            chaser_sigma_m_s=expected.chaser_sigma_m_s,
            range_m=expected.range_m,
            detector=onboard.detector,
            inertia_kg_m2=expected.inertia_kg_m2,
            sun_dir_in_inertial=expected.sun_dir_in_inertial,
            sun_sigma_deg=expected.sun_sigma_deg,
            earth_shines=expected.earth_shines,
            earth_dir_in_inertial=expected.earth_dir_in_inertial,
            white_dn_ms=expected.white_dn_ms,
            earth_hides_sun=expected.earth_hides_sun,
        )
