"""One mutant under the tests that reach it. Its file is never written: it is changed on import."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import CodeType

import pytest

from tests.mutants.mutation import Mutant
from tests.mutants.reach import QUIETLY

KILLED = int(pytest.ExitCode.TESTS_FAILED)


class Slipped(SourceFileLoader):
    """Loads one module with a slip in it."""

    mutant: Mutant

    def get_code(self, fullname: str) -> CodeType:
        """Return the code of the file as it would be."""
        return compile(self.mutant.of(Path(self.path).read_bytes()), self.path, "exec")


class SlipsIn:
    """Finds the one module that is to be loaded so."""

    def __init__(self, mutant: Mutant):
        self.mutant = mutant
        name = mutant.file.removesuffix(".py").replace("/", ".")
        self.module = name.removesuffix(".__init__")

    def find_spec(self, name: str, path: Sequence[str] | None, target=None) -> ModuleSpec | None:
        """Return the module's own place with another loader; None for all other modules."""
        if name != self.module:
            return None
        spec = PathFinder.find_spec(name, path)
        assert spec is not None
        assert spec.origin is not None
        spec.loader = Slipped(name, spec.origin)
        spec.loader.mutant = self.mutant
        return spec


def judge(mutant: Mutant, tests: Sequence[str]) -> int:
    """Run tests on a mutant in this process; return 0 if it survives all of them.

    To be called in a process of its own, before anything of ours is imported.
    """
    sys.meta_path.insert(0, SlipsIn(mutant))  # type: ignore[arg-type]
    code = int(pytest.main([*tests, "-x", "--tb=line", *QUIETLY]))
    return 0 if code == 0 else KILLED
