"""A wrong line: what a slip of the hand makes of numeric code, one place at a time."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from tests.mutants.slips import ONE_PERCENT, is_axis, slips

SAID = (ast.Raise, ast.Assert, ast.JoinedStr, ast.Import, ast.ImportFrom)
"""Messages and imports: no numeric code."""
DECLARED = {"Field", "arg", "print", "warn", "add_column", "RvbenchError"}
"""Calls whose arguments tell of a value and compute none."""


@dataclass(frozen=True)
class Mutant:
    """One change to one file: bytes `start` to `end` of it become `text`."""

    file: str
    line: int
    start: int
    end: int
    text: str
    slip: str
    scope: str
    first_line: int
    last_line: int
    """Of the statement, or of the head of one, that it is in: reached together."""

    @property
    def name(self) -> str:
        """Return what finds it again."""
        return f"{self.file}:{self.start}-{self.end}:{self.text}"

    @property
    def is_one_percent(self) -> bool:
        """Tell whether it only changes a number by a hundredth."""
        return self.slip == ONE_PERCENT

    def of(self, source: bytes) -> bytes:
        """Return the file as it would be with the slip in it."""
        return source[: self.start] + self.text.encode() + source[self.end :]

    def lines(self, source: bytes) -> tuple[str, str]:
        """Return the lines it changes, before and after, without their margins."""
        first = source.rfind(b"\n", 0, self.start) + 1
        last = source.find(b"\n", self.end)
        before = source[first:last].decode()
        head, tail = source[first : self.start].decode(), source[self.end : last].decode()
        return " ".join(before.split()), " ".join((head + self.text + tail).split())


@dataclass(frozen=True)
class _At:
    """Where a walk is: the function, and the lines that are reached together, if any is."""

    scope: str = ""
    lines: tuple[int, int] = (0, 0)

    def below(self, node: ast.AST, parent: ast.AST | None) -> _At:
        """Return where it is below a node."""
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            return replace(self, scope=f"{self.scope}.{node.name}".lstrip("."))
        whole = isinstance(node, ast.stmt) and not hasattr(node, "body")
        heads = isinstance(parent, ast.stmt) and hasattr(parent, "body")
        if (whole or heads) and isinstance(node, ast.stmt | ast.expr):
            return replace(self, lines=(node.lineno, node.end_lineno or node.lineno))
        return self


def places(file: str, source: bytes) -> Iterator[list[Mutant]]:
    """Walk the places of a file where a slip can happen, each with all slips possible there."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    for node, parent, at in _numeric(ast.parse(source), None, _At()):
        begin = starts[node.lineno - 1] + node.col_offset
        first, last = min(at.lines[0] or node.lineno, node.lineno), max(at.lines[1], node.lineno)
        found = [
            Mutant(
                file, node.lineno, begin + since, begin + until, text, slip, at.scope, first, last
            )
            for since, until, text, slip in slips(node, parent, source, begin, starts)
        ]
        if found:
            yield found


def _numeric(
    node: ast.AST, parent: ast.AST | None, at: _At
) -> Iterator[tuple[ast.expr, ast.AST | None, _At]]:
    """Walk the expressions that compute, each with its parent and where it stands."""
    if isinstance(node, SAID) or (isinstance(node, ast.Call) and _called(node) in DECLARED):
        return
    if isinstance(node, ast.If) and "__name__" in ast.unparse(node.test):
        return
    at = at.below(node, parent)
    if isinstance(node, ast.expr):
        yield node, parent, at
        if is_axis(parent):
            return
    for field, value in ast.iter_fields(node):
        if field in {"annotation", "returns", "decorator_list", "bases"}:
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _numeric(child, node, at)


def _called(call: ast.Call) -> str:
    return call.func.attr if isinstance(call.func, ast.Attribute) else ast.unparse(call.func)


def is_numeric(path: Path) -> bool:
    """Tell whether a file computes with NumPy or math, and never through the renderer."""
    text = path.read_text()
    imported = {
        name
        for node in ast.walk(ast.parse(text))
        for name in (
            [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else [node.module or ""]
            if isinstance(node, ast.ImportFrom)
            else []
        )
    }
    rooms = {name.split(".")[0] for name in imported}
    return bool(rooms & {"numpy", "math"}) and not rooms & {"mitsuba", "drjit"}
