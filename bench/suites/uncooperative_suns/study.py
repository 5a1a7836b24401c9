"""How a study of uncooperative targets is done and written, whatever is judged in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from rich.console import Console

from bench.scoring.score import rounded
from bench.suites.folder import write_document
from bench.suites.request import SuiteFiles
from bench.suites.uncooperative_suns.frame_plan import VARIANTS, FramePlan
from bench.suites.units import LIBRARIES

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

P = TypeVar("P", bound=FramePlan)
R = TypeVar("R")
S = TypeVar("S", bound="DataclassInstance")
ByTarget = dict[str, dict[str, R]]


@dataclass(frozen=True)
class Study(Generic[P, R, S]):
    """What one study has of its own.

    Attributes
    ----------
    name : str
    judged : callable
        Of plan, target and variant: what the units came to.
    summary_of : callable
        Of that: what goes into ``suite.json``.
    write_page : callable
        Of file, plan, results, summaries and settings.
    table : callable
        Of the summaries: rows for a terminal, the first their heads.
    """

    name: str
    judged: Callable[[P, str, str], R]
    summary_of: Callable[[R], S]
    write_page: Callable[[Path, P, ByTarget[R], ByTarget[S], dict[str, Any]], Path]
    table: Callable[[ByTarget[S]], list[list[str]]]

    def run(self, plan: P, workers: int, console: Console) -> SuiteFiles:
        """Do what is missing of a plan and write ``suite.json`` and ``suite.html``.

        Parameters
        ----------
        plan : FramePlan
        workers : int
            Processes.
        console : Console
            For progress.

        Raises
        ------
        ScenarioError, VariantError, StorageError
            Each says what to do; nothing already done is lost.
        """
        plan.do_all(workers, console)
        results = {
            plan.name(target): {
                variant: self.judged(plan, target, variant)
                for variant in VARIANTS
                if plan.starts(target, variant)
            }
            for target in plan.targets
        }
        summaries = {
            target: {variant: self.summary_of(found) for variant, found in own.items()}
            for target, own in results.items()
        }
        settings = {
            **asdict(plan.sizes),
            "targets": list(plan.targets),
            "libraries": {name: version(name) for name in LIBRARIES},
        }
        told = {t: {v: rounded(asdict(s)) for v, s in own.items()} for t, own in summaries.items()}
        score = write_document(plan.out, self.name, settings, targets=told)
        page = self.write_page(plan.out / "suite.html", plan, results, summaries, settings)
        return SuiteFiles(score, page, self.table(summaries))
