"""The fine detail of real surfaces, as data; see ``renders.tracing.fine_detail``."""

from __future__ import annotations

from dataclasses import dataclass

MOST_CREASED = 0.6  # of the roughness: a lobe cannot be told apart into creases beyond


@dataclass(frozen=True)
class SurfaceDetail:
    """How much a surface differs from place to place, about its mean.

    Attributes
    ----------
    crease_slope : float
        Slope of creases and wrinkles of millimetres to centimetres, root mean square along each
        direction in the surface. From afar it is a part of the material's roughness.
    mottling : float
        Largest change of reflectance over decimetres, as a share: dust, uneven coats, stains.
    tile_spread : float
        Largest change of reflectance from one flat tile to the next, as a share.
    """

    crease_slope: float = 0.0
    mottling: float = 0.0
    tile_spread: float = 0.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not 0.0 <= value <= 0.5:
                raise ValueError(f"expected a share or slope from 0 to 0.5, got {name} = {value}")

    @property
    def is_varied(self) -> bool:
        """Whether there is any."""
        return max(self.crease_slope, self.mottling, self.tile_spread) > 0.0


PLAIN = SurfaceDetail()

# Our estimates, all of them; what they rest on:
# - foil: photographs of blankets show facets and wrinkles from a few millimetres up whose reflected
#   images wander by 5 to 10 degrees, so slopes of 3 degrees; paired with a roughness of 0.10.
# - paint: coats differ in thickness by a tenth; absorptance of Z93 spreads by 0.01 to 0.02 between
#   samples (Gilmore 2002, appendix A), of what is absorbed here that is 2 % of what is reflected.
# - cells and mirrors: sorted by current to a few per cent; coatings' thickness spreads the residual
#   reflectance of a cell, which is small, by more than the mirror's.
# - bare, fired and anodised metal: stains and tool marks.
DETAIL: dict[str, SurfaceDetail] = {
    "mli_gold": SurfaceDetail(crease_slope=0.05, mottling=0.02),
    "mli_aluminium": SurfaceDetail(crease_slope=0.04, mottling=0.02),
    "mli_black": SurfaceDetail(crease_slope=0.06, mottling=0.04),
    "bare_aluminium": SurfaceDetail(mottling=0.03),
    "anodised_aluminium": SurfaceDetail(mottling=0.04),
    "solar_cell": SurfaceDetail(mottling=0.01, tile_spread=0.04),
    "solar_substrate": SurfaceDetail(mottling=0.04),
    "optical_solar_reflector": SurfaceDetail(tile_spread=0.01),
    "white_paint": SurfaceDetail(mottling=0.02),
    "black_paint": SurfaceDetail(mottling=0.05),
    "carbon_fibre": SurfaceDetail(mottling=0.05),
    "titanium_nozzle": SurfaceDetail(mottling=0.08),
}
