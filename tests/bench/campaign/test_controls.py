"""What the campaign types is right until it is spoilt, or the campaign does not begin."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.campaign.hostile import controls
from bench.campaign.hostile.kinds import COMMAND_LINE
from bench.campaign.hostile.typed import LINES
from bench.campaign.hostile.verdict import Heard
from models.errors import RvbenchError


@pytest.fixture
def typed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[list[str]]:
    """Collect what is typed, and answer each: ``compare`` is refused once it is asked to be."""
    found: list[list[str]] = []

    def hear(words: list[str], place: Path) -> Heard:
        found.append(words)
        refused = words[0] == "compare" and "refuse" in found[0]
        return Heard(2, "rvbench: expected more\n") if refused else Heard(0, "")

    monkeypatch.setattr(controls, "hear", hear)
    monkeypatch.setattr(controls, "lay_out", lambda name, grounds, folder: folder)
    for name in ("said.bop.csv", "said.tum"):
        (tmp_path / "pairs").mkdir(exist_ok=True)
        (tmp_path / "pairs" / name).write_text("x\n")
    return found


def test_every_line_is_typed_with_its_file(typed: list[list[str]], tmp_path: Path) -> None:
    controls.check_controls(tmp_path, tmp_path / "trial", "BOP results", full=True)
    assert {words[0] for words in typed} == {"score", "compare"}
    assert all("pairs/said.bop.csv" in words for words in typed)
    typed.clear()
    controls.check_controls(tmp_path, tmp_path / "trial", COMMAND_LINE, full=False)
    assert typed == [list(line) for line in LINES]


def test_a_line_that_is_refused_ends_the_campaign(typed: list[list[str]], tmp_path: Path) -> None:
    typed.append(["refuse"])
    with pytest.raises(RvbenchError, match=r"compare pairs/data pairs/said\.tum .*got: rvbench"):
        controls.check_controls(tmp_path, tmp_path / "trial", "TUM trajectory", full=True)
