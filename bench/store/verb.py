"""``rvbench store``: what the command line can do about the light that is kept."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import FlagCreatePairsOff, OmitSubcommandPrefixes, arg, subcommand

from models.plain_console import plain_console

DONE, WORSE = 0, 1

StoreFolder = Annotated[Path | None, arg(metavar="DIR", help_behavior_hint="")]


@dataclass(frozen=True)
class ListLight:
    """Tell how much light lies there: by dataset, with its size and last use."""

    store: StoreFolder = None
    """the store; else $RVBENCH_STORE, or a folder in the user's cache"""

    def run(self) -> int:
        """Print it."""
        from bench.store.stored_light import print_holdings

        print_holdings(_folder(self.store), plain_console())
        return DONE


@dataclass(frozen=True)
class VerifyLight:
    """Read every entry and find the damaged ones, to the flipped byte; exit code 1 if any."""

    store: StoreFolder = None
    """the store; else $RVBENCH_STORE, or a folder in the user's cache"""
    delete: Annotated[FlagCreatePairsOff[bool], arg(help_behavior_hint="")] = False
    """delete what is damaged, so that the next run renders it again"""

    def run(self) -> int:
        """Verify."""
        from bench.store.stored_light import find_damage, whose

        folder = _folder(self.store)
        found, count = find_damage(folder)
        for damage in found:
            print(f"damaged: {damage.path}: {damage.reason} ({whose(folder, damage)})")
            for copy in damage.copies:
                print(f"         and so is its link {copy}")
            if self.delete:
                damage.delete()
        print(f"{folder}: {count} entries, {len(found)} damaged")
        if found and self.delete:
            print("they are deleted; the next run that needs them renders them again")
        elif found:
            print("`rvbench store verify --delete` deletes them; a run does so where it needs them")
        return WORSE if found else DONE


@dataclass(frozen=True)
class PruneLight:
    """Delete what was used longest ago until no more than a size is left."""

    to_gb: Annotated[float, arg(metavar="NUMBER")]
    """what may be left, in GB; what running commands need stays"""
    store: StoreFolder = None
    """the store; else $RVBENCH_STORE, or a folder in the user's cache"""

    def run(self) -> int:
        """Prune."""
        from bench.store.stored_light import prune, size_text

        folder = _folder(self.store)
        left, deleted, needed = prune(folder, self.to_gb)
        print(f"{folder}: {deleted} entries deleted, {size_text(left)} left")
        if left > self.to_gb * 1e9:
            why = "needed by commands that run now" if needed else "of entries used meanwhile"
            print(f"what is left beyond that is {why}")
        return DONE


@dataclass(frozen=True)
class Store:
    """Tell what light is kept, verify it, or prune it to a size.

        rvbench store list
        rvbench store verify --delete
        rvbench store prune --to-gb 5

    Light can always be rendered again; a store also keeps itself within its budget: see
    `rvbench run --help`.
    """

    action: OmitSubcommandPrefixes[
        Annotated[ListLight, subcommand("list")]
        | Annotated[VerifyLight, subcommand("verify")]
        | Annotated[PruneLight, subcommand("prune")]
    ]

    def run(self) -> int:
        """Do it."""
        return self.action.run()


def _folder(typed: Path | None) -> Path:
    from renders.store.radiance_store import default_store

    return typed or default_store()
