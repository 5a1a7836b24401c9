"""What a job starts with: our Python, our code, our folder, and the environment of who submitted.

Whatever else the submitter's environment holds comes by SLURM's own ``--export``, which a site may
have set to nothing.
"""

from __future__ import annotations

import os
import shlex
import sys
from pathlib import Path

from bench.runners.job_record import token_path
from bench.runners.shared_work import SharedWork

HOUSE = Path(__file__).resolve().parents[2]
KEPT = ("PATH", "HOME", "LD_LIBRARY_PATH", "DRJIT_LIBLLVM_PATH", "XDG_CACHE_HOME",
        "PYTHONPYCACHEPREFIX", "PYTHONDONTWRITEBYTECODE")  # fmt: skip
OURS = "RVBENCH_"
NOT_SHARED_CODE = 75


def job_environment() -> dict[str, str]:
    """Return the variables that a job gets, those of the submitter that matter to us."""
    kept = {
        name: value for name, value in os.environ.items() if name in KEPT or name.startswith(OURS)
    }
    path = os.environ.get("PYTHONPATH", "")
    return {**kept, "PYTHONPATH": os.pathsep.join(filter(None, [str(HOUSE), path]))}


def python_command(arguments: list[str]) -> list[str]:
    """Return the command that does what ``rvbench ARGUMENTS`` does, whatever the path holds."""
    return [sys.executable, "-P", "-m", "bench", *arguments]


def job_script(work: SharedWork, name: str) -> str:
    """Return the script that SLURM runs for each task of an array.

    Parameters
    ----------
    work : SharedWork
    name : str
        Of the job.
    """
    place = shlex.quote(str(work.place.absolute()))
    token = shlex.quote(str(token_path(work.place.absolute(), name)))
    command = shlex.join(python_command([*work.arguments, "--chunk"]))
    exports = [f"export {key}={shlex.quote(text)}" for key, text in job_environment().items()]
    return "\n".join(
        [
            "#!/bin/sh",
            f"# Chunk SLURM_ARRAY_TASK_ID of {work.chunks}, of a command of rvbench.",
            *exports,
            f"if ! grep -qx {name} {token}; then",
            '    echo "$(hostname): expected the folder of who submitted, found it not shared" >&2',
            f"    exit {NOT_SHARED_CODE}",
            "fi",
            f"cd {shlex.quote(os.getcwd())} || exit {NOT_SHARED_CODE}",
            f"mkdir -p {place}/started",
            f"started={place}/started/.$SLURM_ARRAY_TASK_ID.$(hostname)-$$",
            f'echo "{name} $(hostname)" >"$started"',
            f'mv "$started" {place}/started/"$SLURM_ARRAY_TASK_ID"',
            f'exec {command} "$SLURM_ARRAY_TASK_ID/{work.chunks}"',
            "",
        ]
    )
