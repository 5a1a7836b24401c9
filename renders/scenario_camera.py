"""The scenario's tables of the camera: which one flies, its lens, its chip, its exposures."""

from __future__ import annotations

from pydantic import Field

from renders.scenario_table import Table


class CameraTable(Table):
    """Which camera flies, as simulated."""

    preset: str = Field("chaser_fixed", description="chaser_fixed or eye_in_hand")
    width: int = Field(2048, ge=64, le=8192, description="columns; the field of view stays")
    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    k3: float = 0.0


class OpticsTable(Table):
    """The lens; see ``models.sensor.Optics``."""

    f_number: float = Field(16.0, gt=0)
    transmission: float = Field(0.8, gt=0, le=1)
    psf_sigma_px: float = Field(0.5, ge=0, description="on the native 13.5 um pixel")
    vignetting: bool = True


class DetectorTable(Table):
    """The chip; see ``models.sensor.Detector``."""

    pixel_pitch_um: float = Field(13.5, gt=0, description="at 2048 columns")
    quantum_efficiency: float = Field(0.5, gt=0, le=1)
    prnu: float = Field(0.005, ge=0)
    dark_current_e_s: float = Field(20.0, ge=0)
    full_well_e: float = Field(100_000.0, gt=0)
    blooming: float = Field(0.0, ge=0, le=1)
    read_noise_e: float = Field(12.0, ge=0)
    gain_e_dn: float = Field(26.0, gt=0)
    bias_dn: float = Field(100.0, ge=0)
    bits: int = Field(12, ge=8, le=16)


class ExposureTable(Table):
    """Exposure time: proportional to the prior's range squared."""

    marker_fill: float = Field(0.6, gt=0, le=1, description="share of full well, on axis")
