"""The Maxar-1300's radiators on +-y."""

from __future__ import annotations

from models.spacecraft.bus import HALF_M, RADIATOR_CENTRE_Z_M, RADIATOR_SIZE_M
from models.spacecraft.mirror_panel import mirror_panel
from models.spacecraft.part import Part
from models.spacecraft.solar_wing import WING_Z_M
from models.spacecraft.solids import placed, standing

PANEL_PROUD_M = 0.025
DRIVE_CLEAR_M = 0.20  # no tiles round the solar array drive


def radiator_parts(sign: float) -> tuple[Part, ...]:
    """Return the radiator of the +y (``sign`` 1) or -y (-1) face."""
    name = "radiator_plus_y" if sign > 0.0 else "radiator_minus_y"
    at = standing((0.0, sign * HALF_M, RADIATOR_CENTRE_Z_M), (0.0, sign, 0.0), (-sign, 0.0, 0.0))
    drive = (0.0, WING_Z_M - RADIATOR_CENTRE_Z_M, DRIVE_CLEAR_M)
    panel, mirrors = mirror_panel(RADIATOR_SIZE_M, PANEL_PROUD_M, 1301, drive)
    return (
        Part(name, placed(panel, at), "white_paint"),
        Part(name, placed(mirrors, at), "optical_solar_reflector"),
    )
