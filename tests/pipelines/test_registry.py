"""Pipelines by name: ours, those that other packages bring, and those that cannot be loaded."""

from __future__ import annotations

from dataclasses import replace
from importlib.metadata import EntryPoint

import pytest

from models.errors import DatasetError, ScenarioError
from models.estimate import Estimate
from models.frame import Frame
from models.onboard import OnboardKnowledge
from pipelines import registry
from pipelines.pipeline import RegisteredPipeline
from pipelines.registry import GROUP, is_ours, pipeline_names, registered_pipeline
from tests.support.public_halves import IMAGES, IMAGES_ON_BOARD, PAIRS, PAIRS_ON_BOARD


class Silent:
    """A pipeline that never finds a pose."""

    def process(self, frame: Frame) -> Estimate:
        return Estimate(frame.index, frame.time_s, reason="it never looks")


def make_silent(onboard: OnboardKnowledge, variant: str) -> Silent:
    return Silent()


SILENT = RegisteredPipeline("silent", make_silent, streams=("image",))
NO_PIPELINE = object()


@pytest.fixture
def brought(monkeypatch: pytest.MonkeyPatch):
    """Let a package bring entry points: name to object reference."""

    def bring(**points: str) -> None:
        found = [
            EntryPoint(name.replace("__", " "), value, GROUP) for name, value in points.items()
        ]
        monkeypatch.setattr(registry, "entry_points", lambda group: found)
        registered_pipeline.cache_clear()

    yield bring
    registered_pipeline.cache_clear()


@pytest.mark.parametrize(
    ("name", "info", "onboard", "other"),
    [
        ("chaser_fixed", PAIRS, PAIRS_ON_BOARD, IMAGES_ON_BOARD),
        ("uncooperative", IMAGES, IMAGES_ON_BOARD, PAIRS_ON_BOARD),
    ],
)
def test_ours_are_made_from_what_is_on_board(name: str, info, onboard, other) -> None:
    pipeline = registered_pipeline(name)
    assert is_ours(name)
    assert pipeline.name == name
    assert set(pipeline.streams) <= {each.name for each in info.streams}
    assert pipeline.variants == ("paper", "best")
    for variant in pipeline.variants:
        made = pipeline.make(onboard, variant)
        assert made is not pipeline.make(onboard, variant)  # each run has its own
        for lacking in (other, replace(onboard, camera=None)):
            with pytest.raises(DatasetError, match=f"for the pipeline {name}, got none"):
                pipeline.make(lacking, variant)
    with pytest.raises(ScenarioError, match="among paper, best, got 'bset'"):
        pipeline.make(onboard, "bset")


def test_ours_are_told_apart_by_every_setting() -> None:
    hashes = {
        registered_pipeline(name).settings_hash(variant)
        for name in ("chaser_fixed", "uncooperative")
        for variant in ("paper", "best")
    }
    assert len(hashes) == 4
    assert [registered_pipeline("chaser_fixed").labelled(v) for v in ("paper", "best")] == [
        "paper",
        "best",
    ]


def test_others_are_brought_by_their_packages(brought) -> None:
    brought(silent=f"{__name__}:SILENT")
    assert pipeline_names() == [
        "chaser_fixed",
        "eye_in_hand",
        "uncooperative",
        "unknown_target",
        "absolute",
        "integrated",
        "silent",
    ]
    pipeline = registered_pipeline("silent")
    assert not is_ours("silent")
    assert pipeline.labelled("default") == "silent"
    assert not pipeline.make(PAIRS_ON_BOARD, "default").process(Frame(3, 0.5, {}))


def test_several_variants_are_labelled_with_the_name() -> None:
    several = RegisteredPipeline("silent", make_silent, ("image",), variants=("a", "b"))
    assert several.labelled("b") == "silent-b"


def test_settings_that_nobody_tells_are_the_code() -> None:
    """Another text of the module is another hash: what was estimated with it is estimated anew."""
    assert SILENT.settings_hash("default") == SILENT.settings_hash("default")
    assert SILENT.settings_hash("default") != SILENT.settings_hash("other")
    elsewhere = RegisteredPipeline("silent", _made_elsewhere(), streams=("image",))
    assert elsewhere.settings_hash("default") != SILENT.settings_hash("default")


def _made_elsewhere():
    scope: dict[str, object] = {}
    exec("def make(onboard, variant):\n    return None\n", scope)
    return scope["make"]


def test_a_name_of_ours_is_not_taken_over_and_odd_names_are_left(brought) -> None:
    brought(chaser_fixed=f"{__name__}:SILENT", Silent=f"{__name__}:SILENT", a__b="x:y")
    assert pipeline_names() == [
        "chaser_fixed",
        "eye_in_hand",
        "uncooperative",
        "unknown_target",
        "absolute",
        "integrated",
    ]
    assert registered_pipeline("chaser_fixed").make is not make_silent


def test_an_unknown_name_is_told_with_the_nearest(brought) -> None:
    brought(silent=f"{__name__}:SILENT")
    with pytest.raises(
        ScenarioError,
        match="absolute, integrated, silent, got 'silnet'; perhaps you meant silent",
    ):
        registered_pipeline("silnet")


@pytest.mark.parametrize(
    ("reference", "said"),
    [
        ("no_such_module_of_anybody:X", "to be loaded, got ModuleNotFoundError"),
        (f"{__name__}:ABSENT", "to be loaded, got AttributeError"),
        (f"{__name__}:NO_PIPELINE", "to be a RegisteredPipeline of that name"),
        (f"{__name__}:SILENT", "to be a RegisteredPipeline of that name"),
    ],
)
def test_one_that_cannot_be_loaded_says_so(brought, reference: str, said: str) -> None:
    brought(broken=reference)
    with pytest.raises(ScenarioError, match=rf"pipeline broken.*{said}"):
        registered_pipeline("broken")
