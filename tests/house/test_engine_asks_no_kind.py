"""The engine never asks which kind it handles: chains say it of themselves, in files of their own.

What is looked for are the names of our chains, pipelines and streams, in words or as constants;
what is of one chain alone being imported; a world or a motion asked of which kind it is.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import models.frame
from bench.chains.catalogue import OURS as CHAINS
from pipelines.registry import OURS as PIPELINES

HOUSE = Path(__file__).resolve().parents[2]
ENGINE = (
    "bench/estimating/*.py",
    "bench/estimating/foreign_estimates/*.py",
    "bench/scoring/*.py",
    "bench/scoring/metrics/*.py",
    "bench/compare/*.py",
    "bench/report/*.py",
    "bench/report/explorer/*.py",
    "bench/pictures/frame_record.py",
    "bench/pictures/show.py",
    "bench/pictures/stretch.py",
    "bench/sweep/*.py",
    "bench/api.py",
    "bench/verbs.py",
    "renders/batches/*.py",
)
FILES = [path for pattern in ENGINE for path in sorted(HOUSE.glob(pattern))]

STREAM_CONSTANTS = {name for name in vars(models.frame) if name.isupper() and name != "NAMES"}
STREAMS = {getattr(models.frame, name) for name in STREAM_CONSTANTS} - {"image"}  # a kind of file
WORDS = {*CHAINS, *PIPELINES, *STREAMS}
KIND_ATTRIBUTES = {"tumble"}
OF_ONE_KIND = (
    *(f"bench.{part}.{kind}" for part in ("estimating", "scoring", "report", "pictures")
      for kind in ("pairs", "tumble")),
    *(f"pipelines.{name}" for name in PIPELINES),
    *CHAINS.values(),
)  # fmt: skip

# Whoever reads files that come without any dataset must say which streams they are.
ALLOWED = {
    "bench/estimating/foreign_frames.py": {"IMAGE_800", "CHASER_ORBIT"},
    "bench/estimating/foreign_images.py": {"IMAGE", "IMAGE_800", "IMAGE_850"},
}


def asked(tree: ast.Module) -> Iterator[str]:
    """Walk what a file asks of the kind that it handles."""
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}  # docstrings
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and node.value in WORDS and id(node) not in told:
            yield repr(node.value)
        elif isinstance(node, ast.Name) and node.id in STREAM_CONSTANTS:
            yield node.id
        elif isinstance(node, ast.Attribute) and node.attr in STREAM_CONSTANTS | KIND_ATTRIBUTES:
            yield node.attr
        elif isinstance(node, ast.ImportFrom | ast.Import):
            module = getattr(node, "module", None) or ""
            for name in node.names:
                if name.name in STREAM_CONSTANTS:
                    yield name.name
                if f"{module}.{name.name}.".lstrip(".").startswith(
                    tuple(f"{each}." for each in OF_ONE_KIND)
                ):
                    yield f"import {module or name.name}"
        elif isinstance(node, ast.Call) and ast.unparse(node.func) == "isinstance":
            kinds = ast.unparse(node.args[1])
            if "World" in kinds or "Chain" in kinds:
                yield f"isinstance of {kinds}"


def named(path: Path) -> str:
    return str(path.relative_to(HOUSE))


@pytest.mark.parametrize("path", FILES, ids=named)
def test_the_engine_asks_no_kind(path):
    found = set(asked(ast.parse(path.read_text())))
    assert found <= ALLOWED.get(named(path), set())


def test_what_is_allowed_is_needed():
    for name, words in ALLOWED.items():
        assert set(asked(ast.parse((HOUSE / name).read_text()))) == words


def test_the_engine_is_there():
    for pattern in ENGINE:
        assert list(HOUSE.glob(pattern)), pattern


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("if info.chain == 'tumble_images': pass", ["'tumble_images'"]),
        ("chosen = ('uncooperative',)", ["'uncooperative'"]),
        ("frame.image('image_850')", ["'image_850'"]),
        ("from models.frame import IMAGE_850, Frame", ["IMAGE_850"]),
        ("import models.frame as f\nf.image(f.CHASER_ORBIT)", ["CHASER_ORBIT"]),
        ("if world.scenario.tumble is None: pass", ["tumble"]),
        ("isinstance(world, TumbleWorld | int)", ["isinstance of TumbleWorld | int"]),
        ("from bench.scoring.pairs.parts import axes", ["import bench.scoring.pairs.parts"]),
        ("from pipelines import chaser_fixed", ["import pipelines"]),
        ("import bench.report.tumble.page", ["import bench.report.tumble.page"]),
        ("'''Of tumble_images.'''\nx = 'image'\nfrom pipelines import registry", []),
        ("def f():\n    'tumble_images'", []),
    ],
)
def test_the_rule_can_fail(text, found):
    assert list(asked(ast.parse(text))) == found
