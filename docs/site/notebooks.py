"""Two tutorials as notebooks, made of the same text, and run headless.

python -m docs.site.notebooks         # write docs/notebooks/*.ipynb anew
python -m docs.site.notebooks --run   # run each in an empty folder, as `make notebooks` does
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

from docs.site.page_blocks import FENCE

HOUSE = Path(__file__).resolve().parents[2]

DOCS = HOUSE / "docs"
NAMES = ("export-training-set", "own-spacecraft")
HANGS_S = 1800
LINK = re.compile(r"\]\((?!https?:|#)([^)]+)\)")
KERNEL = {"display_name": "Python 3", "language": "python", "name": "python3"}


def notebook_of(text: str) -> dict[str, Any]:
    """Return a tutorial as a notebook.

    Parameters
    ----------
    text : str
        The page. Files become cells that write them, commands cells of the shell; what a block
        printed is left to the run.
    """
    cells = []
    end = 0
    for match in FENCE.finditer(text):
        cells += told(text[end : match.start()])
        language, _, name = match["info"].strip().partition(" ")
        body = match["body"].rstrip("\n")
        if language == "console":
            code = "\n".join(f"!{line}" for line in body.replace("\\\n", " ").splitlines())
        elif name and language != "text":
            code = f"%%writefile {name}\n{body}"
        else:
            code = body
        if language != "text":
            cells.append(cell("code", code))
        end = match.end()
    cells += told(text[end:])
    for number, each in enumerate(cells):
        each["id"] = f"cell-{number}"
    about = {"kernelspec": KERNEL, "language_info": {"name": "python"}}
    return {"cells": cells, "metadata": about, "nbformat": 4, "nbformat_minor": 5}


def told(text: str) -> list[dict[str, Any]]:
    """Return prose as a cell, or none if there is none; links lead to the site's own sources."""
    text = LINK.sub(lambda match: f"]({from_notebooks(match[1])})", text.strip())
    return [cell("markdown", text)] if text else []


def from_notebooks(link: str) -> str:
    """Return a tutorial's link as it is from the folder of the notebooks."""
    return link if link.startswith("../") else f"../tutorials/{link}"


def cell(kind: str, text: str) -> dict[str, Any]:
    """Return a cell of a notebook."""
    made: dict[str, Any] = {"cell_type": kind, "metadata": {}, "source": text.splitlines(True)}
    if kind == "code":
        made |= {"execution_count": None, "outputs": []}
    return made


def run(path: Path) -> None:
    """Run a notebook in an empty folder; what a cell raises, or a command's failure, is raised."""
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(path, as_version=4)
    for each in notebook.cells:  # a command that fails is no error to a notebook, but it is to us
        if each.cell_type == "code" and each.source.startswith("!"):
            each.source += "\nassert _exit_code == 0, 'the command failed'"
    with tempfile.TemporaryDirectory() as folder:
        NotebookClient(
            notebook,
            timeout=HANGS_S,
            kernel_name="python3",
            resources={"metadata": {"path": folder}},
        ).execute()
    print(f"{path.name}: {len(notebook.cells)} cells ran", flush=True)


def main() -> int:
    """Write the notebooks, or run them."""
    places = [DOCS / "notebooks" / f"{name}.ipynb" for name in NAMES]
    for name, place in zip(NAMES, places, strict=True):
        if "--run" in sys.argv:
            run(place)
        else:
            made = notebook_of((DOCS / "tutorials" / f"{name}.md").read_text())
            place.write_text(json.dumps(made, indent=1, ensure_ascii=False) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
