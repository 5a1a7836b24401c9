"""The verbs of the command line: each a dataclass whose fields are its options.

A verb's ``run`` does the work, prints what it wrote to stdout, and returns the exit code.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Literal

from tyro.conf import Positional, arg

from bench import api
from bench.api_options import RenderOptions
from bench.runners.options import (
    ChunkText,
    JobsOfFrames,
    RunnerName,
    Sbatch,
    SchedulerAddress,
    is_shared,
)
from models.errors import ScenarioError
from models.lights.sun_names import SUN_NAMES
from models.plain_console import plain_console

DONE, WORSE = 0, 1
SUN_HELP = (
    f"where the Sun stands: {SUN_NAMES} (`rvbench list`), or a vector towards it in the target "
    "frame; of a tumbling target a vector in the orbit's inertial frame"
)

Case = Annotated[str, arg(metavar="CASE")]
Folder = Annotated[Path, arg(metavar="DIR")]
File = Annotated[Path, arg(metavar="FILE")]
OptionalFile = Annotated[Path | None, arg(metavar="FILE", help_behavior_hint="")]
OptionalFolder = Annotated[Path | None, arg(metavar="DIR", help_behavior_hint="")]
OptionalNumber = Annotated[float | None, arg(metavar="NUMBER", help_behavior_hint="")]
OptionalCount = Annotated[int | None, arg(metavar="N", help_behavior_hint="")]


@dataclass(frozen=True)
class Render:
    """Render a case into a dataset.

        rvbench render maxar-approach --sun S4 --rate-hz 0.1 --out out/s4
        rvbench render xmm-tumble --width 1024 --out out/xmm
        rvbench render xmm-tumble --runner slurm --jobs 20 --sbatch time=1:00:00 --out out/xmm

    Stop it anywhere: what is there is kept, and the same command goes on from there.
    """

    case: Positional[Case]
    """name of a case (see `rvbench list`), or a scenario file"""
    out: Folder
    """folder of the dataset"""
    sun: Annotated[str | None, arg(metavar="NAME|x,y,z", help=SUN_HELP, help_behavior_hint="")] = (
        None
    )
    rate_hz: OptionalNumber = None
    """image pairs, or single images, a second"""
    span_s: Annotated[tuple[float, float] | None, arg(metavar="FROM TO", help_behavior_hint="")] = (
        None
    )
    """part of the motion, in s"""
    width: OptionalCount = None
    """columns of the image; the field of view stays"""
    spp: OptionalCount = None
    """samples per pixel, best a power of two"""
    variant: Literal["auto", "llvm", "cuda", "scalar"] = "auto"
    """how Mitsuba computes; auto takes the fastest that renders here"""
    store: OptionalFolder = None
    """where rendered light is kept, to be shared by the Suns of a case"""
    store_budget_gb: OptionalNumber = None
    """what that may take; the longest unused goes first (20, else $RVBENCH_STORE_BUDGET_GB)"""
    keep_light: Literal["all", "some", "none"] = "all"
    """whose light groups to keep: those of all frames, of some, or of none"""
    keep_every: OptionalCount = None
    """with `--keep-light some`, frames from one that keeps its light to the next (10)"""
    threads: OptionalCount = None
    """cores to use; all unless given"""
    runner: RunnerName = "local"
    jobs: JobsOfFrames = None
    sbatch: Sbatch = ()
    scheduler: SchedulerAddress = None
    chunk: ChunkText = None

    def run(self) -> int:
        """Render."""
        if self.is_share_alone():
            return DONE
        api.render(self.case, self.out, **self.options())
        print(f"frames: {self.out / 'frames'}")
        return DONE

    def is_share_alone(self) -> bool:
        """Have frames rendered elsewhere, or a share of them here; tell whether that was all."""
        if not is_shared(self):
            return False
        from bench.runners.rendering import rendered_share

        chunk = rendered_share(self)
        if chunk is None:
            return False
        print(f"chunk {chunk}: done, into {self.out}")
        return True

    def options(self) -> RenderOptions:
        """Return what was asked of the rendering."""
        start_s, end_s = self.span_s if self.span_s is not None else (None, None)
        return {
            "sun": self.sun,
            "rate_hz": self.rate_hz,
            "start_s": start_s,
            "end_s": end_s,
            "width": self.width,
            "spp": self.spp,
            "variant": self.variant,
            "store": self.store,
            "store_budget_gb": self.store_budget_gb,
            "keep_light": self.keep_light,
            "keep_every": self.keep_every,
            "threads": self.threads,
        }


@dataclass(frozen=True)
class Run(Render):
    """Render what is missing, estimate, score and report.

        rvbench run maxar-demo --out out/demo
        rvbench run maxar-approach --sun S2 --rate-hz 0.1 --seeds 10 --out out/s2
        rvbench run maxar-approach --sun 0.2,-0.5,1 --span-s 200 330 --out out/mine
        rvbench run xmm-tumble --out out/xmm

    Stop it anywhere: what is there is kept, and the same command goes on from there.
    """

    seeds: Annotated[int, arg(metavar="N")] = 1
    """runs over the same light, each with its own detector noise and prior"""

    def run(self) -> int:
        """Do the whole job."""
        if self.is_share_alone():
            return DONE
        scored = api.run(self.case, self.out, seeds=self.seeds, **self.options())
        print_score(scored)
        print(f"score:  {self.out / 'score.json'}")
        print(f"report: {(self.out / 'report.html').resolve()}")
        return DONE


@dataclass(frozen=True)
class Estimate:
    """Run pipelines on a dataset, or on anybody's frames.

        rvbench estimate out/demo
        rvbench estimate --frames pairs --camera camera.toml --target maxar1300
        rvbench estimate --frames images --camera camera.toml --target xmm

    Image pairs are NAME_800.png and NAME_850.png (or .tif, or .jpg), single images have any other
    names; grey, 8 or 16 bits, taken in order of name. Pairs need a prior.toml, single images a
    knowledge.toml and a navigation.csv, in or beside the folder; docs/formats.md tells of each.
    """

    folder: Positional[OptionalFolder] = None
    """a dataset; only its public half is read"""
    frames: OptionalFolder = None
    """a folder of image pairs or single images, instead of a dataset"""
    camera: OptionalFile = None
    """the camera that took them: width, height, fx, fy, cx, cy and distortion, in px"""
    target: Annotated[str, arg(metavar="NAME|FILE")] = "maxar1300"
    """what they show: a target's name, the TOML of one of your own, or a markers.toml or
    wireframe.json"""
    prior: OptionalFile = None
    """the first pose; else prior.toml in or beside the folder of the frames"""
    knowledge: OptionalFile = None
    """mount and expected sigmas; else knowledge.toml in or beside the folder"""
    navigation: OptionalFile = None
    """the chaser's orbit; else navigation.csv in or beside the folder"""
    detector: OptionalFile = None
    """the detector; else guessed from the bits of the images"""
    rate_hz: Annotated[float, arg(metavar="NUMBER")] = 5.0
    """frames a second, where there is no frames.csv in or beside the folder"""
    out: OptionalFolder = None
    """where the estimates of those frames go; else with the frames"""
    pipelines: Annotated[tuple[str, ...], arg(metavar="NAME", help_behavior_hint="")] = ()
    """which pipelines; all that suit, other packages' too, unless given"""
    time_limit_s: OptionalNumber = None
    """most that a pipeline may take for a frame, in s; longer, and the frame is lost"""

    def run(self) -> int:
        """Estimate.

        Raises
        ------
        ScenarioError
            If there is neither a dataset nor a folder of frames, or both; if options of frames come
            with a dataset, or frames without a camera.
        RvbenchError
            Each says what to do.
        """
        if (self.folder is None) == (self.frames is None):
            raise ScenarioError(
                "expected either a dataset, `rvbench estimate DIR`, or anybody's frames, "
                "`rvbench estimate --frames DIR --camera FILE`; "
                f"got {'neither' if self.folder is None else 'both'}"
            )
        if self.folder is not None:
            self._refuse_options_of_frames()
        paths = (
            self._frames()
            if self.folder is None
            else api.estimate(self.folder, pipelines=self.pipelines, time_limit_s=self.time_limit_s)
        )
        for path in paths:
            print(f"estimates: {path}")
        return DONE

    def _refuse_options_of_frames(self) -> None:
        typed = [
            f"--{field.name.replace('_', '-')}"
            for field in fields(self)
            if field.name not in ("folder", "pipelines", "time_limit_s")
            and getattr(self, field.name) != field.default
        ]
        if typed:
            raise ScenarioError(
                f"expected {' and '.join(typed)} only with --frames, got it with the dataset "
                f"{self.folder}, which holds its own; "
                f"for other knowledge: `rvbench estimate --frames {self.folder}/frames ...`"
            )

    def _frames(self) -> list[Path]:
        from bench.estimating.foreign_frames import estimate_frames
        from bench.estimating.foreign_knowledge import GivenFiles
        from models.camera import Camera

        assert self.frames is not None
        if self.camera is None:
            raise ScenarioError(
                "expected --camera FILE with --frames: a TOML file with width, height, fx, fy, cx "
                "and cy in px (pixel centres are integers), and k1, k2, p1, p2, k3 if it distorts"
            )
        return estimate_frames(
            self.frames,
            Camera.from_toml(self.camera),
            GivenFiles(self.target, self.prior, self.detector, self.knowledge, self.navigation),
            rate_hz=self.rate_hz,
            out=self.out or self.frames,
            pipelines=self.pipelines,
            limit_s=self.time_limit_s,
        )


@dataclass(frozen=True)
class Report:
    """Write one HTML file that shows what was run and how wrong it was.

        rvbench report out/demo

    It opens offline: pictures, figures and tables are all in it.
    """

    folder: Positional[Folder]
    """a scored dataset"""

    def run(self) -> int:
        """Report."""
        print(f"report: {api.report(self.folder).resolve()}")
        return DONE


@dataclass(frozen=True)
class Show:
    """Draw one frame: both images, their difference, every marker's pixels, and the errors.

        rvbench show out/demo 3
        rvbench show out/demo 3 --variant paper --out frame3.png
        rvbench show out/xmm 120

    Red circles are detections, green diamonds reprojections, cyan crosses the truth. Of a target
    without markers the wireframe is drawn: green as estimated, cyan as it truly was.
    """

    folder: Positional[Folder]
    """a dataset; estimates and truth are drawn where it has them"""
    frame: Positional[Annotated[int, arg(metavar="FRAME")]]
    """number of the frame"""
    variant: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    """whose estimates to draw; best's unless given, or of the first that has spoken"""
    out: OptionalFile = None
    """the picture; else DIR/show/FRAME_NAME.png, or FRAME.png where nothing was estimated"""

    def run(self) -> int:
        """Draw and write the picture."""
        from bench.estimating.runs import spoken_variant
        from bench.pictures.our_picture import check_picture_place

        variant = self.variant or spoken_variant(self.folder)
        name = f"{self.frame:06d}{f'_{variant}' if variant else ''}.png"
        out = self.out or self.folder / "show" / name
        if self.out is not None:
            check_picture_place(self.out)
        api.show(self.folder, self.frame, out, variant)
        print(f"picture: {out}")
        return DONE


@dataclass(frozen=True)
class List:
    """List the cases, cameras, targets, Suns and suites there are."""

    def run(self) -> int:
        """Print the lists."""
        from bench.listing import print_listing

        print_listing(plain_console())
        return DONE


@dataclass(frozen=True)
class Doctor:
    """Say what this machine has, which Mitsuba variants really render, and what to do about it."""

    def run(self) -> int:
        """Examine."""
        from bench.doctor import doctor

        return doctor()


def print_score(scored: dict[str, Any]) -> None:
    """Print a score's headline table."""
    from bench.chains.catalogue import chain_named
    from bench.report.summary import print_summary

    print_summary(plain_console(), scored, chain_named(scored["chain"]).headline(scored))
