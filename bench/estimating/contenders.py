"""Who takes part in an estimate: pipelines and their variants, by what a dataset gives."""

from __future__ import annotations

import difflib
import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from models.errors import ScenarioError
from pipelines.pipeline import RegisteredPipeline
from pipelines.registry import is_ours, pipeline_names, registered_pipeline


@dataclass(frozen=True)
class Contender:
    """One variant of one pipeline.

    Attributes
    ----------
    label : str
        What its estimates and its column in a score are called.
    pipeline, variant : str
    """

    label: str
    pipeline: str
    variant: str

    @property
    def registered(self) -> RegisteredPipeline:
        """The pipeline, loaded."""
        return registered_pipeline(self.pipeline)

    @property
    def is_ours(self) -> bool:
        """Whether it is of the house."""
        return is_ours(self.pipeline)

    @property
    def settings(self) -> str:
        """Hash of all its settings."""
        own = f"{self.pipeline} {self.variant} {self.registered.settings_hash(self.variant)}"
        return hashlib.sha256(own.encode()).hexdigest()


def contenders(
    streams: Iterable[str], own: Sequence[str], asked: Sequence[str] = ()
) -> tuple[list[Contender], list[str]]:
    """Return who takes part, and what is wrong with installed pipelines that cannot.

    Parameters
    ----------
    streams : iterable of str
        That every frame has.
    own : sequence of str
        The chain's pipelines, which come first.
    asked : sequence of str
        Labels or names of pipelines; if any are given, these alone.

    Raises
    ------
    ScenarioError
        If one asked for is not there, or nobody can run.
    """
    given, remarks = set(streams), []
    found: list[Contender] = []
    for name in [*own, *(each for each in pipeline_names() if not is_ours(each))]:
        try:
            registered = registered_pipeline(name)
        except ScenarioError as error:
            remarks.append(str(error))
            continue
        if set(registered.streams) <= given:
            found += [
                Contender(registered.labelled(variant), name, variant)
                for variant in registered.variants
            ]
    twice = [each.label for each in found]
    remarks += [
        f"pipeline {each.pipeline}: its label {each.label} is taken; it is left out"
        for place, each in enumerate(found)
        if each.label in twice[:place]
    ]
    found = [each for place, each in enumerate(found) if each.label not in twice[:place]]
    return (_chosen(found, asked) if asked else found), remarks


def _chosen(found: Sequence[Contender], asked: Sequence[str]) -> list[Contender]:
    known = {each.label for each in found} | {each.pipeline for each in found}
    for name in asked:
        if name not in known:
            if name in pipeline_names():
                registered_pipeline(name)  # says what is wrong with it, if anything is
                raise ScenarioError(
                    f"expected a pipeline for these frames, got {name}, which needs the streams "
                    f"{', '.join(registered_pipeline(name).streams)}"
                )
            near = difflib.get_close_matches(name, known, n=1)
            hint = f"; perhaps you meant {near[0]}" if near else ""
            raise ScenarioError(
                f"expected a pipeline among {', '.join(sorted(known))}, got {name!r}{hint}"
            )
    return [each for each in found if each.label in asked or each.pipeline in asked]
