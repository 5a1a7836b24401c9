"""Every chain there is: ours, those that other packages bring, and those registered by hand.

A package brings one by an entry point of the group ``rvbench.chains`` that names a ``Chain``.
"""

from __future__ import annotations

import difflib
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points

from bench.chains.chain import Chain
from models.errors import DatasetError
from pipelines.registry import register as register_pipeline

GROUP = "rvbench.chains"
OURS = {
    "retroreflector_pairs": "bench.chains.retroreflector_pairs",
    "dot_images": "bench.chains.dot_images",
    "tumble_images": "bench.chains.tumble_images",
    "navigated_images": "bench.chains.navigated_images",
    "unknown_images": "bench.chains.unknown_images",
    "posed_images": "bench.chains.posed_images",
    "absolute_navigation": "bench.chains.absolute_navigation",
}
_REGISTERED: dict[str, Chain] = {}


def register(chain: Chain) -> Chain:
    """Make a chain known in this process, with the pipelines that it brings, and return it.

    Raises
    ------
    DatasetError
        If its name is one of ours.
    ScenarioError
        If a pipeline that it brings has one.
    """
    if chain.name in OURS:
        raise DatasetError(
            f"expected a chain of a name of its own, got {chain.name!r}, which is ours; rename it"
        )
    for name, place in chain.brought.items():
        register_pipeline(name, place)
    _REGISTERED[chain.name] = chain
    return chain


def chain_names() -> list[str]:
    """Return the names of all chains, ours first."""
    foreign = {point.name for point in entry_points(group=GROUP)}
    return [*OURS, *sorted((foreign | set(_REGISTERED)) - set(OURS))]


def chain_named(name: str) -> Chain:
    """Return a chain.

    Raises
    ------
    DatasetError
        If there is none of that name.
    """
    if name in _REGISTERED:
        return _REGISTERED[name]
    if name in OURS:
        found: Chain = import_module(OURS[name]).CHAIN
        return found
    for point in entry_points(group=GROUP):
        if point.name == name:
            return register(_loaded(name, point))
    near = difflib.get_close_matches(name, chain_names(), n=1)
    hint = f"; perhaps it means {near[0]}" if near else ""
    raise DatasetError(
        f"expected a chain among {', '.join(chain_names())}, got {name!r}{hint}; "
        "install the package that brings it"
    )


def _loaded(name: str, point: EntryPoint) -> Chain:
    try:
        chain = point.load()
    except (Exception, SystemExit) as error:  # anybody's code, which may fail in any way
        raise DatasetError(
            f"chain {name}: expected its package to load, got {type(error).__name__}: {error}"
        ) from error
    if not isinstance(chain, Chain) or chain.name != name:
        got = chain.name if isinstance(chain, Chain) else type(chain).__name__
        raise DatasetError(
            f"chain {name}: expected a bench.chains.chain.Chain of that name, got {got!r}"
        )
    return chain
