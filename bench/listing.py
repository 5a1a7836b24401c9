"""What there is to choose from: cases, cameras, targets, Suns, suites, one line each."""

from __future__ import annotations

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from bench.suites.catalogue import TITLES
from models.camera import CAMERAS, Camera
from models.lights.sun import (
    EYE_IN_HAND_SUNS_DEG,
    SUN_CASES_DEG,
    direction_from_azimuth,
    sun_direction,
)
from models.spacecraft.catalogue import TARGETS
from renders.scenario.case_files import case_description, case_names


def print_listing(console: Console) -> None:
    """Print the lists as tables."""
    for title, rows in (
        ("cases", cases()),
        ("cameras", cameras()),
        ("targets", targets()),
        ("Suns", suns()),
        ("suites", suites()),
    ):
        table = Table(title=title, box=box.SIMPLE, show_header=False, title_justify="left")
        table.add_column(style="bold", no_wrap=True)
        table.add_column()
        for name, line in rows:
            table.add_row(name, line)
        console.print(table)


def cases() -> list[tuple[str, str]]:
    """Return the cases and what they are."""
    return [(name, case_description(name)) for name in case_names()]


def cameras() -> list[tuple[str, str]]:
    """Return the camera presets and their optics."""
    return [(name, _camera_line(camera)) for name, camera in CAMERAS.items()]


def targets() -> list[tuple[str, str]]:
    """Return the targets: those that carry markers, and those known by their wireframe."""
    return list(TARGETS.items())


def suns() -> list[tuple[str, str]]:
    """Return the named Suns: where they stand, and the vector that says the same."""
    rows = []
    for name, (azimuth_deg, elevation_deg) in SUN_CASES_DEG.items():
        x, y, z = np.round(direction_from_azimuth(azimuth_deg, elevation_deg), 3) + 0.0
        rows.append(
            (name, f"azimuth {azimuth_deg:g} deg, elevation {elevation_deg:g} deg: "
                   f"towards {x:.3f},{y:.3f},{z:.3f} in the target frame")
        )  # fmt: skip
    for name in EYE_IN_HAND_SUNS_DEG:
        x, y, z = np.round(sun_direction(name), 3) + 0.0
        rows.append((name, f"towards {x:.3f},{y:.3f},{z:.3f} in the target frame"))
    return rows


def _camera_line(camera: Camera) -> str:
    fov_deg = np.rad2deg(2.0 * np.arctan(0.5 * camera.width / camera.fx))
    return (
        f"{camera.width} x {camera.height} px, field of view {fov_deg:.0f} deg, "
        f"focal length {camera.fx:.2f} px"
    )


def suites() -> list[tuple[str, str]]:
    """Return the suites and what they repeat."""
    return list(TITLES.items())
