"""Jobs for either renderer: what to render, run in a process of its own, with its clock and memory.

A job is a JSON file; ``our_side`` and ``blender_side`` read the same one. Each notes the time of
day and its processor time when its imports are done, the scene is ready, each image is rendered and
written, so that the start-up can be told apart from the light.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from models.arrays import Radiance
from models.errors import RvbenchError
from models.pose import RigidTransform

HOUSE = Path(__file__).resolve().parents[2]
ORACLE_PYTHON = HOUSE / ".venv-oracle" / "bin" / "python"
BLENDER_SIDE = Path(__file__).with_name("blender_side.py")
OURS, BARE, CYCLES = "rvbench", "mitsuba", "cycles"
LAST_WORDS = 2000  # characters of a failed process's output that are shown


class SideFailed(RvbenchError):
    """A renderer's process that did not do its job; its last words say why."""


@dataclass(frozen=True)
class Task:
    """One image file: some Suns, each in a channel of its own.

    Attributes
    ----------
    suns : tuple of str
        Names within the scene; rvbench renders them in one pass, Cycles as light groups.
    samples : int
        Per pixel, a square number.
    seed : int
    out : Path
    cam_from_target : RigidTransform or None
        Where the camera is, if not where the scene has it.
    """

    suns: tuple[str, ...]
    samples: int
    seed: int
    out: Path
    cam_from_target: RigidTransform | None = None

    def table(self) -> dict[str, Any]:
        """Return the image as both sides read it."""
        view = self.cam_from_target.inverse() if self.cam_from_target else None
        return {
            "suns": self.suns,
            "samples": self.samples,
            "seed": self.seed,
            "out": str(self.out.resolve()),
            "target_from_cam": view
            and {"rotation": view.rotation.tolist(), "translation": view.translation.tolist()},
        }


@dataclass(frozen=True)
class Job:
    """What one process does.

    Attributes
    ----------
    side : str
        ``rvbench``, ``mitsuba`` (its own path integrator) or ``cycles``.
    scene : Path
        Folder of the neutral scene.
    tasks : tuple of Task
        In this order, the scene kept between them.
    max_depth : int
        Surface interactions of a path.
    threads : int
        For Cycles; rvbench takes the processors that the process may use.
    truth : Path or None
        Where rvbench writes what each pixel shows (``OurRenderer.truth``).
    cycles : dict
        Settings of Cycles beyond those of ``blender_side``.
    """

    side: str
    scene: Path
    tasks: tuple[Task, ...]
    max_depth: int = 4
    threads: int = 2
    truth: Path | None = None
    cycles: dict[str, Any] = field(default_factory=dict)

    def table(self) -> dict[str, Any]:
        """Return the job as both sides read it."""
        return {
            "scene": str(self.scene.resolve()),
            "renders": [task.table() for task in self.tasks],
            "max_depth": self.max_depth,
            "threads": self.threads,
            "integrator": "path" if self.side == BARE else "groups",
            "variant": "auto",
            "persistent": len(self.tasks) > 1,
            "truth": str(self.truth.resolve()) if self.truth else "",
            "cycles": self.cycles,
        }


@dataclass(frozen=True)
class Effort:
    """What a process took.

    Attributes
    ----------
    whole_s : float, s
        From its start to its end.
    import_s, scene_s : float, s
        Its start-up: until its libraries are loaded, and from there until its scene is built.
    rendered_s : tuple of float, s
        Each task's light, without the writing of its file.
    processor_s : float, s
        Of all cores: what other work on the machine cannot change much.
    rendered_processor_s : tuple of float, s
        The same for each task's light.
    peak_mib : float, MiB
        The most resident memory it had (its own largest child included).
    """

    whole_s: float
    import_s: float
    scene_s: float
    rendered_s: tuple[float, ...]
    processor_s: float
    rendered_processor_s: tuple[float, ...]
    peak_mib: float


def command(side: str) -> list[str]:
    """Return the command of a side, but for its job.

    Raises
    ------
    SideFailed
        If Cycles is asked for and its environment is missing.
    """
    if side != CYCLES:
        return [sys.executable, "-P", "-m", "bench.cycles.our_side"]
    if not ORACLE_PYTHON.exists():
        raise SideFailed(
            f"expected Blender's environment in {ORACLE_PYTHON.parents[1]}, got nothing; "
            "run `make oracle` or `make speed`, which set it up"
        )
    return [str(ORACLE_PYTHON), str(BLENDER_SIDE)]


def run(job: Job, folder: Path, kernels: Path | None = None) -> Effort:
    """Run a job in a process of its own and wait for it.

    Parameters
    ----------
    job : Job
    folder : Path
        For the job's file, clock and log.
    kernels : Path, optional
        Where Dr.Jit keeps its compiled kernels, if not in the user's own cache.

    Raises
    ------
    SideFailed
        If the process fails.
    """
    folder.mkdir(parents=True, exist_ok=True)
    job_file = folder / f"{job.side}.json"
    job_file.write_text(json.dumps(job.table(), indent=1))
    words = folder / f"{job.side}.log"
    with words.open("wb") as log:
        started, tick = time.time(), time.perf_counter()
        process = subprocess.Popen(
            [*command(job.side), str(job_file)],
            cwd=HOUSE,
            env=os.environ | ({"DRJIT_CACHE_DIR": str(kernels.resolve())} if kernels else {}),
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        _, status, usage = os.wait4(process.pid, 0)
        whole_s = time.perf_counter() - tick
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        said = words.read_text(errors="replace")[-LAST_WORDS:].strip()
        raise SideFailed(
            f"expected {job.side} to render {job_file}, got exit code {process.returncode}:\n{said}"
        )
    clock = json.loads(job_file.with_suffix(".clock.json").read_text())
    return effort(clock, started, whole_s, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def effort(
    clock: Sequence[tuple[str, float, float]],
    started: float,
    whole_s: float,
    processor_s: float,
    peak_mib: float,
) -> Effort:
    """Return what a process took from its clock.

    Parameters
    ----------
    clock : sequence of (str, float, float), s
        (event, time of day, processor time) readings, in order: imported, ready, then rendered and
        written for each image.
    started : float, s
        Time of day at which the process was started.
    whole_s, processor_s : float, s
        Of the whole process, as its parent saw it.
    peak_mib : float, MiB
        Most memory at once.
    """
    at = {event: moment for event, moment, _ in clock[:2]}
    rendered, worked = [], []
    for (_, before, spent), (event, moment, work) in pairwise(clock[1:]):
        if event == "rendered":
            rendered.append(moment - before)
            worked.append(work - spent)
    return Effort(
        whole_s=whole_s,
        import_s=at["imported"] - started,
        scene_s=at["ready"] - at["imported"],
        rendered_s=tuple(rendered),
        processor_s=processor_s,
        rendered_processor_s=tuple(worked),
        peak_mib=peak_mib,
    )


def read_radiance(path: Path, suns: Sequence[str]) -> dict[str, Radiance]:
    """Read the image of each Sun from a file of either side.

    Cycles calls them ``R`` where there is one and ``ViewLayer.Combined_NAME.R`` where there are
    light groups; ours is the name itself.

    Returns
    -------
    dict of str to (height, width) arrays, W m-2 sr-1
        By Sun.

    Raises
    ------
    KeyError
        If one is missing.
    """
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {key: part.channels[key] for part in file.parts for key in part.channels}
        images = {}
        for name in suns:
            wanted = [name, f"ViewLayer.Combined_{name}.R"] + (["R"] if len(suns) == 1 else [])
            found = [key for key in wanted if key in channels]
            if not found:
                raise KeyError(f"{path}: expected a channel among {wanted}, got {list(channels)}")
            images[name] = np.array(channels[found[0]].pixels)
    return images
