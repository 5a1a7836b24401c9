"""What shaped a suite reads on its page as one would type it."""

from dataclasses import dataclass, field

import pytest

from bench.suites.told_settings import told_settings, told_value
from bench.suites.uncooperative_suns.plan import Sizes


@dataclass(frozen=True)
class Gate:
    sigmas: float = 3.5
    kind: str = "chi2"


@dataclass(frozen=True)
class Options:
    gate: Gate = field(default_factory=Gate)
    steps: tuple[int, ...] = (1, 2)
    rival: str | None = None
    is_robust: bool = True


def test_sizes_are_options_of_the_command_line():
    told = told_settings({**vars(Sizes(runs=20, paper_runs=None)), "targets": ["xmm", "hispasat"]})
    assert ("--runs", "20") in told
    assert ("--paper-runs", "as the suite has it") in told
    assert ("samples", "32") in told
    assert ("targets", "xmm hispasat") in told


def test_options_of_a_pipeline_are_names_and_values():
    told = told_settings({"options": {"best": repr(Options())}})
    assert told == [
        ("options: best", "gate (sigmas 3.5, kind chi2), steps 1 2, rival none, is_robust yes")
    ]


@pytest.mark.parametrize("text", ["cx (px)", "1f0c3e", "A(", "1" + "0" * 40, "(" * 300])
def test_other_texts_stay_as_they_are(text):
    assert told_value(text) == text
