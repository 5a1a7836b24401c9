"""A spacecraft with other markers than it comes with: discs at their places, with no supports."""

from __future__ import annotations

from dataclasses import replace

from models.errors import ScenarioError
from models.markers import MarkerPattern
from models.spacecraft.inside import is_inside
from models.spacecraft.marker_support import SUPPORTS
from models.spacecraft.part import Spacecraft

PROUD_M = 0.002  # a disc that lies on a skin, or a millimetre under a blanket's, is seen


def with_own_markers(spacecraft: Spacecraft, markers: MarkerPattern) -> Spacecraft:
    """Return a spacecraft whose markers are others; the supports of its own go with them.

    Raises
    ------
    ScenarioError
        If a marker lies inside the spacecraft, where no camera sees it.
    """
    parts = tuple(part for part in spacecraft.parts if part.name != SUPPORTS)
    bare = replace(spacecraft, parts=parts, markers=markers)
    faces = markers.points_in_target + PROUD_M * markers.normals_in_target
    for name, point, face in zip(markers.names, markers.points_in_target, faces, strict=True):
        if is_inside(bare, face):
            where = ", ".join(f"{x:.3f}" for x in point)
            raise ScenarioError(
                f"expected markers on the outside of {spacecraft.name}, got the marker {name!r} at "
                f"({where}) m, inside it, or facing inwards; check the frame and the normal"
            )
    return bare
