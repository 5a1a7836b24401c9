"""Text is text on a terminal, and nobody in the house makes a console that thinks otherwise."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from rich.table import Table

from models.plain_console import plain_console

HOUSE = Path(__file__).resolve().parents[2]
OWN = HOUSE / "models" / "plain_console.py"
FILES = [
    path
    for room in ("models", "renders", "pipelines", "bench")
    for path in (HOUSE / room).rglob("*.py")
    if path != OWN
]
NAME = "[bold red]x[/nosuch] :smile:"


def test_brackets_and_colons_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    console = plain_console(width=80)
    table = Table(title=NAME)
    table.add_column(NAME)
    table.add_row(NAME)
    console.print(NAME)
    console.print(table)
    assert capsys.readouterr().out.count(NAME) == 4


def test_every_console_is_a_plain_one() -> None:
    makers = [
        path
        for path in FILES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("Console")
    ]
    assert makers == []
