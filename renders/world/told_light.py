"""What is on board of the light: what the target's surfaces reflect, and what white gives.

None of it is exact: each material's reflectance is off by age and by what nobody measured, the
camera's level by its calibration. Both errors are factors, log-normal, so that none turns negative.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from models.lights.sun import PASSBAND_IRRADIANCE_W_M2
from models.onboard import OnboardKnowledge
from models.spacecraft.finishes import FaceShares, face_shares, finish_of
from models.spacecraft.part import Spacecraft
from models.wireframe.wireframe import Wireframe
from renders.detector.expose import SUNLIGHT_NM, electrons_per_radiance
from renders.scenario.own_target import target_of
from renders.scenario.scenario import Scenario
from renders.scenario.tumble_tables import OnboardTable
from renders.world.told_draws import drawn

FINISHES, WHITE = "wireframe.finish_scale", "knowledge.white_scale"  # as ``sigmas.toml`` has them


@dataclass(frozen=True, eq=False)
class TrueFinish:
    """What a target's wireframe is covered with, before any error.

    Attributes
    ----------
    wireframe : Wireframe
    spacecraft : Spacecraft
        Of the same target, its materials as the house or its owner has them.
    """

    wireframe: Wireframe
    spacecraft: Spacecraft

    @property
    def materials(self) -> tuple[str, ...]:
        """Names of all of its materials, in the order of the alphabet."""
        return self._met.materials

    def told(self, sigma: float, off: Mapping[str, float]) -> Wireframe:
        """Return the wireframe with finishes that are off.

        Parameters
        ----------
        sigma : float
            Of the logarithm of each material's factor.
        off : mapping of str to float
            Standard normal numbers, by material.
        """
        factors = {name: float(np.exp(sigma * value)) for name, value in off.items()}
        finish = finish_of(self._met, self.spacecraft, factors)
        return replace(self.wireframe, finish=finish)

    @cached_property
    def _met(self) -> FaceShares:
        return face_shares(self.wireframe, self.spacecraft)


def white_dn_ms(scenario: Scenario) -> float:
    """Return what a white matt surface that the Sun meets squarely gives the camera, DN/ms."""
    detector = scenario.simulated_detector
    per_radiance = electrons_per_radiance(scenario.simulated_optics, detector, SUNLIGHT_NM)
    electrons_s = PASSBAND_IRRADIANCE_W_M2 / np.pi * per_radiance
    return float(1e-3 * electrons_s / detector.gain_e_dn)


@dataclass(frozen=True, eq=False)
class ToldLight:
    """What ``[tumble.onboard]`` tells of the light, run by run.

    Attributes
    ----------
    scenario : Scenario
    table : OnboardTable
    wireframe : Wireframe or None
        Of the target, where its shape is known.
    """

    scenario: Scenario
    table: OnboardTable
    wireframe: Wireframe | None

    def on_board(self, true: OnboardKnowledge, run: int) -> OnboardKnowledge:
        """Return what is on board with what is told of the light, and the sigmas of its draws.

        Parameters
        ----------
        true : OnboardKnowledge
            Without.
        run : int
        """
        onboard, table = true, self.table
        if table.finish_sigma is not None and self._finish is not None:
            of = self._finish.materials
            off = {each: float(drawn(run, f"{FINISHES}.{each}", 1)[0]) for each in of}
            onboard = replace(onboard, wireframe=self._finish.told(table.finish_sigma, off))
        if table.white_sigma is not None and true.expectations is not None:
            factor = float(np.exp(table.white_sigma * drawn(run, WHITE, 1)[0]))
            level = factor * white_dn_ms(self.scenario)
            onboard = replace(onboard, expectations=replace(true.expectations, white_dn_ms=level))
        told = {FINISHES: table.finish_sigma, WHITE: table.white_sigma}
        sigmas = {key: sigma for key, sigma in told.items() if sigma}
        return replace(onboard, sigmas={**true.sigmas, **sigmas})

    @cached_property
    def _finish(self) -> TrueFinish | None:
        if self.wireframe is None:
            return None
        return TrueFinish(self.wireframe, target_of(self.scenario))
