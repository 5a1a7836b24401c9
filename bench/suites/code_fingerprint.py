"""What code a module runs, as a hash: its own, and that of all modules of the house it imports.

Comments and docstrings do not count, so that only what may change a result makes old results stale.
Two things it cannot see: data files, which belong in a unit's task, and modules imported by a name
that is only known when run, which the task has to name.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

ROOMS = ("models", "renders", "pipelines", "bench")


@cache
def code_fingerprint(*modules: str) -> str:
    """Return the hash of what some modules run, as hexadecimal text.

    Parameters
    ----------
    *modules : str
        Full names, as ``pipelines.uncooperative.pipeline``.
    """
    seen: dict[str, str] = {}
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        path = _source(name)
        if name in seen or path is None:
            continue
        tree = ast.parse(path.read_text())
        waiting += [found for found in _imported(tree) if found.split(".")[0] in ROOMS]
        seen[name] = hashlib.sha256(ast.dump(_without_docstrings(tree)).encode()).hexdigest()
    listed = "\n".join(f"{name} {seen[name]}" for name in sorted(seen))
    return hashlib.sha256(listed.encode()).hexdigest()


def _source(module: str) -> Path | None:
    """Return the file of a module; None for a name that is no module but something in one."""
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:
        return None
    return Path(spec.origin) if spec is not None and spec.origin is not None else None


def _imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None and node.level == 0:
            yield node.module
            yield from (f"{node.module}.{each.name}" for each in node.names)


def _without_docstrings(tree: ast.Module) -> ast.Module:
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
            and node.body
            and isinstance(node.body[0], ast.Expr)
            and isinstance(node.body[0].value, ast.Constant)
            and isinstance(node.body[0].value.value, str)
        ):
            node.body = node.body[1:] or [ast.Pass()]
    return tree
