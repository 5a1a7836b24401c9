"""The parts of a random dataset: one for each target, camera and specimen, each a scenario."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from bench.random_dataset.draws import STARS, Aim, rng_of
from bench.random_dataset.spec_tables import Spec, SpecCameraTable, TargetTable
from models.camera import Camera
from models.errors import ScenarioError
from models.motion.pose_table import EARTH, EXPOSURE, SUN, pose_columns
from models.motion.pose_table import STARS as STARS_COLUMN
from models.sensors.camera_chip import Detector
from renders.scenario.camera_choice import camera_of
from renders.scenario.errors import explain
from renders.scenario.own_target import target_has_markers, target_of, with_own_target_read
from renders.scenario.scenario import Scenario, check_scenario
from renders.scenario.surface_tables import SurfaceTable, materials_of

SEEDS, SURFACES, LENS, STARS_ATTITUDE = 11, 12, 13, 14  # purposes that key the draws
MOST_ROWS = 50_000  # a scenario holds its table
MOST_SIGMAS = 3.0
COLUMNS = (*pose_columns("cam_from_target"), *SUN, EXPOSURE, *EARTH, STARS_COLUMN)
OF_A_CHOICE = ("name", "range_factor", "optics", "detector")


@dataclass(frozen=True, eq=False)
class Part:
    """One target before one camera, as one specimen of both: a folder with a dataset of its own.

    Attributes
    ----------
    spec : Spec
    where : Path
        The specification's file, beside which targets lie.
    number : int
    target : TargetTable
    choice : SpecCameraTable
    specimen : int
        From 0.
    """

    spec: Spec
    where: Path
    number: int
    target: TargetTable
    choice: SpecCameraTable
    specimen: int

    @cached_property
    def name(self) -> str:
        """Of its folder."""
        craft = Path(self.target.spacecraft).stem
        specimen = f"-{self.specimen + 1}" if self.spec.vary.specimens > 1 else ""
        return f"{craft}-{self.choice.name}{specimen}"

    @property
    def camera(self) -> Camera:
        """That renders."""
        return camera_of(self.choice)

    @property
    def detector(self) -> Detector:
        """That exposes."""
        return self._without_rows.simulated_detector

    @cached_property
    def aim(self) -> Aim:
        """Its target, as poses are drawn about it."""
        try:
            craft = target_of(self._without_rows)
        except ScenarioError as error:
            raise ScenarioError(f"{self.where}: {error}") from error
        if self.spec.images == "pairs" and not target_has_markers(self._without_rows):
            raise ScenarioError(
                f'{self.where}: expected targets with markers for images = "pairs", '
                f'{self.target.spacecraft} has none; choose images = "single", or another target'
            )
        typed = self.target.aim_m
        near, far = self.target.range_m or self.spec.pose.range_m
        factor = self.choice.range_factor
        point = craft.bounds.mean(axis=0) if typed is None else np.array(typed)
        return Aim(craft, point, (factor * near, factor * far))

    def scenario(self, rows: Sequence[str]) -> Scenario:
        """Return its scenario with all that is drawn of it.

        Parameters
        ----------
        rows : sequence of str
            Of its table of poses, as ``COLUMNS`` has them.

        Raises
        ------
        ScenarioError
            If it cannot be rendered; the message names the specification.
        """
        table = self._table()
        table["motion"] = {
            "kind": "poses",
            "table": [",".join(COLUMNS), *rows],
            "start_s": 0.0,
            "end_s": float(rows[-1].split(",", 1)[0]),
        }
        table["sun"] = {"default": "table"}
        render_seed, noise_seed = rng_of(self.spec, SEEDS, self.number).integers(2**31, size=2)
        table["render"] = {**table["render"], "seed": int(render_seed)}
        table["exposure"] = {"mode": "table", "noise_seed": int(noise_seed)}
        table["surface"] = self._surfaces()
        return check_scenario(self._read(table), f"{self.where}: {self.name}")

    @cached_property
    def _without_rows(self) -> Scenario:
        return self._read(self._table())

    def _read(self, table: dict[str, Any]) -> Scenario:
        try:
            return Scenario(**table)
        except ValidationError as error:
            raise ScenarioError(explain(str(self.where), error, Scenario, {})) from error

    def _table(self) -> dict[str, Any]:
        spec = self.spec
        table: dict[str, Any] = {
            "name": f"{spec.name}-{self.name}",
            "target": self.target.spacecraft,
            "frame": {"kind": spec.images},
            "camera": self.choice.model_dump(exclude=set(OF_A_CHOICE)),
            "optics": {**(self.choice.optics or spec.optics).model_dump(), **self._blur()},
            "detector": (self.choice.detector or spec.detector).model_dump(),
            "lens_scatter": spec.lens_scatter.model_dump(),
            "radiation": spec.radiation.model_dump(),
            "floodlight": spec.floodlight.model_dump(),
            "render": spec.render.model_dump(),
            "earth": {
                "shines": spec.background.earth > 0.0,
                "orbit_radius_km": spec.background.earth_distance_km,
                "albedo": spec.background.earth_albedo,
            },
            "stars": {
                "shine": spec.background.stars > 0.0,
                "q_target_from_icrs_wxyz": self._attitude_among_stars(),
            },
        }
        with_own_target_read(table, self.where)
        return table

    def _attitude_among_stars(self) -> list[float]:
        turn = Rotation.random(rng=rng_of(self.spec, STARS_ATTITUDE, self.number))
        wxyz: list[float] = turn.as_quat(scalar_first=True).tolist()
        return wxyz

    def _blur(self) -> dict[str, float]:
        span = self.spec.vary.psf_sigma_px
        if span is None:
            return {}
        return {"psf_sigma_px": float(rng_of(self.spec, LENS, self.number).uniform(*span))}

    def _surfaces(self) -> list[SurfaceTable] | None:
        """Draw how each material differs, one after the other in order of their names."""
        vary = self.spec.vary
        sigmas = np.array([vary.diffuse, vary.specular, vary.roughness])
        if not sigmas.any():
            return None
        names = sorted(materials_of(self.aim.craft))
        drawn = rng_of(self.spec, SURFACES, self.number).standard_normal((len(names), 3))
        factors = np.exp(sigmas * np.clip(drawn, -MOST_SIGMAS, MOST_SIGMAS))
        return [
            SurfaceTable(material=name, diffuse=diffuse, specular=specular, roughness=roughness)
            for name, (diffuse, specular, roughness) in zip(names, factors.tolist(), strict=True)
        ]


def parts_of(spec: Spec, where: Path) -> list[Part]:
    """Return every part of a dataset.

    Parameters
    ----------
    spec : Spec
    where : Path
        Its file.

    Raises
    ------
    ScenarioError
        If two would have one folder, or a part would have too many frames.
    """
    chosen = product(spec.target, spec.camera, range(spec.vary.specimens))
    parts = [
        Part(spec, where, number, target, camera, specimen)
        for number, (target, camera, specimen) in enumerate(chosen)
    ]
    names = [part.name.lower() for part in parts]
    if len(set(names)) < len(names):
        raise ScenarioError(
            f"{where}: expected targets and cameras that name folders of their own, got "
            f"{', '.join(names)}; give another [[camera]] name"
        )
    most = -(-spec.poses // len(parts)) * spec.frames_per_pose
    if most > MOST_ROWS:
        raise ScenarioError(
            f"{where}: expected at most {MOST_ROWS} frames of each target, camera and specimen, "
            f"got up to {most}; give more vary.specimens, or several seeds"
        )
    return parts


def row_text(time_s: float, values: Sequence[float], background: str) -> str:
    """Return a row of a part's table.

    Parameters
    ----------
    time_s : float, s
    values : sequence of float
        As ``COLUMNS`` has them, from the second to the last but one.
    background : str
    """
    cells = [time_s, *values]
    return ",".join([*(repr(float(x)) for x in cells), str(int(background == STARS))])
