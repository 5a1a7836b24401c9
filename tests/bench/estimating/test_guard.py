"""The guard and the process behind it: what never comes back is ended, and nothing waits for it."""

import socket
import threading
from pathlib import Path

import numpy as np
import pytest

from bench.estimating import pipeline_process
from bench.estimating.channel import Channel, Closed
from bench.estimating.contenders import Contender
from bench.estimating.estimation import estimate_dataset
from bench.estimating.guard import Guards, InAnotherProcess
from bench.estimating.pipeline_process import Hung, PipelineProcess
from bench.estimating.runs import estimates_path
from models.errors import ScenarioError
from models.frame import Frame, ImageReading
from models.onboard import OnboardKnowledge
from tests.support.odd_pipelines import HERE
from tests.support.synthetic_dataset import write_dataset

# No test waits for a good answer with the first limit, nor for a bad one with the second.
SHORT_S, LONG_S = 1.0, 600.0


def frame(index: int, width_px: int = 4) -> Frame:
    image = ImageReading(np.zeros((width_px, width_px), np.uint16), float(index), 1.0)
    return Frame(index, float(index), {"s": image})


def contender(name: str, **fields) -> Contender:
    place = f"{HERE}:{name.upper().replace('-', '_')}"
    return Contender(name, name, "default", "", place, **fields)


def process(name: str, onboard: OnboardKnowledge, **options) -> PipelineProcess:
    return PipelineProcess(name, contender(name).place, "default", onboard, **options)


def test_a_loop_is_cut_and_the_next_frame_is_seen():
    """The limit of the frame that loops is short: it holds on any machine, since it never ends."""
    guarded = InAnotherProcess(contender("loops"), OnboardKnowledge(), LONG_S)
    try:
        assert guarded.process(frame(1)).estimate.reason == "seen"
        first = guarded.running.process_id
        guarded._limit_s = SHORT_S
        assert "took longer than 1 s" in guarded.process(frame(0)).estimate.reason
        guarded._limit_s = LONG_S
        assert guarded.process(frame(2)).estimate.reason == "seen"
        assert guarded.running.process_id != first
        assert not Path(f"/proc/{first}").exists()
    finally:
        guarded.close()


def test_what_is_never_made_is_ended():
    with pytest.raises(Hung, match="took longer than"):
        process("never-made", OnboardKnowledge(), start_limit_s=SHORT_S)


def test_what_is_never_made_is_left_out_beside_others(monkeypatch, capsys):
    monkeypatch.setattr(pipeline_process.PipelineProcess.__init__, "__defaults__", (SHORT_S,))
    with (
        pytest.raises(ScenarioError, match="found none"),
        Guards([contender("never-made")], OnboardKnowledge(), None),
    ):
        pass
    assert "left out: pipeline never-made" in capsys.readouterr().err
    with (
        pytest.raises(ScenarioError, match="never-made: expected it to be made"),
        Guards([contender("never-made", asked=True)], OnboardKnowledge(), None),
    ):
        pass


def test_what_cannot_be_made_again_is_given_up(tmp_path):
    onboard = OnboardKnowledge(tables={"odd.toml": {"folder": str(tmp_path)}})
    guarded = InAnotherProcess(contender("made-once"), onboard, SHORT_S)
    try:
        assert "took longer" in guarded.process(frame(0)).estimate.reason
        for index in (1, 2):
            said = guarded.process(frame(index)).estimate
            assert said.reason.startswith("the pipeline could not be made again: ")
            assert "FileExistsError" in said.reason
    finally:
        guarded.close()


def test_a_process_that_takes_nothing_more_is_ended():
    """A frame larger than what a socket holds, sent to a process that stands still."""
    running = process("deaf", OnboardKnowledge())
    try:
        assert running.ask(frame(0), LONG_S).estimate.reason == "seen"
        stat = Path(f"/proc/{running.process_id}/stat")
        while stat.read_text().rpartition(")")[2].split()[0] != "T":
            pass
        with pytest.raises(Hung, match="took longer than"):
            running.ask(frame(1, width_px=2048), SHORT_S)
    finally:
        running.end()


def test_where_memory_runs_out_the_pipeline_goes_first():
    running = process("loops", OnboardKnowledge())
    try:
        score = Path(f"/proc/{running.process_id}/oom_score_adj").read_text()
        assert int(score) == 1000
    finally:
        running.end()


def test_under_a_limit_ours_say_the_same_to_the_byte(tmp_path):
    """In a process of their own, through text and back: no digit changes."""
    folders = [write_dataset(tmp_path / name, frames=2).folder for name in "ab"]
    estimate_dataset(folders[0])
    estimate_dataset(folders[1], limit_s=LONG_S)
    for label in ("best", "paper"):
        here, there = (estimates_path(folder, 0, label).read_bytes() for folder in folders)
        assert here == there


@pytest.fixture
def pair():
    ours, theirs = socket.socketpair()
    yield Channel(ours), theirs
    ours.close()
    theirs.close()


def test_messages_arrive_whole(pair):
    ours, theirs = pair
    message = bytes(range(256)) * 40_000
    thread = threading.Thread(target=lambda: Channel(theirs).send(message))
    thread.start()
    assert ours.receive(LONG_S) == message
    thread.join()


def test_a_message_that_never_ends_is_not_waited_for(pair):
    ours, theirs = pair
    theirs.sendall((1000).to_bytes(8, "big") + b"begun")
    with pytest.raises(TimeoutError):
        ours.receive(SHORT_S)


@pytest.mark.parametrize("sent", [b"", b"\0\0", (9).to_bytes(8, "big") + b"cut"])
def test_a_message_that_is_cut_is_none(pair, sent):
    ours, theirs = pair
    theirs.sendall(sent)
    theirs.close()
    with pytest.raises(Closed):
        ours.receive(LONG_S)


def test_a_message_beyond_all_bounds_is_not_taken(pair):
    ours, theirs = pair
    theirs.sendall((1 << 62).to_bytes(8, "big"))
    with pytest.raises(Closed, match="at most 100"):
        ours.receive(LONG_S, most_bytes=100)
