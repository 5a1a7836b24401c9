"""One small rendered dataset, exported as often as the tests ask; and one that no renderer made."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from bench import api
from bench.export.exporter import export_datasets
from bench.export.request import ExportRequest
from tests.support.rendered_dataset import render_tumble
from tests.support.synthetic_dataset import write_dataset


@pytest.fixture(scope="session")
def tumble(tmp_path_factory) -> Path:
    """Return XMM in three frames of 96 x 96."""
    return render_tumble(tmp_path_factory.mktemp("tumble"))


@pytest.fixture(scope="session")
def pairs(tmp_path_factory) -> Path:
    """Return image pairs of Maxar's markers, with no pixel truth, and estimates."""
    folder = write_dataset(tmp_path_factory.mktemp("pairs") / "data", 2, width_px=128).folder
    api.estimate(folder)
    return folder


@pytest.fixture(scope="session")
def exported(tmp_path_factory, tumble) -> Callable[[str], Path]:
    """Return what exports the tumble in a format, once."""
    done: dict[str, Path] = {}

    def export(kind: str) -> Path:
        if kind not in done:
            out = tmp_path_factory.mktemp("exports") / kind
            export_datasets(ExportRequest((tumble,), kind, out, split=(0.4, 0.3, 0.3)))
            done[kind] = out
        return done[kind]

    return export
