"""Settings of absolute navigation, and its two variants.

The paper prints the model (equations 1 to 10) and the sensors' errors (Table 3), no tuning. What
the process noise has to carry follows from what the model of gravity leaves out.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

import numpy as np

from models.errors import ScenarioError
from models.gnss.tracking_noise import SPEED_OF_LIGHT_M_S, TrackingLoops

Regime: TypeAlias = Literal["leo", "geo"]

VARIANTS = ("paper", "best")
REGIMES = ("leo", "geo")
GPS_MU_M3_S2 = 3.986005e14  # as printed: that of the GPS interface document
EGM_MU_M3_S2 = 3.986004415e14
EARTH_RADIUS_M = 6_378_137.0
J2 = 1.0826262e-3
ARCSEC = np.deg2rad(1.0 / 3600.0)
DEG_H = np.deg2rad(1.0) / 3600.0


@dataclass(frozen=True)
class AbsoluteOptions:
    """Settings of the filter.

    Attributes
    ----------
    variant, regime : str
        Names of the set.
    alpha, beta, kappa : float
        Of the sigma points.
    mu_m3_s2, radius_m, j2 : float
        Of the gravity model, equation 6.
    third_bodies : bool
        Whether Sun and Moon are in the model.
    left_out_m_s2, left_out_s : float, m/s2 and s
        1 sigma and time constant of the acceleration that the model leaves out.
    left_out_fades : bool
        Whether it is a Gauss-Markov process; else a random walk (equation 7) as strong.
    clock_h0, clock_h_minus_2 : float, s and 1/s
        Allan parameters of the receiver's oscillator, white and random-walk frequency noise.
    gyro_noise_deg_rth, gyro_bias_deg_h, gyro_bias_s : float
        Angular random walk; 1 sigma and time constant of the bias, taken as a random walk as
        strong (equation 8).
    accelerometer_bias_m_s2 : float, m/s2
        What is neglected of it while the satellite manoeuvres.
    range_sigma_m : float, m
        User range error without the receiver's: Table 3, root sum square.
    lasting_m, lasting_s : float, m and s
        1 sigma and time constant of the part of that error which lasts, told apart from the rest.
    slots : int
        Channels whose lasting error is estimated; 0 where all errors are new at every epoch.
    loops : TrackingLoops
    nominal_cn0_dbhz : float or None, dB-Hz
        At which the receiver's noise is taken for all signals; None takes each signal's own.
    mask_height_m : float, m
        Signals that pass below it are not used.
    edit_sigmas : float
        A range or a rate whose innovation is beyond so many of its sigmas is left out, and a star
        attitude likewise; 0 uses all.
    patience_epochs, patience_frames : int
        So many in a row mostly left out, and the filter doubts itself instead.
    start_position_m, start_velocity_m_s, start_attitude_deg, start_bias_deg_h : float
        1 sigma of what it is started with.
    start_clock_s, start_drift : float, s and s/s
    """

    variant: str
    regime: str
    alpha: float = 1.0
    beta: float = 2.0
    kappa: float = 0.0
    mu_m3_s2: float = GPS_MU_M3_S2
    radius_m: float = EARTH_RADIUS_M
    j2: float = J2
    third_bodies: bool = False
    left_out_m_s2: float = 1.75e-4
    left_out_s: float = 300.0
    left_out_fades: bool = False
    clock_h0: float = 2e-19
    clock_h_minus_2: float = 2e-20
    gyro_noise_deg_rth: float = 0.05
    gyro_bias_deg_h: float = 0.1
    gyro_bias_s: float = 3600.0
    accelerometer_bias_m_s2: float = 1.5e-4
    range_sigma_m: float = 1.38
    lasting_m: float = 0.0
    lasting_s: float = 1.0
    slots: int = 0
    loops: TrackingLoops = field(default_factory=TrackingLoops)
    nominal_cn0_dbhz: float | None = None
    mask_height_m: float = -np.inf
    edit_sigmas: float = 0.0
    patience_epochs: int = 10
    patience_frames: int = 15
    start_position_m: float = 1000.0
    start_velocity_m_s: float = 1.0
    start_attitude_deg: float = 0.3
    start_bias_deg_h: float = 1.0
    start_clock_s: float = 0.3
    start_drift: float = 6e-6

    @property
    def left_out_density(self) -> float:
        """Of the white noise that drives the acceleration left out, m2/s5."""
        return 2.0 * self.left_out_m_s2**2 / self.left_out_s

    @property
    def clock_densities(self) -> tuple[float, float]:
        """Of the noise of the clock's phase and frequency, m2/s and m2/s3."""
        squared = SPEED_OF_LIGHT_M_S**2
        return 0.5 * squared * self.clock_h0, 2.0 * np.pi**2 * squared * self.clock_h_minus_2

    @property
    def gyro_densities(self) -> tuple[float, float]:
        """Of the noise of the gyroscopes' angle and bias, rad2/s and rad2/s3."""
        walk = np.deg2rad(self.gyro_noise_deg_rth) / 60.0
        return walk**2, 2.0 * (self.gyro_bias_deg_h * DEG_H) ** 2 / self.gyro_bias_s


def absolute_options_for(variant: str, regime: str, lasting: bool = False) -> AbsoluteOptions:
    """Return the settings of a variant for an orbit.

    Parameters
    ----------
    variant, regime : str
    lasting : bool
        Whether the errors of ranges are known to last. ``paper`` takes them as new at every epoch
        all the same, as it says.

    Raises
    ------
    ScenarioError
        If there is no such variant or regime.
    """
    if variant not in VARIANTS or regime not in REGIMES:
        raise ScenarioError(
            f"expected a variant among {', '.join(VARIANTS)} and a regime among "
            f"{', '.join(REGIMES)}, got {variant!r} and {regime!r}"
        )
    own = AbsoluteOptions(variant, regime)
    if regime == "leo":
        own = replace(own, range_sigma_m=float(np.hypot(1.38, 10.0)), nominal_cn0_dbhz=50.0)
    else:
        own = replace(
            own,
            left_out_m_s2=2.5e-6,
            left_out_s=4 * 3600.0,
            nominal_cn0_dbhz=30.0,
            mask_height_m=1_000_000.0,
        )
    if variant == "paper":
        return own
    best = replace(
        own,
        mu_m3_s2=EGM_MU_M3_S2,
        third_bodies=True,
        nominal_cn0_dbhz=None,
        edit_sigmas=5.0,
        left_out_fades=True,
        left_out_m_s2=1.75e-4 if regime == "leo" else 1.3e-7,
    )
    if not lasting:
        return best
    broadcast_m, ionosphere_m = 1.36, 10.0
    size_m = float(np.hypot(broadcast_m, ionosphere_m)) if regime == "leo" else broadcast_m
    return replace(
        best,
        range_sigma_m=0.2,
        lasting_m=size_m,
        lasting_s=600.0 if regime == "leo" else 7200.0,
        slots=30,
    )
