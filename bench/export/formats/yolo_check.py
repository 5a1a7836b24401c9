"""A YOLO-pose export reopened: a label for each image, every number within it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bench.export.formats.format import Findings
from bench.export.formats.reading_back import image_of
from models.reading.regular_file import read_text


def check_yolo(folder: Path) -> Findings:
    """Reopen every image and its labels."""
    found = Findings()
    shape = next(
        (
            line.partition("[")[2].partition(",")[0]
            for line in read_text(folder / "data.yaml").splitlines()
            if line.startswith("kpt_shape:")
        ),
        "0",
    )
    points = int(shape)
    for path in sorted(
        p for s in ("train", "val", "test") for p in (folder / "images" / s).glob("*")
    ):
        found.images += 1
        name = str(path.relative_to(folder))
        image_of(folder, name)
        labels = folder / "labels" / path.parent.name / f"{path.stem}.txt"
        for line in read_text(labels).splitlines():
            found.objects += 1
            numbers = np.array(line.split(), dtype=np.float64)
            if len(numbers) != 5 + 3 * points:
                found.faults.append(f"{labels}: expected {5 + 3 * points} numbers a line")
                continue
            box, keypoints = numbers[1:5], numbers[5:].reshape(-1, 3)
            told = keypoints[keypoints[:, 2] > 0]
            found.keypoints += len(told)
            inside = (told[:, :2] >= 0.0).all() and (told[:, :2] <= 1.0).all()
            if (
                not inside
                or (box[:2] - box[2:] / 2 < -1e-6).any()
                or (box[:2] + box[2:] / 2 > 1 + 1e-6).any()
            ):
                found.faults.append(f"{labels}: expected everything within the image")
    return found
