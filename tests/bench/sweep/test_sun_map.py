"""The Sun map shows every direction once, in its place, framed by what came of it."""

import dataclasses
from collections import Counter

import cv2
import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.patches import Rectangle

from bench.sweep.sun_labels import label_offsets
from bench.sweep.sun_map import (
    FRAME_COLOURS,
    NAME_PT,
    SPHERE_DEG2,
    ground,
    on_sphere,
    sun_map,
    sun_map_figure,
    tiles,
)
from bench.sweep.table import VERDICTS, setting_of
from models.lights.sun import SUN_CASES_DEG
from models.lights.sun_grid import chosen_suns, sun_grid
from tests.bench.sweep.test_table import SETTING, TRUTH, judged
from tests.support.synthetic_dataset import lost_estimate, perfect_estimate


def rows_of(suns, lost=()):
    estimates = (lost_estimate(TRUTH) if n in lost else perfect_estimate(TRUTH) for n in range(999))
    return [
        dataclasses.replace(
            judged(estimate, "S2"),
            sun=sun.name,
            azimuth_deg=sun.azimuth_deg,
            elevation_deg=sun.elevation_deg,
            found=0 if number % 5 == 1 else 9,
            verdict="no pose" if number in lost else VERDICTS[number % 5 == 1],
        )
        for number, (sun, estimate) in enumerate(zip(suns, estimates, strict=False))
    ]


def thumbnails_of(rows):
    return [np.full((8, 8), 10 + number, np.uint8) for number in range(len(rows))]


@pytest.mark.parametrize("suns", [sun_grid(45.0), sun_grid(30.0), chosen_suns(("paper",))])
def test_each_direction_has_one_frame_of_its_colour(suns):
    rows = rows_of(suns, lost=(2, 3))
    figure = sun_map_figure("title", SETTING, rows, thumbnails_of(rows))
    panel = figure.axes[0]
    shown = [int(image.get_array()[0, 0]) for image in panel.images]
    assert shown == [10 + number for number in range(len(suns))]
    framed = Counter(
        mpl.colors.to_hex(patch.get_edgecolor())
        for patch in panel.patches
        if isinstance(patch, Rectangle)
    )
    wanted = Counter(FRAME_COLOURS[row.verdict] for row in rows)
    assert framed == wanted
    assert len(wanted) == 3


def test_frames_stand_where_their_suns_stand_and_do_not_overlap():
    suns = sun_grid(15.0)
    rows = rows_of(suns)
    laid = tiles(rows, thumbnails_of(rows))
    assert laid is not None
    for tile, sun in zip(laid, suns, strict=True):
        assert (tile.x_deg, tile.y_deg) == on_sphere(sun.azimuth_deg, sun.elevation_deg)
        assert tile.y_deg == pytest.approx(sun.elevation_deg)
    places = np.array([(tile.x_deg, tile.y_deg) for tile in laid])
    apart = np.abs(places[:, None] - places[None, :]).max(axis=2)
    np.fill_diagonal(apart, np.inf)
    assert apart.min() >= laid[0].size_deg
    assert len(laid) * laid[0].size_deg ** 2 > 0.6 * SPHERE_DEG2  # and they fill it


@pytest.mark.parametrize("step_deg", [15.0, 30.0, 45.0, 90.0])
def test_no_frame_leaves_the_map(step_deg):
    """Neither the ground it lies on nor the panel: nor on the small maps below."""
    rows = rows_of(sun_grid(step_deg))
    laid = tiles(rows, thumbnails_of(rows))
    assert laid is not None
    half = 0.5 * laid[0].size_deg
    heights, reach = ground(half)
    for tile in laid:
        across = np.interp([tile.y_deg - half, tile.y_deg + half], heights, reach)
        slack = 1.0  # deg: the ground is drawn in steps of half a deg
        assert abs(tile.x_deg) + half <= across.min() + slack
        assert abs(tile.y_deg) + half <= heights[-1] + 1e-9
    figure = sun_map_figure("title", SETTING, rows, thumbnails_of(rows))
    for panel in figure.axes[:4]:
        (left, right), (low, high) = panel.get_xlim(), panel.get_ylim()
        for patch in (p for p in panel.patches if isinstance(p, Rectangle)):
            assert left <= patch.get_x()
            assert patch.get_x() + patch.get_width() <= right
            assert low <= patch.get_y()
            assert patch.get_y() + patch.get_height() <= high


@pytest.mark.parametrize("per_deg", [1.2, 1.4, 3.0])
def test_no_name_of_a_sun_lies_on_another(per_deg):
    """S6 and S7 stand 5 deg apart, half the height of a name on the small maps."""
    marks = per_deg * np.array([on_sphere(*place) for place in SUN_CASES_DEG.values()])
    names = marks + np.array(label_offsets(marks, NAME_PT))
    apart = np.abs(names[:, None] - names[None, :])
    touching = (apart < NAME_PT).all(axis=2)
    assert touching.sum() == len(names)  # each itself
    assert not (np.abs(names[:, None] - marks[None, :]) < 0.5 * np.array(NAME_PT)).all(axis=2).any()


def test_the_map_keeps_areas():
    """A patch of the sphere has the same area wherever it lies: cos(el) d(az) d(el)."""
    rng = np.random.default_rng(2)
    for azimuth, elevation in rng.uniform((-170.0, -80.0), (170.0, 80.0), (50, 2)):
        step = 1e-3
        here, right, above = (
            np.array(on_sphere(azimuth + da, elevation + de))
            for da, de in ((0.0, 0.0), (step, 0.0), (0.0, step))
        )
        (ax, ay), (bx, by) = right - here, above - here
        expected = np.cos(np.deg2rad(elevation)) * step**2
        assert abs(ax * by - ay * bx) == pytest.approx(expected, rel=1e-6)


def test_suns_near_to_each_other_are_laid_out_in_rows():
    rows = rows_of(chosen_suns(("paper",)))
    assert tiles(rows, thumbnails_of(rows)) is None
    one = rows[:1]
    figure = sun_map_figure("title", setting_of(one[0]), one, thumbnails_of(one))
    assert len(figure.axes[0].images) == 1


def test_the_picture_is_a_png_that_shows_the_frames():
    rows = rows_of(sun_grid(90.0), lost=(0,))
    white = [np.full((4, 4), 255, np.uint8) for _ in rows]
    data = sun_map("title", SETTING, rows, white).png
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    red = np.array([int(FRAME_COLOURS["no pose"][k : k + 2], 16) for k in (5, 3, 1)])
    assert (np.abs(image.astype(int) - red).max(axis=2) < 3).sum() > 500


def test_boxes_lie_on_their_frames():
    rows = rows_of(sun_grid(90.0))
    greys = [np.full((4, 4), 40 + 20 * number, np.uint8) for number in range(len(rows))]
    drawn = sun_map("title", SETTING, rows, greys)
    image = cv2.imdecode(np.frombuffer(drawn.png, np.uint8), cv2.IMREAD_GRAYSCALE)
    high, wide = image.shape
    for grey, (left, top, width, height) in zip(greys, drawn.boxes, strict=True):
        for across in (0.2, 0.8):  # beside the words in the frame's corners
            u = round(0.01 * (left + across * width) * wide)
            v = round(0.01 * (top + 0.5 * height) * high)
            assert abs(int(image[v, u]) - int(grey[0, 0])) <= 2
