"""Who takes part in an estimate: pipelines and their variants, by what a dataset gives."""

from __future__ import annotations

import difflib
import hashlib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

from bench.estimating.pipeline_process import described
from models.errors import ScenarioError
from pipelines.registry import (
    OURS,
    foreign_places,
    is_ours,
    pipeline_names,
    registered_pipeline,
    unusable_entry_points,
)

LABEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,99}")  # it names files


@dataclass(frozen=True)
class Contender:
    """One variant of one pipeline.

    Attributes
    ----------
    label : str
        What its estimates and its column in a score are called.
    pipeline, variant : str
    own_settings : str
        What the pipeline tells of its settings, as a hash.
    place : str
        Where it stands; empty for ours.
    asked : bool
        Whether it was asked for by name, so that it must run.
    """

    label: str
    pipeline: str
    variant: str
    own_settings: str
    place: str = ""
    asked: bool = False

    @property
    def is_ours(self) -> bool:
        """Whether it is of the house."""
        return is_ours(self.pipeline)

    @property
    def settings(self) -> str:
        """Hash of all its settings."""
        own = f"{self.pipeline} {self.variant} {self.own_settings}"
        return hashlib.sha256(own.encode()).hexdigest()


@dataclass(frozen=True)
class _Known:
    """A pipeline as it tells of itself."""

    streams: tuple[str, ...]
    variants: tuple[Contender, ...]


def contenders(
    streams: Iterable[str], own: Sequence[str], asked: Sequence[str] = (), *, foreign: bool = True
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
    foreign : bool
        Whether other packages' take part beside the chain's.

    Raises
    ------
    ScenarioError
        If one asked for is not there, or nobody can run.
    """
    given = set(streams)
    found: dict[str, Contender] = {}
    lacking: dict[str, _Known] = {}
    faults: dict[str, str] = {}
    remarks = unusable_entry_points() if foreign else []
    theirs = [each for each in pipeline_names() if foreign and not is_ours(each)]
    for name in dict.fromkeys([*own, *theirs]):
        if asked and not is_ours(name) and all(_named(each, found) for each in asked):
            break  # nobody else's code runs where none was asked for
        try:
            known = _known(name, foreign_places().get(name, ""))
        except ScenarioError as error:
            faults[name] = str(error)
            continue
        if not set(known.streams) <= given:
            lacking[name] = known
            continue
        for each in known.variants:
            if each.label in found:
                faults.setdefault(
                    name,
                    f"pipeline {name}: expected a label of its own, got {each.label}, which "
                    f"{found[each.label].pipeline} has",
                )
            else:
                found[each.label] = each
    if not asked:
        return list(found.values()), [*remarks, *faults.values()]
    _check_asked(asked, found, lacking, faults, remarks)
    chosen = [each for each in found.values() if {each.label, each.pipeline} & set(asked)]
    return [_that_was_asked(each) for each in chosen], []


def what_ours_lack(streams: Iterable[str], names: Iterable[str] = OURS) -> str:
    """Return in words why none of our pipelines takes frames.

    Parameters
    ----------
    streams : iterable of str
        That every frame has.
    names : iterable of str
        Of the pipelines that are told of.
    """
    given, told = set(streams), []
    for name in names:
        pipeline = registered_pipeline(name)
        lacks = sorted(set(pipeline.streams) - given)
        if lacks:
            told.append(f"{name} lacks {', '.join(lacks)}")
        elif pipeline.in_colour:
            told.append(f"{name} takes images in colour")
    return "; ".join(told)


def _named(asked: str, found: dict[str, Contender]) -> bool:
    return asked in found or any(each.pipeline == asked for each in found.values())


def _that_was_asked(each: Contender) -> Contender:
    return Contender(each.label, each.pipeline, each.variant, each.own_settings, each.place, True)


def _check_asked(
    asked: Sequence[str],
    found: dict[str, Contender],
    lacking: dict[str, _Known],
    faults: dict[str, str],
    remarks: Sequence[str],
) -> None:
    for name in asked:
        if _named(name, found):
            continue
        if name in faults:
            raise ScenarioError(faults[name])
        if is_ours(name) and name not in lacking:
            lacking[name] = _known(name, "")
        for pipeline, known in lacking.items():
            if name == pipeline or any(name == each.label for each in known.variants):
                raise ScenarioError(
                    f"expected a pipeline for these frames, got {name}, which needs the streams "
                    f"{', '.join(known.streams)}"
                )
        known_names = sorted({*found, *(each.pipeline for each in found.values())})
        near = difflib.get_close_matches(name, known_names, n=1)
        hint = f"; perhaps you meant {near[0]}" if near else ""
        left_out = "".join(f"; left out: {each}" for each in [*faults.values(), *remarks])
        raise ScenarioError(
            f"expected a pipeline among {', '.join(known_names) or 'none'}, got {name!r}{hint}"
            f"{left_out}"
        )


@cache
def _known(name: str, place: str) -> _Known:
    """Return what a pipeline tells of itself; another package's tells it in its own process."""
    if not place:
        ours = registered_pipeline(name)
        variants = tuple(
            Contender(ours.labelled(each), name, each, ours.settings_hash(each))
            for each in ours.variants
        )
        return _Known(ours.streams, variants)
    table = described(name, place)
    variants = tuple(
        Contender(each["label"], name, each["name"], each["settings"], place)
        for each in table["variants"]
    )
    for each in variants:
        if not LABEL.fullmatch(each.label):
            raise ScenarioError(
                f"pipeline {name}: expected labels of letters, digits, _ and -, "
                f"got {each.label!r:.120}"
            )
    if not variants:
        raise ScenarioError(f"pipeline {name}: expected at least one variant, got none")
    return _Known(tuple(table["streams"]), variants)
