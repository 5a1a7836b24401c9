"""The pages of the documentation site say what is so: blocks run, commands parse, links lead on.

Tutorials are run as a reader would, in an empty folder, at the sizes they show. What Sphinx alone
can tell (anchors, orphans, cross-references) `make docs` refuses; what it has built is read by
`docs/site/check.py`.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from bench import cli
from docs.site import api_pages, notebooks, page_blocks
from docs.site.check import faults_of
from tests.support.users_package import fresh_environment

HOUSE = Path(__file__).resolve().parents[2]
DOCS = HOUSE / "docs"
PAGES = sorted(
    path for path in DOCS.rglob("*.md") if path.parent != api_pages.PLACE or path.stem == "index"
)
TUTORIALS = sorted(path for path in (DOCS / "tutorials").glob("*.md") if path.stem != "index")
QUICK = frozenset[str]()  # each takes 18 s of a core and more: `make slow`
LINK = re.compile(r"\]\((?!https?:|#|mailto:)([^)#\s]+)")


def named(path: Path) -> str:
    return str(path.relative_to(DOCS))


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=() if path.stem in QUICK else pytest.mark.slow, id=path.stem)
        for path in TUTORIALS
    ],
)
def test_a_tutorial_runs_as_a_reader_would_run_it(path, tmp_path, monkeypatch):
    monkeypatch.setenv("RVBENCH_STORE", str(tmp_path / "store"))
    text = path.read_text()
    python = fresh_environment(tmp_path / "own") if "pip install" in text else sys.executable
    (folder := tmp_path / "folder").mkdir()
    page_blocks.do_page(text, folder, python)


@pytest.mark.parametrize("path", PAGES, ids=named)
def test_what_a_page_shows_can_be_typed(path):
    text = path.read_text()
    makefile = (HOUSE / "Makefile").read_text()
    for block in page_blocks.blocks_of(text):
        for words in page_blocks.commands_of(block):
            if words[0] == "rvbench":
                assert isinstance(cli.parse(words[1:]), tuple(cli.VERBS.values())), words
            if words[0] == "make":
                for target in words[1:]:
                    if "=" in target:
                        assert f"$({target.split('=')[0]})" in makefile, target
                        continue
                    assert re.search(rf"^{re.escape(target)}:", makefile, re.MULTILINE), target
    for link in LINK.findall(page_blocks.FENCE.sub("", text)):
        assert (path.parent / link).exists(), link


def test_there_are_pages():
    assert len(TUTORIALS) == 6
    assert {DOCS / "scenario.md", DOCS / "gallery.md"} < set(PAGES)


def test_a_page_that_lies_is_caught(tmp_path):
    """The test of tutorials, tested: a command that fails, and output that was not printed."""
    with pytest.raises(SystemExit, match="line 1 ended with 2"):
        page_blocks.do_page("```console\nrvbench show nowhere 1\n```\n", tmp_path)
    said = "```python\nprint('found 3 of 4')\n```\n\n```text\nfound {} of 9\n```\n"
    page_blocks.do_page(said.format(5), tmp_path)
    with pytest.raises(SystemExit, match="nothing printed"):
        page_blocks.do_page(said.format("most"), tmp_path)


@pytest.mark.parametrize("name", notebooks.NAMES)
def test_a_notebook_is_its_tutorial(name):
    """After a tutorial has changed: ``python -m docs.site.notebooks``."""
    kept = json.loads((DOCS / "notebooks" / f"{name}.ipynb").read_text())
    assert kept == notebooks.notebook_of((DOCS / "tutorials" / f"{name}.md").read_text())


def test_every_module_has_a_place_in_the_api():
    made = "\n".join(api_pages.pages().values())
    named_there = set(re.findall(r"automodule:: ([\w.]+)", made))
    for room in api_pages.ROOMS:
        for path in (HOUSE / room).rglob("*.py"):
            name = api_pages.name_of(path)
            empty = path.stat().st_size == 0 or path.stem == "__main__" or name == room
            if not empty and not name.startswith(api_pages.LEFT_OUT):
                assert name in named_there, name


def test_dead_links_orphans_and_the_network_are_found(tmp_path):
    """The check of the built site, tested."""
    (tmp_path / "index.html").write_text(
        '<a href="a.html#there">a</a><a href="https://example.org">out</a>'
    )
    (tmp_path / "a.html").write_text('<h1 id="there">a</h1><a href="index.html">back</a>')
    assert faults_of(tmp_path) == []
    (tmp_path / "b.html").write_text(
        '<a href="a.html#gone">a</a><a href="c.html">c</a><img src="no.png">'
        '<script src="https://cdn.example.org/x.js"></script>'
        "<style>body { background: url(//example.org/y.png) }</style>"
    )
    said = "\n".join(faults_of(tmp_path))
    for fault in ("b.html: no page leads here", "a.html#gone", "c.html", "no.png", "x.js", "y.png"):
        assert fault in said
    assert len(faults_of(tmp_path)) == 6


def test_the_check_ends_with_one_message(tmp_path):
    command = [sys.executable, str(DOCS / "site" / "check.py"), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "index.html" in done.stderr
