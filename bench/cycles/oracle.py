"""``make oracle``: our light against Blender Cycles', on the same scene, solved as one problem.

Three Suns on the Maxar target; mean radiance by region and by kind of material, shadow edges, and
a Lambertian plate whose radiance is known in closed form. Pictures, a table and a JSON file.
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import trimesh

from bench.cycles import regions, shadow_edges
from bench.cycles.jobs import CYCLES, OURS, Job, Task, read_radiance, run
from bench.cycles.neutral_scene import NeutralMaterial, NeutralScene
from bench.cycles.oracle_tables import print_plate, print_regions, print_verdict
from bench.cycles.pictures import save_side_by_side
from bench.cycles.regions import RegionMeans, compare_regions, kind_of
from bench.cycles.scene_export import maxar_scene, neutral_meshes, neutral_sun
from bench.cycles.shadow_edges import EdgeShifts, edge_shifts, find_edges
from models.arrays import AnyArray, Radiance
from models.camera import Camera
from models.errors import RvbenchError
from models.lights.sun import sun_direction
from models.plain_console import plain_console
from models.pose import RigidTransform
from models.spacecraft.part import Part

SUNS = ("S2", "S5", "S7")  # from either side at 45 deg, and nearly behind the camera
PLATE_ALBEDO = 0.5
PLATE_TOLERANCE = 1e-3
PLATE_ANGLES_DEG = (0.0, 60.0)


@dataclass(frozen=True)
class SunVerdict:
    """What came of one Sun."""

    sun: str
    whole: RegionMeans
    kinds: list[RegionMeans]
    regions: list[RegionMeans]
    edges: EdgeShifts

    @property
    def agrees(self) -> bool:
        """Whether every kind of material and every telling region agrees, and the edges do.

        A kind that noise hides is no agreement: it asks for more samples.
        """
        judged = [*self.kinds, *(region for region in self.regions if region.telling)]
        told = all(kind.telling for kind in self.kinds)
        return told and all(region.agrees for region in judged) and self.edges.agrees


@dataclass(frozen=True)
class PlateVerdict:
    """Radiance of a Lambertian plate, W m-2 sr-1, and of its closed form E rho cos / pi."""

    angle_deg: float
    expected: float
    ours: float
    theirs: float

    @property
    def agrees(self) -> bool:
        """Whether both renderers give the closed form."""
        return all(
            abs(found / self.expected - 1.0) <= PLATE_TOLERANCE
            for found in (self.ours, self.theirs)
        )


def plate_scene() -> NeutralScene:
    """Return a Lambertian plate that fills the image, under Suns at the angles of the check."""
    plate = Part("plate", trimesh.creation.box((8.0, 8.0, 0.02)), "lambert")
    facing = np.diag([1.0, -1.0, -1.0])
    suns = tuple(
        neutral_sun(f"at{angle:.0f}", np.array([np.sin(t), 0.0, np.cos(t)]))
        for angle, t in zip(PLATE_ANGLES_DEG, np.deg2rad(PLATE_ANGLES_DEG), strict=True)
    )
    return NeutralScene(
        camera=Camera.from_fov(32, 32, 50.0),
        cam_from_target=RigidTransform(facing, np.array([0.0, 0.0, 3.0])),
        suns=suns,
        materials={"lambert": NeutralMaterial(PLATE_ALBEDO, 0.0, 1.0)},
        meshes=tuple(neutral_meshes((plate,), RigidTransform(np.eye(3), np.zeros(3)))),
    )


def render_both(
    scene: NeutralScene, samples: int, seeds: int, folder: Path
) -> tuple[dict[str, list[Radiance]], dict[str, list[Radiance]], dict[str, AnyArray]]:
    """Render every Sun of a scene on its own, by both.

    Ours shares one pass between the Suns, as it would for a user.

    Parameters
    ----------
    scene : NeutralScene
    samples : int
        Per pixel.
    seeds : int
        Images of each Sun by each side, seeded 0, 1, ...
    folder : Path
        For scene, jobs and images.

    Returns
    -------
    ours, theirs : dict of str to list of (height, width) arrays, W m-2 sr-1
        By Sun, one image a seed.
    truth : dict of str to (height, width) or (height, width, 3) arrays
        As ``OurRenderer.truth`` names it.
    """
    scene.write(folder / "scene")
    names = tuple(sun.name for sun in scene.suns)
    ours = tuple(Task(names, samples, seed, folder / f"ours_{seed}.exr") for seed in range(seeds))
    theirs = tuple(
        Task((name,), samples, seed, folder / f"cycles_{name}_{seed}.exr")
        for name in names
        for seed in range(seeds)
    )
    truth = folder / "truth.npz"
    run(Job(OURS, folder / "scene", ours, truth=truth), folder)
    run(Job(CYCLES, folder / "scene", theirs), folder)
    passes = [read_radiance(task.out, names) for task in ours]
    with np.load(truth) as arrays:
        return (
            {name: [image[name] for image in passes] for name in names},
            {
                name: [read_radiance(t.out, (name,))[name] for t in theirs if t.suns == (name,)]
                for name in names
            },
            dict(arrays),
        )


def check_plate(folder: Path) -> list[PlateVerdict]:
    """Hold both renderers to the closed form of a Lambertian plate."""
    scene = plate_scene()
    ours, theirs, _ = render_both(scene, 64, 2, folder)
    return [
        PlateVerdict(
            angle_deg=angle,
            expected=sun.irradiance_w_m2 * PLATE_ALBEDO * sun.direction_in_target[2] / np.pi,
            ours=float(np.mean(ours[sun.name])),
            theirs=float(np.mean(theirs[sun.name])),
        )
        for angle, sun in zip(PLATE_ANGLES_DEG, scene.suns, strict=True)
    ]


def check_maxar(size_px: int, samples: int, seeds: int, folder: Path) -> list[SunVerdict]:
    """Compare the two renderers on the Maxar target, and save their pictures side by side.

    Parameters
    ----------
    size_px : int, px
        Width and height.
    samples : int
        Per pixel.
    seeds : int
        Images of each Sun by each side.
    folder : Path
    """
    scene = maxar_scene(size_px, tuple(neutral_sun(name, sun_direction(name)) for name in SUNS))
    ours, theirs, truth = render_both(scene, samples, seeds, folder)
    kinds = {mesh.region: kind_of(scene.materials[mesh.material]) for mesh in scene.meshes}
    verdicts = []
    for name in SUNS:
        totals, parts = compare_regions(
            truth["labels"], scene.regions, kinds, ours[name], theirs[name]
        )
        mean_ours, mean_theirs = np.mean(ours[name], axis=0), np.mean(theirs[name], axis=0)
        edges = find_edges(
            truth["labels"], truth["normals"], truth[f"facing_{name}"], truth[f"lit_{name}"]
        )
        everywhere = np.ones(mean_ours.shape, dtype=bool)
        verdicts.append(
            SunVerdict(
                sun=name,
                whole=regions.region_means("whole image", everywhere, ours[name], theirs[name]),
                kinds=totals,
                regions=parts,
                edges=edge_shifts(mean_ours, mean_theirs, edges),
            )
        )
        save_side_by_side(folder / f"oracle_{name}.png", name, mean_ours, mean_theirs)
    return verdicts


def report(plate: list[PlateVerdict], suns: list[SunVerdict], settings: dict[str, int]) -> str:
    """Return everything that was found as JSON.

    Parameters
    ----------
    plate : list of PlateVerdict
    suns : list of SunVerdict
    settings : dict of str to int
        What was asked for.
    """
    return json.dumps(
        {
            "settings": settings,
            "tolerances": {
                "region": regions.TOLERANCE,
                "shadow_edge_px": shadow_edges.TOLERANCE_PX,
                "plate": PLATE_TOLERANCE,
            },
            "mapping": "Cycles Glossy BSDF, GGX (single scattering), roughness = sqrt(alpha)",
            "plate": [asdict(row) | {"agrees": row.agrees} for row in plate],
            "suns": [asdict(sun) | {"agrees": sun.agrees} for sun in suns],
        },
        indent=1,
    )


def main() -> int:
    """Run the check; exit code 0 if the two agree, 1 if not, 2 if it could not run."""
    parser = argparse.ArgumentParser(prog="make oracle", description=__doc__)
    parser.add_argument("--size-px", type=int, default=768)
    parser.add_argument("--samples", type=int, default=256, help="per pixel and seed")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--out", type=Path, default=Path("out/oracle"))
    options = parser.parse_args()
    console = plain_console(width=None if sys.stdout.isatty() else 110)
    try:
        plate = check_plate(options.out / "plate")
        suns = check_maxar(options.size_px, options.samples, options.seeds, options.out / "maxar")
    except RvbenchError as error:
        console.print(str(error), markup=False)
        return 2
    settings = {name: getattr(options, name) for name in ("size_px", "samples", "seeds")}
    (options.out / "oracle.json").write_text(report(plate, suns, settings))
    print_plate(console, plate)
    for sun in suns:
        print_regions(console, sun)
    agreed = all(row.agrees for row in plate) and all(sun.agrees for sun in suns)
    print_verdict(console, agreed, options.out)
    return 0 if agreed else 1


if __name__ == "__main__":
    sys.exit(main())
