"""Who renders what: every task once, some by the process that was asked, and nobody idle."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest

from bench.random_dataset import crew
from bench.random_dataset.crew import IN_HAND, Crew

HERE = threading.main_thread()


class Rendered:
    """Stands for ``render_frames``: who did which frames, and how many another process had."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.done: list[tuple[str, int, bool]] = []
        monkeypatch.setattr(crew, "render_frames", self)

    def __call__(self, request: SimpleNamespace, frames: Sequence[int]) -> int:
        own = threading.current_thread() is HERE
        self.done += [(request.out.name, frame, own) for frame in frames]
        return len(frames)


def shared(parts: dict[str, int], others: int, *, here: bool) -> list[int]:
    """Do as many tasks of two frames as each part has, with other workers that are threads."""
    pools = [ThreadPoolExecutor(1) for _ in range(others)]
    own = Crew(others + here)
    for name, count in parts.items():
        request = SimpleNamespace(out=Path(name))
        tasks = [(request, (2 * number, 2 * number + 1)) for number in range(count)]
        own.left[Path(name)] = crew.deque(tasks)  # type: ignore[arg-type]
    try:
        return list(own._shared(pools, here=here))  # type: ignore[arg-type]
    finally:
        for pool in pools:
            pool.shutdown()


@pytest.mark.parametrize("others", [0, 1, 3])
def test_every_frame_is_rendered_once(monkeypatch: pytest.MonkeyPatch, others: int) -> None:
    rendered = Rendered(monkeypatch)
    brought = shared({"a": 9, "b": 4}, others, here=True)
    assert brought == [2] * 13
    assert sorted(each[:2] for each in rendered.done) == sorted(
        [("a", frame) for frame in range(18)] + [("b", frame) for frame in range(8)]
    )
    assert any(own for *_, own in rendered.done)
    assert all(own for *_, own in rendered.done) == (others == 0)


def test_of_two_tasks_each_does_one(monkeypatch: pytest.MonkeyPatch) -> None:
    rendered = Rendered(monkeypatch)
    assert shared({"a": 2}, 1, here=True) == [2, 2]
    assert sorted(own for *_, own in rendered.done) == [False, False, True, True]


def test_a_process_that_renders_otherwise_hands_out_all(monkeypatch: pytest.MonkeyPatch) -> None:
    rendered = Rendered(monkeypatch)
    assert sum(shared({"a": 3, "b": 3}, 2, here=False)) == 12
    assert not any(own for *_, own in rendered.done)


def test_others_have_something_in_hand_while_this_process_renders(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The other waits for its first task's end until this one is at its own: two are handed out."""
    gate, waiting = threading.Event(), []

    def render(request: SimpleNamespace, frames: Sequence[int]) -> int:
        if threading.current_thread() is HERE:
            waiting.append(len(left))
            gate.set()
        else:
            assert gate.wait(60.0)
        return len(frames)

    monkeypatch.setattr(crew, "render_frames", render)
    own, pool = Crew(2), ThreadPoolExecutor(1)
    left = own.left[Path("a")] = crew.deque(
        (SimpleNamespace(out=Path("a")), (number,)) for number in range(8)
    )  # type: ignore[assignment]
    assert sum(own._shared([pool], here=True)) == 8  # type: ignore[list-item]
    pool.shutdown()
    assert waiting[0] == 8 - 1 - IN_HAND
