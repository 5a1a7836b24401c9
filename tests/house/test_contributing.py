"""What the README and CONTRIBUTING.md say of adding things is there: each file, each test."""

import re
from pathlib import Path

import pytest

HOUSE = Path(__file__).resolve().parents[2]
PATH = re.compile(r"`((?:bench|models|renders|pipelines|tests|docs)/[\w./-]+|make \w+)`")
ROW = re.compile(r"^\| (?P<what>[^|]+) \| (?P<copy>[^|]+) \| (?P<judge>[^|]+) \|$", re.MULTILINE)


def rows(file: str, heading: str) -> dict[str, tuple[str, str]]:
    """Return what a table tells to copy and who judges it, by what is added."""
    text = (HOUSE / file).read_text().partition(heading)[2]
    table = text.partition("\n\n```")[0] if file == "README.md" else text.partition("\n## ")[0]
    return {
        re.sub(r"\[(.*)\]\(.*\)", r"\1", row["what"].strip()): (row["copy"], row["judge"])
        for row in ROW.finditer(table)
        if row["what"].strip() and not row["what"].startswith("---")
    }


def sections() -> dict[str, str]:
    parts = re.split(r"^## (.*)$", (HOUSE / "CONTRIBUTING.md").read_text(), flags=re.MULTILINE)
    return {title.lower(): body for title, body in zip(parts[1::2], parts[2::2], strict=True)}


README = rows("README.md", "## To add")
HERE = rows("CONTRIBUTING.md", "# To add something")
KINDS = {
    "a spacecraft", "a pipeline, yours", "a pipeline, ours", "a chain", "a light", "a case",
    "a camera", "a suite", "a scenario key", "a page",
}  # fmt: skip


def missing(text: str) -> list[str]:
    """Return what a text names and is not there."""
    makefile = (HOUSE / "Makefile").read_text()
    return [
        name
        for name in PATH.findall(text)
        if not (
            f"\n{name.removeprefix('make ')}:" in makefile
            if name.startswith("make ")
            else (HOUSE / name).exists()
        )
    ]


def test_there_is_a_section_for_each_kind():
    assert set(sections()) == set(HERE) == KINDS


@pytest.mark.parametrize("what", sorted(HERE))
def test_a_section_names_what_to_copy_and_who_judges(what):
    copy, judge = HERE[what]
    for cell, where in ((copy, ""), (judge, "tests/")):
        (path,) = PATH.findall(cell)
        assert path.startswith(where)
        assert (HOUSE / path).exists(), path
        assert path in sections()[what]
    assert missing(sections()[what]) == []


@pytest.mark.parametrize("what", sorted(README))
def test_the_readme_says_the_same(what):
    assert README[what] == HERE[what]


def test_the_readme_has_the_table():
    assert {"a spacecraft", "a light", "a case", "a chain"} <= set(README)


def test_what_is_judged_is_judged_by_tests():
    for _, judge in HERE.values():
        (path,) = PATH.findall(judge)
        assert re.search(r"^def test_", (HOUSE / path).read_text(), re.MULTILINE), path


def test_a_path_that_is_not_there_is_seen():
    assert missing("`models/no_such.py` and `make nothing`, `make test`, `bench/`x") == [
        "models/no_such.py",
        "make nothing",
    ]


def test_the_changelog_has_its_form():
    text = (HOUSE / "CHANGELOG.md").read_text()
    assert re.findall(r"^## \[(.*?)\]", text, re.MULTILINE)[0] == "Unreleased"
    groups = set(re.findall(r"^### (.*)$", text, re.MULTILINE))
    assert groups <= {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    assert missing(text) == []
