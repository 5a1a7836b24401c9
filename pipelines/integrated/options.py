"""Settings of the relative half in the field of a real Earth."""

from __future__ import annotations

from dataclasses import replace

from pipelines.uncooperative.options import UncooperativeOptions, options_for

FLATTENING_M_S2 = 1e-7  # what the Earth's flattening leaves between two satellites 30 m apart


def relative_options_for(variant: str, regime: str) -> UncooperativeOptions:
    """Return the settings of the relative filters.

    Parameters
    ----------
    variant : str
        ``paper`` as printed; ``best`` allows for the Earth's flattening in a low orbit.
    regime : str
        ``leo`` or ``geo``.

    Raises
    ------
    ScenarioError
        If there is no such variant.
    """
    own = options_for(variant)
    if variant != "best" or regime != "leo":
        return own
    return replace(own, navigation=replace(own.navigation, acceleration_m_s2=FLATTENING_M_S2))
