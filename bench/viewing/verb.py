"""``rvbench view``: a folder's page opened in the user's browser, or its recording written."""

from __future__ import annotations

import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from bench.verbs import DONE
from models.errors import DatasetError, ScenarioError

PAGES = ("report.html", "sweep.html", "suite.html", "comparison.html")
"""In a dataset, and in the folders of a sweep, a suite and a comparison."""


@dataclass(frozen=True)
class View:
    """Open the page of a folder in your browser.

        rvbench view out/demo
        rvbench view out/sweep-maxar-approach
        rvbench view out/demo --rerun out/demo.rrd

    The page is one file and asks nothing of a network. $BROWSER names another browser; without any
    the page's place is told all the same.
    """

    folder: Positional[Annotated[Path, arg(metavar="DIR")]]
    """a scored dataset, or the folder of a sweep, a suite or a comparison; or a page itself"""
    rerun: Annotated[Path | None, arg(metavar="FILE.rrd", help_behavior_hint="")] = None
    """write a scored dataset there for Rerun's viewer instead: frames, camera, target, poses and
    errors; needs `pip install rerun-sdk`"""

    def run(self) -> int:
        """Open the page, or write the recording.

        Raises
        ------
        ScenarioError
            If there is no browser, or no Rerun where it was asked for.
        """
        if self.rerun is not None:
            from bench.viewing.recording import write_recording

            write_recording(self.folder, self.rerun)
            print(f"recording: {self.rerun.resolve()}\nopen it with: rerun {self.rerun}")
            return DONE
        page = page_of(self.folder).resolve()
        print(f"page: {page}", flush=True)
        if not webbrowser.open(page.as_uri()):
            raise ScenarioError(
                f"expected a browser that Python can open, found none; set $BROWSER to one, or "
                f"open {page} by hand"
            )
        return DONE


def page_of(place: Path) -> Path:
    """Return the page in a folder, or a page itself.

    Parameters
    ----------
    place : Path

    Raises
    ------
    DatasetError
        If there is none.
    """
    if place.is_file() and place.suffix == ".html":
        return place
    for name in PAGES:
        if (place / name).is_file():
            return place / name
    mend = "run `rvbench report` on it first" if (place / "score.json").is_file() else (
        "give the folder of a run, a sweep, a suite or a comparison"
    )  # fmt: skip
    raise DatasetError(f"{place}: expected one of {', '.join(PAGES)} in it, found none; {mend}")
