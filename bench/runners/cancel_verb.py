"""``rvbench cancel``: end the jobs of a folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from bench.verbs import DONE
from models.errors import RunnerError


@dataclass(frozen=True)
class Cancel:
    """Cancel the jobs that --runner slurm or dask has at work for a folder.

        rvbench cancel out/pesce

    What is done is kept: the command that submitted them submits the rest.
    """

    folder: Positional[Annotated[Path, arg(metavar="DIR")]]
    """what the command had as --out"""

    def run(self) -> int:
        """Cancel.

        Raises
        ------
        RunnerError
            If nothing was submitted from there, or the cluster does not answer.
        """
        from bench.runners.cluster_run import cancel

        record = cancel(self.folder)
        if record is None:
            raise RunnerError(
                f"expected the folder of a command with --runner slurm or dask, {self.folder} has "
                "no job"
            )
        print(f"cancelled: {record.name}, {record.runner}")
        return DONE
