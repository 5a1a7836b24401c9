"""The hash of code follows what runs, through every import, and not what is only read."""

import sys

import pytest

from bench.suites.code_fingerprint import code_fingerprint

INNER = '"""Inner."""\n\n\ndef one() -> int:\n    """Return one."""\n    return 1\n'
OUTER = '"""Outer."""\n\nfrom models.of_a_test import one\n\nONE = one()\n'


@pytest.fixture
def planted(tmp_path, monkeypatch):
    """Put two modules on the path of the package ``models``; return how to write the inner one."""
    import models

    monkeypatch.setattr(models, "__path__", [*models.__path__, str(tmp_path)])
    (tmp_path / "outer_of_a_test.py").write_text(OUTER)

    def write(inner: str) -> str:
        (tmp_path / "of_a_test.py").write_text(inner)
        sys.path_importer_cache.clear()
        code_fingerprint.cache_clear()
        return code_fingerprint("models.outer_of_a_test")

    yield write
    code_fingerprint.cache_clear()


def test_code_of_an_imported_module_counts(planted):
    assert planted(INNER) != planted(INNER.replace("return 1", "return 2"))


@pytest.mark.parametrize(
    "read_only",
    [
        INNER.replace("Return one.", "Return the least odd number."),
        INNER.replace("    return 1", "    # of all numbers\n    return 1"),
        INNER.replace('"""Inner."""\n', ""),
    ],
)
def test_docstrings_and_comments_do_not(planted, read_only):
    assert planted(INNER) == planted(read_only)


def test_the_order_of_names_does_not_matter():
    names = ("models.pose", "models.camera")
    assert code_fingerprint(*names) == code_fingerprint(*reversed(names))
    assert code_fingerprint(*names) != code_fingerprint("models.pose")
