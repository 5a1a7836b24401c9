"""What lies below a folder, so that nothing is damaged unseen."""

from __future__ import annotations

import os
import stat
from collections.abc import Collection
from fnmatch import fnmatch
from pathlib import Path
from typing import TypeAlias

Tree: TypeAlias = dict[str, tuple[int, int, int, int]]
"""Kind, inode, size and time of writing, by path."""


def tree(folder: Path) -> Tree:
    """Return what lies below a folder, folders apart."""
    found: Tree = {}
    for place, _, names in os.walk(folder):
        for name in names:
            status = os.lstat(os.path.join(place, name))
            path = os.path.relpath(os.path.join(place, name), folder)
            kind = stat.S_IFMT(status.st_mode)
            found[path] = (kind, status.st_ino, status.st_size, status.st_mtime_ns)
    return found


def damage(before: Tree, after: Tree, allowed: Collection[str]) -> list[str]:
    """Return the paths that were changed, taken away or added, but for those that were allowed.

    Parameters
    ----------
    before, after : dict
    allowed : collection of str
        Patterns; a star stands for folders, too.
    """
    changed = sorted(path for path in {*before, *after} if before.get(path) != after.get(path))
    return [path for path in changed if not any(fnmatch(path, each) for each in allowed)]
