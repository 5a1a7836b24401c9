"""Lines of progress: often enough to be believed, seldom enough to be read."""

import pytest

from models.progress_lines import EVERY_S, LinePace, ProgressLines


class Clock:
    """Seconds that pass when told to."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def said(total: int, step_s: float) -> list[str]:
    clock, lines = Clock(), []
    progress = ProgressLines("render", total, lines.append, clock)
    for _ in range(total):
        clock.now_s += step_s
        progress.advance()
    return lines


def test_fast_work_is_told_in_tenths():
    lines = said(400, 1e-3)
    assert len(lines) == 10
    assert lines[0] == "render: 40 of 400; left: none"
    assert lines[-1] == "render: 400 of 400; left: none"


def test_slow_work_is_told_every_ten_seconds_at_first():
    lines = said(1000, 5.0)
    assert lines[:2] == [
        "render: 2 of 1000; left: about 83 min",
        "render: 4 of 1000; left: about 83 min",
    ]


def test_each_step_that_takes_long_has_its_line():
    assert len(said(5, 60.0)) == 5


def test_hours_make_tens_of_lines():
    """10 in the first 100 s; then each a tenth of the time so far after the last: 4 h in 52 more.

    Beside them the tenths of the work.
    """
    assert 30 < len(said(14_400, 1.0)) <= 10 + 53 + 10


@pytest.mark.parametrize("done", [1, 7])
def test_the_last_piece_is_always_told(done):
    pace = LinePace(done, Clock())
    assert pace.due(done)


def test_what_was_just_told_is_not_told_again():
    clock = Clock()
    pace = LinePace(1000, clock)
    clock.now_s += EVERY_S
    assert pace.due(1)
    assert not pace.due(2)
