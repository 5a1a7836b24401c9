"""Write a file or a package to start from."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path

from models.errors import ScenarioError

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
MOST_CHARACTERS = 100


def write_start(
    kind: str, name: str, folder: Path = Path(), run: Path | None = None
) -> tuple[Path, str]:
    """Write what to start from; what is there already is never written over.

    Parameters
    ----------
    kind : str
        case, camera, target, dataset or pipeline.
    name : str
        The file will be NAME.toml, the package the folder NAME.
    folder : Path
        Where.
    run : Path, optional
        Of a target: the run of an unknown target that carved it.

    Returns
    -------
    place : Path
        What was written.
    advice : str
        What to type next.

    Raises
    ------
    ScenarioError
        If the name cannot be, something of that name is there, or the run has no surface.
    DatasetError
        If the run cannot be read.
    """
    from models.atomic_file import sweep_beside, write_bytes, write_text

    if run is not None and kind != "target":
        raise ScenarioError(f"expected --from with `rvbench new target`, got it with a {kind}")

    given, name = name, name if kind == "pipeline" else name.removesuffix(".toml")
    most = _most_characters(kind)
    if not NAME.fullmatch(name) or len(name) > most:
        raise ScenarioError(
            f"expected a name of letters, digits, '.', '_' and '-', {most} at most, got "
            f"{given!r:.120}; it is written into the working directory"
        )
    place = folder / (name if kind == "pipeline" else f"{name}.toml")
    _refuse_what_is_there(place)
    files: Mapping[str, str | bytes]
    if run is None:
        files, advice = _files(kind, name)
    else:
        from bench.new.target_from_run import target_from_run

        _refuse_what_is_there(folder / f"{name}.glb")
        files, advice = target_from_run(name, run), f"rvbench inspect {name}.toml"
    for file, content in files.items():
        made = place / file if kind == "pipeline" else folder / file
        sweep_beside(made)
        if isinstance(content, str):
            write_text(made, content)
        else:
            write_bytes(made, content)
    return place, advice


def _refuse_what_is_there(place: Path) -> None:
    if os.path.lexists(place):
        raise ScenarioError(
            f"expected nothing at {place} yet, there is something; nothing was changed: "
            "choose another name"
        )


def _most_characters(kind: str) -> int:
    """Return how long a name may be, so that what is written is accepted under it."""
    if kind != "dataset":
        return MOST_CHARACTERS
    from bench.random_dataset.spec_tables import MOST_FOLDER_NAME

    return MOST_FOLDER_NAME


def _files(kind: str, name: str) -> tuple[dict[str, str], str]:
    """Return the texts of what is written, by name, and what to type next."""
    if kind == "case":
        from bench.new.case_text import case_text

        return {f"{name}.toml": case_text(name)}, f"rvbench run {name}.toml --out out/{name}"
    if kind == "camera":
        from bench.new.camera_text import camera_text

        advice = f"rvbench estimate --frames DIR --camera {name}.toml --prior prior.toml"
        return {f"{name}.toml": camera_text(name)}, advice
    if kind == "dataset":
        from bench.new.dataset_text import dataset_text

        return {f"{name}.toml": dataset_text(name)}, f"rvbench dataset {name}.toml --out out/{name}"
    if kind == "target":
        from bench.inspecting.start_text import target_text

        return {f"{name}.toml": target_text(name)}, f"rvbench inspect {name}.toml"
    from bench.new.pipeline_text import pipeline_files

    return pipeline_files(name), f"pip install --editable ./{name}, then rvbench estimate DIR"
