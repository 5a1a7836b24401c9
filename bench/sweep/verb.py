"""``rvbench sweep``: the verb with its options."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from bench import api
from bench.api_options import SweepOptions
from bench.runners.options import (
    ChunkText,
    JobsOfFrames,
    RunnerName,
    Sbatch,
    SchedulerAddress,
    is_shared,
)
from bench.verbs import DONE, Case, OptionalCount, OptionalFolder, OptionalNumber
from models.plain_console import plain_console

Numbers = Annotated[tuple[float, ...], arg(metavar="NUMBER ...", help_behavior_hint="")]


@dataclass(frozen=True)
class Sweep:
    """Try one pose under Suns from everywhere, and map what came of it.

        rvbench sweep maxar-approach --range-m 2.5 --sun-step-deg 15
        rvbench sweep maxar-approach --range-m 2.5 --suns paper --out out/paper
        rvbench sweep maxar-approach --time-s 200 --suns S2 270/30 0.2,-0.5,1 --out out/three
        rvbench sweep maxar-demo --range-m 3 --sun-step-deg 30 --exposure-ms 0.05 0.2 --out out/s

    Light is traced for many Suns in one pass and kept in the store; exposures and lamp powers are
    composed from it and cost no rendering. It ends in DIR/sun_map.png, where each direction's frame
    stands in its place on the sphere, framed by whether every marker was found; in DIR/sweep.html;
    and in the table DIR/sweep.csv.

    Stop it anywhere: what is there is kept, and the same command goes on from there. In the same
    DIR other Suns, poses, exposures and lamp powers of the case may follow.

    With --runner slurm or dask, jobs on other machines each take a share of the Suns, into DIR and
    the store, which they must see; this command waits for them and draws the maps.
    docs/clusters.md tells more.
    """

    case: Positional[Case]
    """name of a case (see `rvbench list`), or a scenario file"""
    out: OptionalFolder = None
    """folder of the sweep; out/sweep-CASE unless given"""
    range_m: Numbers = ()
    """poses: the moments when the camera is so far from the ring's centre, in m"""
    time_s: Numbers = ()
    """poses: moments of the motion, in s; of stills, times of rows of their table"""
    sun_step_deg: OptionalNumber = None
    """Suns: a grid over the whole sphere with this step, which divides 180; 15 unless given"""
    suns: Annotated[tuple[str, ...], arg(metavar="SUN ...", help_behavior_hint="")] = ()
    """Suns: a list instead; `paper` (S1 to S7), names, azimuth/elevation in deg as in 270/45
    (azimuth clockwise from +y seen from +z, elevation towards +z), or vectors x,y,z towards the Sun
    in the target frame"""
    exposure_ms: Numbers = ()
    """exposure times to try; the case's own unless given"""
    lamp_w_sr: Numbers = ()
    """powers of the 800 and 850 nm lamps to try, on axis; the exposure time does not follow them"""
    pipeline: Annotated[str, arg(metavar="both|NAME")] = "both"
    """pipeline to try: both variants of ours, or one by name; the maps show best if it is there"""
    draws: Annotated[int, arg(metavar="N")] = 5
    """times that each frame is exposed, each with noise and a first pose of its own, for the
    pipeline that the maps show; they rank the kindest and the harshest Suns, and cost no light"""
    width: OptionalCount = None
    """columns of the image, the field of view stays; 1024 unless given or the case has fewer"""
    spp: OptionalCount = None
    """samples per pixel, best a power of two"""
    marker_samples: OptionalCount = None
    """samples per pixel along the outlines of the markers, best a power of two"""
    variant: Literal["auto", "llvm", "cuda", "scalar"] = "auto"
    """how Mitsuba computes; auto takes the fastest that renders here"""
    store: OptionalFolder = None
    """where rendered light is kept"""
    store_budget_gb: OptionalNumber = None
    """what that may take; the longest unused goes first (20, else $RVBENCH_STORE_BUDGET_GB)"""
    threads: OptionalCount = None
    """cores to use; all unless given"""
    memory_gb: Annotated[float, arg(metavar="NUMBER")] = 4.0
    """memory that the rendering process may take, in GiB: it sets how many Suns share a pass"""
    runner: RunnerName = "local"
    jobs: JobsOfFrames = None
    sbatch: Sbatch = ()
    scheduler: SchedulerAddress = None
    chunk: ChunkText = None

    def run(self) -> int:
        """Sweep, and say what came of it."""
        out = self.out or Path("out") / f"sweep-{Path(self.case).stem}"
        if is_shared(self):
            from bench.sweep.shared_suns import swept_share

            chunk = swept_share(self, out)
            if chunk is not None:
                print(f"chunk {chunk}: done, into {out}")
                return DONE
        result, files = api.sweep(self.case, out, **self.options())
        from bench.sweep.outcome import print_sweep

        print_sweep(plain_console(), result)
        print(f"table: {files.csv}")
        for path in files.maps:
            print(f"map:   {path.resolve()}")
        print(f"page:  {files.page.resolve()}")
        return DONE

    def options(self) -> SweepOptions:
        """Return what was asked of the sweep."""
        return {
            "range_m": self.range_m,
            "time_s": self.time_s,
            "sun_step_deg": self.sun_step_deg,
            "suns": self.suns,
            "exposure_ms": self.exposure_ms,
            "lamp_w_sr": self.lamp_w_sr,
            "pipeline": self.pipeline,
            "draws": self.draws,
            "width": self.width,
            "spp": self.spp,
            "marker_samples": self.marker_samples,
            "variant": self.variant,
            "store": self.store,
            "store_budget_gb": self.store_budget_gb,
            "threads": self.threads,
            "memory_gb": self.memory_gb,
        }
