"""A chain that rvbench does not know passes through every exporter, none of which knows it."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

from bench.export.check import check_export
from bench.export.exporter import export_datasets
from bench.export.formats.catalogue import FORMATS
from bench.export.request import ExportRequest
from models.dataset.image_file import encode_image
from tests.house.test_engine_asks_no_kind import asked
from tests.support.invented_chain import write_beacon

HOUSE = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize("seen", [True, False])
def test_its_images_and_tables_leave(kind, seen, tmp_path):
    folder = write_beacon(tmp_path / "beacon", frames=3, seen=seen)
    out = tmp_path / "out"
    plan = export_datasets(ExportRequest((folder,), kind, out))
    assert [shot.split for shot in plan.shots] == ["unlabelled"] * (3 if seen else 0)
    assert check_export(out)[1].faults == []
    ranges = (out / "tables" / "000001" / "range_finder.csv").read_text()
    assert ranges == (folder / "ranges.csv").read_text()
    truth = (out / "tables" / "000001" / "truth_beacon.csv").read_text()
    assert truth == (folder / "truth" / "beacon.csv").read_text()
    assert (out / "card" / "frames.png").is_file() == seen
    assert "# beacon" in (out / "README.md").read_text()


@pytest.mark.slow
def test_colour_images_leave_in_colours(tumble, tmp_path):
    """Of a chain to come: the same dataset, its images with three channels."""
    import shutil

    folder = tmp_path / "colour"
    shutil.copytree(tumble, folder)
    rng = np.random.default_rng(1)
    for path in (folder / "frames").iterdir():
        path.write_bytes(encode_image(rng.integers(0, 4095, (96, 96, 3)).astype(np.uint16)))
    for kind, name in {"bop": "rgb/*.png", "bop-imagewise": "*.rgb.png"}.items():
        out = tmp_path / kind
        export_datasets(ExportRequest((folder,), kind, out))
        assert len(list(out.rglob(name))) == 3
        assert check_export(out)[1].faults == []


@pytest.mark.parametrize(
    "path", sorted((HOUSE / "bench" / "export").rglob("*.py")), ids=lambda path: path.name
)
def test_no_exporter_asks_which_chain_it_is(path):
    assert set(asked(ast.parse(path.read_text()))) == set()
