"""Ways to spoil a dataset, and the messages on record that each must give."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Collection
from pathlib import Path

import cv2
import numpy as np

from bench import cli

HOUSE = Path(cli.__file__).parent.parent
UPDATE = "RVBENCH_UPDATE_SNAPSHOTS" in os.environ
Spoil = Callable[[Path], object]


def nothing(_: Path) -> None:
    """Spoil nothing: the arguments alone are wrong."""


def cut(path: Path) -> None:
    """Leave of a file what a full disk would."""
    path.write_bytes(path.read_bytes()[:500])


def cut_last_line(path: Path) -> None:
    """Take the last line away."""
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:-1]))


def replace(path: Path, old: str, new: str) -> None:
    """Replace text that must be there."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def shrink(path: Path) -> None:
    """Put an image of another size in a frame's place."""
    cv2.imwrite(str(path), np.zeros((64, 64), np.uint16))


def make_8_bit(path: Path) -> None:
    """Write an image anew with eight bits."""
    cv2.imwrite(str(path), (cv2.imread(str(path), cv2.IMREAD_UNCHANGED) >> 4).astype(np.uint8))


def scenario(text: str) -> Spoil:
    """Return what writes a scenario file of one's own, ``DIR/my.toml``."""
    return lambda folder: (folder / "my.toml").write_text('name = "mine"\n' + text)


def change_json(path: Path, *keys: str, to: object = None) -> None:
    """Take a value out of a JSON file, or put another in its place."""
    whole = json.loads(path.read_text())
    table = whole
    for key in keys[:-1]:
        table = table[key]
    if to is None:
        del table[keys[-1]]
    else:
        table[keys[-1]] = to
    path.write_text(json.dumps(whole))


def shift_times(path: Path, shift_s: float = 0.1) -> None:
    """Stamp estimates to other times."""
    head, *lines = path.read_text().splitlines()
    records = [json.loads(line) for line in lines]
    shifted = [json.dumps({**each, "time_s": each["time_s"] + shift_s}) for each in records]
    path.write_text("\n".join([head, *shifted]) + "\n")


def lasting(message: str, tmp_path: Path) -> str:
    """Take out of a message what differs from run to run: folders, process numbers, sizes."""
    message = message.replace(str(tmp_path), "TMP").replace(str(HOUSE), "HOUSE")
    return re.sub(r"\(\d+ bytes\)", "(N bytes)", re.sub(r"\.\d+\.part", ".N.part", message))


def compare_with_snapshot(path: Path, cases: Collection[str], case: str, message: str) -> None:
    """Hold a message against the one on record; see ``UPDATE``."""
    snapshots = json.loads(path.read_text()) if path.is_file() else {}
    if UPDATE:
        snapshots[case] = message
        kept = {key: snapshots[key] for key in cases if key in snapshots}
        path.write_text(json.dumps(kept, indent=1) + "\n")
    assert message == snapshots.get(case)
