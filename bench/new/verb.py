"""``rvbench new``: the verb."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

DONE = 0


@dataclass(frozen=True)
class New:
    """Write what to start from, explained line by line, into the working directory.

        rvbench new case mine
        rvbench new camera my-camera
        rvbench new target my-probe
        rvbench new target carved --from out/xmm
        rvbench new dataset my-frames
        rvbench new pipeline my-finder

    A case runs as it is: `rvbench run mine.toml --out out/mine`. So does a dataset, sixty small
    frames: `rvbench dataset my-frames.toml --out out/my-frames`. So does a pipeline, a package of
    one module: `pip install --editable ./my-finder`, and it estimates beside ours; it finds nothing
    until you write what it does. A target goes beside a mesh, my-probe.glb; where that is there,
    `rvbench inspect my-probe.glb` writes more of it. With --from it is what a run of an unknown
    target carved, TOML and mesh. What is there already is never written over.
    """

    kind: Positional[
        Annotated[
            Literal["case", "camera", "target", "dataset", "pipeline"],
            arg(metavar="case|camera|target|dataset|pipeline"),
        ]
    ]
    """a scenario, a camera for `rvbench estimate --frames`, a spacecraft, a specification of a
    random dataset, or a package with a pipeline"""
    name: Positional[Annotated[str, arg(metavar="NAME")]]
    """the file will be NAME.toml, the package the folder NAME"""
    run_folder: Annotated[Path | None, arg(name="from", metavar="DIR", help_behavior_hint="")] = (
        None
    )
    """of a target: the run of an unknown target that carved it"""

    def run(self) -> int:
        """Write it, and say what to do with it."""
        from bench.new.start import write_start

        place, advice = write_start(self.kind, self.name, run=self.run_folder)
        print(f"{self.kind}: {place}")
        print(f"try: {advice}")
        return DONE
