"""``rvbench new``: the verb."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from models.errors import ScenarioError

DONE = 0
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


@dataclass(frozen=True)
class New:
    """Write what to start from, explained line by line, into the working directory.

        rvbench new case mine
        rvbench new camera my-camera
        rvbench new pipeline my-finder

    A case runs as it is: `rvbench run mine.toml --out out/mine`. So does a pipeline, a package of
    one module: `pip install --editable ./my-finder`, and it estimates beside ours; it finds nothing
    until you write what it does. What is there already is never written over.
    """

    kind: Positional[
        Annotated[Literal["case", "camera", "pipeline"], arg(metavar="case|camera|pipeline")]
    ]
    """a scenario, a camera for `rvbench estimate --frames`, or a package with a pipeline"""
    name: Positional[Annotated[str, arg(metavar="NAME")]]
    """the file will be NAME.toml, the package the folder NAME"""

    def run(self) -> int:
        """Write it, and say what to do with it.

        Raises
        ------
        ScenarioError
            If the name cannot be, or something of that name is there.
        """
        from models.atomic_file import write_text

        name = self.name if self.kind == "pipeline" else self.name.removesuffix(".toml")
        if not NAME.fullmatch(name):
            raise ScenarioError(
                f"expected a name of letters, digits, '.', '_' and '-', got {self.name!r}; it is "
                "written into the working directory"
            )
        place = Path(name if self.kind == "pipeline" else f"{name}.toml")
        if os.path.lexists(place):
            raise ScenarioError(
                f"expected nothing at {place} yet, there is something; nothing was changed: "
                "choose another name"
            )
        files, advice = _files(self.kind, name)
        for file, text in files.items():
            write_text(place / file if self.kind == "pipeline" else Path(file), text)
        print(f"{self.kind}: {place}")
        print(f"try: {advice}")
        return DONE


def _files(kind: str, name: str) -> tuple[dict[str, str], str]:
    """Return the texts of what is written, by name, and what to type next."""
    if kind == "case":
        from bench.new.case_text import case_text

        return {f"{name}.toml": case_text(name)}, f"rvbench run {name}.toml --out out/{name}"
    if kind == "camera":
        from bench.new.camera_text import camera_text

        advice = f"rvbench estimate --frames DIR --camera {name}.toml --prior prior.toml"
        return {f"{name}.toml": camera_text(name)}, advice
    from bench.new.pipeline_text import pipeline_files

    return pipeline_files(name), f"pip install --editable ./{name}, then rvbench estimate DIR"
