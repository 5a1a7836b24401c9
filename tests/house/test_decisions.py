"""Decisions are short: what, why, what it costs; numbers stand beside, under their titles."""

import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
WIDEST = 100
TITLE = re.compile(r"^## (.+)$", re.MULTILINE)
LINES = re.compile(r"- What: .+\n- Why: .+\n- Cost: .+")


def sections(text: str) -> dict[str, str]:
    """Return what stands under each title, the head of the file left out."""
    _, *pieces = TITLE.split(text)
    return {title: body.strip() for title, body in zip(pieces[::2], pieces[1::2], strict=True)}


def lengthy(text: str) -> list[str]:
    return [
        title
        for title, body in sections(text).items()
        if not LINES.fullmatch(body) or max(map(len, body.splitlines())) > WIDEST
    ]


def test_a_decision_is_three_lines():
    text = (DOCS / "decisions.md").read_text()
    assert len(sections(text)) > 30
    assert lengthy(text) == []


def test_measurements_are_told_under_the_title_of_a_decision():
    decided = sections((DOCS / "decisions.md").read_text())
    measured = sections((DOCS / "measurements.md").read_text())
    assert list(measured) == [title for title in decided if title in measured]
    assert all(measured.values())


def test_the_rule_for_decisions_can_fail():
    good = "# D\n\n## A\n\n- What: this.\n- Why: that.\n- Cost: none.\n"
    assert sections(good) == {"A": "- What: this.\n- Why: that.\n- Cost: none."}
    assert lengthy(good) == []
    assert lengthy(good.replace("- Cost: none.\n", "")) == ["A"]
    assert lengthy(good + "And more.\n") == ["A"]
    assert lengthy(good.replace("this", WIDEST * "x")) == ["A"]
