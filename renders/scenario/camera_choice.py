"""Which camera a scenario flies: a preset, or one of its own, and at how many columns.

A preset is resized to ``camera.width``, and what is typed of its chip and lens in pixels is meant
for its own 2048 columns. A camera of one's own is as typed, and so are its pixels; only
``rendered_width`` (``--width``) makes them larger, for a first look.
"""

from __future__ import annotations

from dataclasses import replace

from models.camera import Camera, camera_preset
from models.errors import ScenarioError
from renders.scenario.camera_tables import OWN, CameraTable

COEFFICIENTS = ("k1", "k2", "p1", "p2", "k3")
INTRINSICS = ("fx", "fy", "cx", "cy")


def camera_of(table: CameraTable) -> Camera:
    """Return the camera that renders."""
    coefficients = {name: getattr(table, name) for name in COEFFICIENTS}
    if table.preset is not None:
        return replace(camera_preset(table.preset).resized(table.width), **coefficients)
    assert table.height is not None
    if table.fov_deg is not None:
        camera = Camera.from_fov(table.width, table.height, table.fov_deg)
    else:
        assert table.fx is not None
        camera = Camera(
            table.width,
            table.height,
            fx=table.fx,
            fy=table.fx if table.fy is None else table.fy,
            cx=0.5 * (table.width - 1) if table.cx is None else table.cx,
            cy=0.5 * (table.height - 1) if table.cy is None else table.cy,
        )
    camera = replace(camera, **coefficients)
    return camera if table.rendered_width is None else camera.resized(table.rendered_width)


def pixel_scale(table: CameraTable) -> float:
    """Return columns rendered over those that pixels are typed for; see ``Scenario``."""
    if table.preset is not None:
        return table.width / camera_preset(table.preset).width
    return 1.0 if table.rendered_width is None else table.rendered_width / table.width


def check_camera(table: CameraTable, where: str) -> None:
    """Refuse a camera that is told twice, or not whole.

    Raises
    ------
    ScenarioError
        The message names the keys.
    """
    if table.file is not None:
        raise ScenarioError(
            f"{where}: expected camera.file of a scenario that is read from a file, beside which "
            f"it lies, got {table.file!r}"
        )
    typed = [key for key in OWN if getattr(table, key) is not None]
    if table.preset is not None:
        camera_preset(table.preset)
        if typed:
            raise ScenarioError(
                f"{where}: expected camera.preset or a camera of your own, got preset = "
                f"{table.preset!r} and {', '.join(typed)}; leave one of them out"
            )
        return
    absent = [key for key in ("width", "height") if key not in table.model_fields_set]
    if absent or table.height is None:
        raise ScenarioError(
            f"{where}: expected camera.width and camera.height of a camera of your own, got "
            f"{', '.join(typed)} without {' and '.join(absent or ['height'])}"
        )
    intrinsics = [key for key in INTRINSICS if getattr(table, key) is not None]
    if table.fov_deg is not None and intrinsics:
        raise ScenarioError(
            f"{where}: expected camera.fov_deg, or fx with fy, cx and cy, got fov_deg and "
            f"{', '.join(intrinsics)}: they say the same twice; leave one of them out"
        )
    if table.fov_deg is None and table.fx is None:
        raise ScenarioError(
            f"{where}: expected camera.fx in px, or camera.fov_deg, of a camera of your own, got "
            f"{', '.join(typed)} alone"
        )
