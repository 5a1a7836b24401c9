"""``rvbench new``: the verb."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from tyro.conf import Positional, arg

DONE = 0


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
        """Write it, and say what to do with it."""
        from bench.new.start import write_start

        place, advice = write_start(self.kind, self.name)
        print(f"{self.kind}: {place}")
        print(f"try: {advice}")
        return DONE
