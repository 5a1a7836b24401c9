"""The targets of a study: ours by name, one's own by the TOML beside a mesh."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from bench.suites.uncooperative_suns.cases import MotionTask
from bench.suites.uncooperative_suns.frames import scenario_of
from models.errors import ScenarioError
from models.spacecraft.wireframes import WIREFRAMES
from renders.scenario.own_target import MESHES, SUFFIX, wireframe_of

TARGETS = ("xmm", "hispasat", "maxar1300_unmarked")


@dataclass(frozen=True)
class Targets:
    """Targets as they were typed.

    Attributes
    ----------
    targets : tuple of str
    """

    targets: tuple[str, ...]

    def check(self) -> None:
        """Refuse what is no target, or two of one name.

        Raises
        ------
        ScenarioError
            The message names it.
        """
        names = [self.name(target) for target in self.targets]
        for target, name in zip(self.targets, names, strict=True):
            if names.count(name) > 1:
                raise ScenarioError(f"expected targets of different names, got {name} twice")
            if target.lower().endswith(MESHES):
                raise ScenarioError(
                    f"expected --parts as targets, of your own the .toml beside its mesh, got "
                    f"{target!r}; `rvbench inspect {target}` writes one"
                )
            if not is_own(target) and target not in WIREFRAMES:
                raise ScenarioError(
                    f"expected --parts as targets with a wireframe, {', '.join(TARGETS)} or the "
                    f".toml of your own, got {target!r}"
                )

    @staticmethod
    def name(target: str) -> str:
        """Return how a target's files are named."""
        return Path(target).stem if is_own(target) else target

    @staticmethod
    def place(target: str) -> str:
        """Return its name, or where its file lies from anywhere."""
        return str(Path(target).resolve()) if is_own(target) else target

    def shape(self, target: str) -> str:
        """Return the hash of all that makes one's own; empty for ours.

        Raises
        ------
        ScenarioError
            If it cannot be used, or has no wireframe.
        """
        return self._shapes[target]

    @cached_property
    def _shapes(self) -> dict[str, str]:
        return {
            target: _shape(self.place(target)) if is_own(target) else "" for target in self.targets
        }


def is_own(target: str) -> bool:
    """Tell whether a target is one's own."""
    return target.lower().endswith(SUFFIX)


def _shape(place: str) -> str:
    scenario = scenario_of(MotionTask(place, "", 0, 0, 1024, 1))
    wireframe_of(scenario)  # before anything is rendered
    own = scenario.own_target
    if own is None:
        return ""
    return hashlib.sha256("\n".join([own.files_sha256, *own.lines]).encode()).hexdigest()
