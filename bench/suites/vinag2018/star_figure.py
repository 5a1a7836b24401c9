"""A frame of the star camera with what was made of it: stars by circles, all else by crosses."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from bench.report.plot import drawn_svg
from bench.suites.vinag2018.star_plan import PIXELS
from bench.suites.vinag2018.star_survey import SKIES, SURVEY, drawn_view
from models.sensors.star_camera import star_camera
from pipelines.star_attitude.star_sensor import StarSensor
from renders.star_images.star_frame import star_frame

SHOWN_SKY = "20 false stars and the Moon"
SOFT_E, WHITE_E = 60.0, 40_000.0
STAR, FALSE = "#6fd08c", "#ff8f5a"


def star_figure(seed: int, number: int = 0) -> str:
    """Draw a frame of the hard sky, the stars that were identified circled.

    Parameters
    ----------
    seed, number : int
        Of the attitude.
    """
    sensor = star_camera(PIXELS)
    view = drawn_view(SKIES[SHOWN_SKY], sensor, seed, number)
    image = star_frame(view, sensor, (seed, number, SURVEY))
    fix = StarSensor(sensor).find(image, view.rate_in_cam_rad_s, view.velocity_m_s)
    charge = (image - sensor.detector.bias_dn) * sensor.detector.gain_e_dn
    grey = np.arcsinh(np.maximum(charge, 0.0) / SOFT_E) / np.arcsinh(WHITE_E / SOFT_E)
    own = np.zeros(len(fix.spots), dtype=np.bool_)
    own[fix.identified[:, 0]] = True

    def draw(figure: Figure) -> None:
        panel = figure.subplots()
        panel.imshow(grey, cmap="gray", vmin=0.0, vmax=1.0, interpolation="nearest")
        for which, marker, colour, what in (
            (own, "o", STAR, "identified"),
            (~own, "x", FALSE, "a spot that is no star of the catalogue"),
        ):
            u, v = fix.spots.pixels[which].T
            face = "none" if marker == "o" else colour
            panel.scatter(u, v, s=60 if marker == "o" else 26, marker=marker, linewidths=0.9,
                          facecolors=face, edgecolors=colour if marker == "o" else None,
                          label=what)  # fmt: skip
        for row, hip in fix.identified[:12]:
            u, v = fix.spots.pixels[row]
            inwards = -1 if u > 0.5 * PIXELS else 1
            panel.annotate(f"HIP {hip}", (u, v), (5 * inwards, 5), textcoords="offset points",
                           ha="left" if inwards > 0 else "right", color=STAR,
                           fontsize=6.5)  # fmt: skip
        panel.set_axis_off()
        panel.set_title(fix.reason or f"{len(fix.identified)} stars identified")
        figure.legend(loc="outside lower center", ncols=2)

    return drawn_svg(draw, (8.2, 8.6))
