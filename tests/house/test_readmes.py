"""What the READMEs show can be typed: Python blocks run, commands parse, targets exist.

A block that would take minutes is opened with ``python no-run``: it is compiled, and what it
imports must be there.
"""

import ast
import importlib
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from bench import cli
from tests.support.patience import HANGS_S

HOUSE = Path(__file__).resolve().parents[2]
README_FILES = [
    HOUSE / "README.md",
    HOUSE / "CONTRIBUTING.md",
    *sorted(HOUSE.glob("*/README.md")),
    *sorted(HOUSE.glob("bench/examples/*/README.md")),
]
FENCE = re.compile(r"^```(?P<info>[^\n`]*)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL)
COMMANDS = {"console", "sh", "bash", "shell"}
PROSE_COMMAND = re.compile(r"`(rvbench [^`]+)`")
LINK = re.compile(r"\]\((?!https?:|#|mailto:)([^)#\s]+)")
PLACEHOLDERS = {"VERB", "FRAME"}


@dataclass(frozen=True)
class Block:
    """A fenced block of a README."""

    path: Path
    line: int
    info: str
    body: str

    def __str__(self) -> str:
        return f"{self.path.relative_to(HOUSE)}:{self.line}"


def blocks(languages: set[str]) -> list[Block]:
    return [
        Block(path, text[: match.start()].count("\n") + 1, match["info"].strip(), match["body"])
        for path in README_FILES
        for text in [path.read_text()]
        for match in FENCE.finditer(text)
        if match["info"].split()[:1] and match["info"].split()[0] in languages
    ]


def command_lines(block: Block) -> list[str]:
    lines = block.body.replace("\\\n", " ").splitlines()
    return [line.removeprefix("$ ").strip() for line in lines]


PYTHON = blocks({"python"})
TYPED = [(block, line) for block in blocks(COMMANDS) for line in command_lines(block)]


def test_there_is_something_to_try():
    assert (HOUSE / "README.md").is_file()
    assert PYTHON
    assert TYPED


@pytest.mark.parametrize("block", PYTHON, ids=str)
def test_python_blocks_run(block, tmp_path):
    if "no-run" in block.info:
        for node in ast.walk(ast.parse(block.body)):
            if isinstance(node, ast.ImportFrom) and node.module:
                module = importlib.import_module(node.module)
                for alias in node.names:
                    if not hasattr(module, alias.name):
                        importlib.import_module(f"{node.module}.{alias.name}")
        return
    result = subprocess.run(
        [sys.executable, "-W", "error", "-c", block.body],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(HOUSE)},
        capture_output=True,
        text=True,
        check=False,
        timeout=HANGS_S,
    )
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize(
    ("block", "line"), [pair for pair in TYPED if pair[1].startswith("rvbench")], ids=str
)
def test_commands_parse(block, line):
    arguments = line.split("#")[0].split()[1:]
    if "--help" in arguments:
        assert cli.main(arguments) == 0
    else:
        assert isinstance(cli.parse(arguments), tuple(cli.VERBS.values()))


@pytest.mark.parametrize(
    ("block", "line"), [pair for pair in TYPED if pair[1].startswith("make ")], ids=str
)
def test_make_targets_exist(block, line):
    targets = line.split("#")[0].split()[1:]
    makefile = (HOUSE / "Makefile").read_text()
    for target in targets:
        assert re.search(rf"^{re.escape(target)}:", makefile, re.MULTILINE), target


def prose_commands() -> list[tuple[str, str]]:
    return [
        (str(path.relative_to(HOUSE)), command)
        for path in README_FILES
        for command in PROSE_COMMAND.findall(FENCE.sub("", path.read_text()))
    ]


@pytest.mark.parametrize(("path", "command"), prose_commands() or [("none", "rvbench list")])
def test_commands_in_the_text_name_verbs_and_options_that_exist(path, command):
    """Capitals such as DIR stand for what the reader fills in, so only names are looked at."""
    words = command.split()[1:]
    if words[0] in PLACEHOLDERS:
        return
    assert words[0] in cli.VERBS
    fields = {f"--{name.replace('_', '-')}" for name in cli.VERBS[words[0]].__dataclass_fields__}
    assert {word for word in words if word.startswith("--")} <= fields | {"--help"}


@pytest.mark.parametrize("path", README_FILES, ids=lambda path: str(path.relative_to(HOUSE)))
def test_links_lead_somewhere(path):
    for link in LINK.findall(path.read_text()):
        assert (path.parent / link).exists(), link
