"""What there is to choose from: cases, cameras, targets, Suns, one line each."""

from __future__ import annotations

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from bench.suites.catalogue import TITLES
from models.camera import CAMERAS, Camera
from models.lights.sun import SUN_CASES_DEG, direction_from_azimuth
from models.spacecraft.catalogue import SPACECRAFT, spacecraft_by_name
from models.spacecraft.wireframes import WIREFRAMES, wireframe_by_name
from renders.scenario.scenario import case_names, case_path, read_scenario


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
    described = ((name, read_scenario(case_path(name)).description) for name in case_names())
    return [(name, " ".join(text.split())) for name, text in described]


def cameras() -> list[tuple[str, str]]:
    """Return the camera presets and their optics."""
    return [(name, _camera_line(camera)) for name, camera in CAMERAS.items()]


def targets() -> list[tuple[str, str]]:
    """Return the targets: those that carry markers, and those known by their wireframe."""
    rows = []
    for name in SPACECRAFT:
        craft = spacecraft_by_name(name)
        parts = f"{len(craft.part_names)} named parts"
        if craft.markers is not None:
            radius_mm = 1e3 * craft.markers.radius_m
            rows.append(
                (name, f"{len(craft.markers)} markers of radius {radius_mm:.1f} mm, {parts}")
            )
        elif name in WIREFRAMES:
            wireframe = wireframe_by_name(name)
            shape = f"{len(wireframe)} landmarks, {len(wireframe.edges)} edges"
            rows.append((name, f"no markers; a wireframe of {shape}, {parts}"))
    return rows


def suns() -> list[tuple[str, str]]:
    """Return the named Suns: where they stand, and the vector that says the same."""
    rows = []
    for name, (azimuth_deg, elevation_deg) in SUN_CASES_DEG.items():
        x, y, z = np.round(direction_from_azimuth(azimuth_deg, elevation_deg), 3) + 0.0
        rows.append(
            (name, f"azimuth {azimuth_deg:g} deg, elevation {elevation_deg:g} deg: "
                   f"towards {x:.3f},{y:.3f},{z:.3f} in the target frame")
        )  # fmt: skip
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
