"""The fenced blocks of a page of the site, and what is done with each: written, run, or compared.

    ```toml mine.toml     a file of that name, in the folder in which the page's blocks run
    ```python             run there
    ```python probe.py    a file; a `python probe.py` of a later block runs it
    ```console            commands, run there one after the other
    ```text               what the block before printed, or some lines of it; numbers may differ
    ```text as-is         prose that is set as code

Only ``rvbench``, ``python``, ``pip install``, ``make`` and ``cd`` are commands; ``make`` and ``cd``
are the reader's own, and not run.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

HOUSE = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```(?P<info>[^\n`{]*)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"[-−+]?\d[\d.,e]*")
NOT_RUN = {"make", "cd", "."}
AS_IS = "as-is"


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, the file that it is (or none), its text, and its line."""

    language: str
    name: str
    body: str
    line: int


def blocks_of(text: str) -> list[Block]:
    """Return the blocks of a page, in order."""
    found = []
    for match in FENCE.finditer(text):
        language, _, name = match["info"].strip().partition(" ")
        found.append(
            Block(language, name.strip(), match["body"], text[: match.start()].count("\n") + 1)
        )
    return found


def commands_of(block: Block) -> list[list[str]]:
    """Return the commands of a block of them, each as its words."""
    if block.language != "console":
        return []
    lines = block.body.replace("\\\n", " ").splitlines()
    return [words for line in lines if (words := shlex.split(line, comments=True))]


def do_page(text: str, folder: Path, python: Path | str = sys.executable) -> None:
    """Do all blocks of a page, in order, in a folder.

    Parameters
    ----------
    text : str
        The page.
    folder : Path
        Where.
    python : Path or str
        What runs them, and what packages are installed into.
    """
    printed = ""
    for block in blocks_of(text):
        printed = do_block(block, folder, printed, python)


def do_block(
    block: Block, folder: Path, printed: str = "", python: Path | str = sys.executable
) -> str:
    """Write or run a block in a folder; return what it printed.

    Parameters
    ----------
    block : Block
        Which.
    folder : Path
        Where.
    printed : str
        What the block before printed, which a block of text repeats.
    python : Path or str
        What runs it.

    Raises
    ------
    SystemExit
        If it fails, or repeats what was not printed.
    """
    if block.language == "text":
        if block.name != AS_IS:
            compare(block, printed)
        return printed
    if block.name:
        place = folder / block.name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(block.body)
        return ""
    if block.language == "python":
        return run([python, "-P", "-c", block.body], folder, block)
    return "".join(
        run(arguments(words, python), folder, block)
        for words in commands_of(block)
        if words[0] not in NOT_RUN
    )


def arguments(words: list[str], python: Path | str) -> list[Path | str]:
    """Return what runs a command with a Python."""
    if words[0] == "rvbench":
        return [python, "-P", "-m", "bench", *words[1:]]
    if words[0] == "python":
        return [python, "-P", *words[1:]]
    if words[:2] == ["pip", "install"]:
        offline = ["--no-deps", "--no-build-isolation", "--no-index", "--quiet"]
        return [sys.executable, "-m", "pip", "--python", python, "install", *offline, *words[2:]]
    raise SystemExit(f"expected rvbench, python, pip install, make or cd, got {words[0]!r}")


def run(command: list[Path | str], folder: Path, block: Block) -> str:
    """Run a command in a folder and return what it printed."""
    variables = {**os.environ, "PYTHONPATH": str(HOUSE), "COLUMNS": "120"}
    done = subprocess.run(
        command, cwd=folder, env=variables, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip()
        raise SystemExit(f"the block at line {block.line} ended with {done.returncode}: {said}")
    return done.stdout


def compare(block: Block, printed: str) -> None:
    """Refuse lines that the block before did not print, whatever their numbers."""
    said = {shape(line) for line in printed.splitlines()}
    for line in block.body.splitlines():
        if line.strip() not in ("", "...") and shape(line) not in said:
            raise SystemExit(f"line {block.line}: nothing printed {line!r}; printed:\n{printed}")


def shape(line: str) -> str:
    """Return a line with every number and all spacing left out."""
    return re.sub(r"\s+", "", NUMBER.sub("#", line))
