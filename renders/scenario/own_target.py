"""A target of one's own in a scenario: the TOML that it names, read into it, without the mesh.

``target = "probe.toml"`` is read once: the spacecraft's name takes the place of the path, and the
TOML's lines stand in ``[own_target]``, so that a resolved scenario tells all but the triangles.
These are known by their hash: light of another mesh is another light.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from models.errors import DatasetError, ScenarioError
from models.reading.shown import shown
from models.spacecraft.catalogue import spacecraft_by_name
from models.spacecraft.wireframes import WIREFRAMES, wireframe_by_name
from renders.scenario.table import Table

if TYPE_CHECKING:
    from models.spacecraft.own.build import OwnTarget
    from models.spacecraft.part import Spacecraft
    from models.wireframe.wireframe import Wireframe
    from renders.scenario.scenario import Scenario

SUFFIX, MESHES = ".toml", (".glb", ".gltf", ".obj", ".stl", ".ply")
MOST_LINES, MOST_LINE, MOST_PATH = 20_000, 10_000, 4096


class OwnTargetTable(Table):
    """A spacecraft of your own, as `target = "spacecraft.toml"` writes it into a resolved scenario.

    Not to be typed: name the file. `docs/formats.md` has its keys.
    """

    file: Annotated[str, Field(max_length=MOST_PATH)] = Field(
        description="where it was read, beside its mesh; the place shapes nothing"
    )
    files_sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")] = Field(
        description="of the mesh, and of the files that either names"
    )
    lines: Annotated[
        tuple[Annotated[str, Field(max_length=MOST_LINE)], ...],
        Field(strict=False, max_length=MOST_LINES),
    ] = Field(description="of the TOML beside it")

    def built(self, where: str) -> OwnTarget:
        """Return the spacecraft, built.

        Parameters
        ----------
        where : str
            For messages.

        Raises
        ------
        ScenarioError
            If the mesh cannot be used, or is another than it was.
        """
        from models.spacecraft.own.build import own_target

        try:
            built = own_target(self.lines, self.file, Path(self.file).parent)
        except DatasetError as error:
            if isinstance(error.__cause__, FileNotFoundError):
                raise ScenarioError(
                    f"{where}: expected the mesh that its target is made of, and what lies beside "
                    f"it, got: {error}; put it back"
                ) from error
            raise ScenarioError(str(error)) from error
        if built.files_sha256 != self.files_sha256:
            raise ScenarioError(
                f"{where}: expected the mesh {built.description.mesh_path} as it "
                f"was, and what lies beside it, of hash {self.files_sha256[:12]}, got "
                f"{built.files_sha256[:12]}; put the old files back, or render into another folder"
            )
        return built

    def has_markers(self) -> bool:
        """Tell whether it has markers, without its mesh.

        Raises
        ------
        ScenarioError
            If its TOML cannot be used.
        """
        from models.spacecraft.own.description import description_of

        try:
            return description_of(self.lines, self.file, Path(self.file).parent).markers is not None
        except DatasetError as error:
            raise ScenarioError(str(error)) from error


def with_own_target_read(table: dict[str, Any], path: Path) -> None:
    """Read the spacecraft that a scenario names into its table, and let its inertia stand.

    Parameters
    ----------
    table : dict
        The scenario's; changed in place.
    path : Path
        Its file, beside which the spacecraft lies.

    Raises
    ------
    ScenarioError
        If it cannot be used, or is told twice.
    """
    target = table.get("target")
    if isinstance(target, str) and target.lower().endswith(MESHES):
        raise ScenarioError(
            f"{path}: expected target as the .toml beside a mesh, got {shown(target)}; "
            f"`rvbench inspect {target}` writes one"
        )
    if not isinstance(target, str) or not target.lower().endswith(SUFFIX):
        return
    if "own_target" in table:
        raise ScenarioError(
            f"{path}: expected target = {target!r} or a table [own_target], got both; leave the "
            "table out"
        )
    from models.spacecraft.own.build import read_own_target
    from models.spacecraft.own.description import read_lines_of

    named = path.parent / target
    file = named.parent.resolve() / named.name
    try:
        lines, own = read_lines_of(file), read_own_target(file)
    except DatasetError as error:
        raise ScenarioError(str(error)) from error
    table["target"] = own.description.name
    table["own_target"] = {
        "file": str(file),
        "files_sha256": own.files_sha256,
        "lines": list(lines),
    }
    tumble = table.get("tumble")
    if isinstance(tumble, dict):
        table["tumble"] = {"inertia_kg_m2": own.inertia_kg_m2.tolist(), **tumble}


def target_of(scenario: Scenario) -> Spacecraft:
    """Return the target of a scenario, a preset or one's own, built once a process.

    Raises
    ------
    ScenarioError
        If there is none of that name, or its mesh cannot be used.
    """
    if scenario.own_target is None:
        return spacecraft_by_name(scenario.target)
    return scenario.own_target.built(scenario.name).spacecraft


def target_has_markers(scenario: Scenario) -> bool:
    """Tell whether the target itself has markers; of one's own its mesh is not opened for it."""
    if scenario.own_target is None:
        return spacecraft_by_name(scenario.target).markers is not None
    return scenario.own_target.has_markers()


def target_has_dots(scenario: Scenario) -> bool:
    """Tell whether the target's own markers are painted dots."""
    if scenario.own_target is not None:
        return False
    markers = spacecraft_by_name(scenario.target).markers
    return markers is not None and markers.paint != ""


def wireframe_of(scenario: Scenario) -> Wireframe:
    """Return the wireframe of a scenario's target.

    Raises
    ------
    ScenarioError
        If it has none.
    """
    if scenario.own_target is None:
        return wireframe_by_name(scenario.target)
    return scenario.own_target.built(scenario.name).known_wireframe


def wireframe_if_any(scenario: Scenario) -> Wireframe | None:
    """Return the wireframe of a scenario's target, or None if it has none."""
    if scenario.own_target is not None:
        return scenario.own_target.built(scenario.name).wireframe
    return wireframe_of(scenario) if scenario.target in WIREFRAMES else None
