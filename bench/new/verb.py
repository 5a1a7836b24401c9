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
    """Write a file to start from, every key explained, into the working directory.

        rvbench new case mine
        rvbench new camera my-camera

    A case runs as it is: `rvbench run mine.toml --out out/mine`. A file that is there already is
    never written over.
    """

    kind: Positional[Annotated[Literal["case", "camera"], arg(metavar="case|camera")]]
    """a scenario, or a camera for `rvbench estimate --frames`"""
    name: Positional[Annotated[str, arg(metavar="NAME")]]
    """the file will be NAME.toml"""

    def run(self) -> int:
        """Write it, and say what to do with it."""
        from models.atomic_file import write_text

        name = self.name.removesuffix(".toml")
        if not NAME.fullmatch(name):
            raise ScenarioError(
                f"expected a name of letters, digits, '.', '_' and '-', got {self.name!r}; it is "
                "written into the working directory"
            )
        path = Path(f"{name}.toml")
        if os.path.lexists(path):
            raise ScenarioError(
                f"expected no file at {path} yet, there is one; nothing was changed: "
                "choose another name"
            )
        if self.kind == "case":
            from bench.new.case_text import case_text

            write_text(path, case_text(name))
            print(f"case: {path}")
            print(f"try:  rvbench run {path} --out out/{name}")
            return DONE
        from bench.new.camera_text import camera_text

        write_text(path, camera_text(name))
        print(f"camera: {path}")
        print(f"try:    rvbench estimate --frames DIR --camera {path} --prior prior.toml")
        return DONE
