"""The scenario's table of markers of one's own, which replace the target's."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from models.dataset.marker_file import LARGEST_RADIUS_M, MOST_MARKERS, markers_of
from models.errors import DatasetError, ScenarioError
from models.markers import MarkerPattern
from models.reading.fields import Fields
from renders.scenario.table import Table, Triple

MarkerName = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,32}$")]


class MarkerTable(Table):
    """One marker: a disc at its place, with nothing that carries it."""

    name: MarkerName = Field(description="letters, digits, - and _; each marker another")
    point_in_target_m: Triple = Field(description="its centre")
    normal_in_target: Triple = Field(description="outward, of length 1")
    kind: Literal["retroreflector"] = Field(
        "retroreflector", description="the one kind there is yet"
    )


class MarkersTable(Table):
    """Markers of one's own; ``markers = "markers.toml"`` reads them from beside the scenario."""

    radius_m: float = Field(ge=1e-4, le=LARGEST_RADIUS_M, description="of every disc")
    marker: Annotated[tuple[MarkerTable, ...], Field(strict=False, max_length=MOST_MARKERS)] = (
        Field(description="each with its place and normal, at least three not on one line")
    )


def markers_from(table: MarkersTable, where: str) -> MarkerPattern:
    """Return the markers of a scenario.

    Raises
    ------
    ScenarioError
        If no pose could ever be found from them, or a normal is none.
    """
    try:
        return markers_of(Fields(table.model_dump(mode="json"), f"{where}: markers"))
    except DatasetError as error:
        raise ScenarioError(str(error)) from error
