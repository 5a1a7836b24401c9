"""A cell's light is taken from far around where few paths landed, and not across its edges."""

import numpy as np

from renders.tracing.bounced.field import ENOUGH, fitting_nodes
from renders.tracing.bounced.surface_cells import SLOTS, Nodes

POINTS = 40  # of each cell: well measured


def one_brick() -> Nodes:
    """Return nodes over a brick all of whose voxels hold surface that faces +z."""
    cell = np.repeat(np.arange(SLOTS), POINTS)
    return Nodes.build(np.arange(SLOTS), cell, np.tile([0.0, 0.0, 1.0], (len(cell), 1)))


def landed(per_cell: np.ndarray) -> np.ndarray:
    return np.repeat(np.arange(SLOTS), per_cell)


def test_dense_light_is_kept_in_the_finest_cells() -> None:
    level, begin, end = fitting_nodes(landed(np.full(SLOTS, 2 * ENOUGH)), one_brick())
    assert (level == 0).all()
    assert (end - begin == 2 * ENOUGH).all()
    assert (begin == 2 * ENOUGH * np.arange(SLOTS)).all()


def test_thin_light_is_gathered_from_around() -> None:
    paths = np.random.default_rng(3).poisson(6.0, SLOTS)
    level, begin, end = fitting_nodes(landed(paths), one_brick())
    assert np.mean(level >= 2) > 0.9
    assert np.median(end - begin) > ENOUGH


def test_a_dark_half_stays_dark() -> None:
    paths = np.where(np.arange(SLOTS) < SLOTS // 2, 0, 60)
    level, begin, end = fitting_nodes(landed(paths), one_brick())
    assert (end - begin)[: SLOTS // 2].max() == 0
    assert (end - begin)[SLOTS // 2 :].min() >= ENOUGH
    assert level.max() < 3


def test_no_path_at_all_is_no_light() -> None:
    _, begin, end = fitting_nodes(np.empty(0, dtype=np.int64), one_brick())
    assert (begin == end).all()


def test_nodes_know_their_area_and_the_way_they_face() -> None:
    from renders.tracing.bounced.surface_cells import POINTS_PER_M2

    nodes = one_brick()
    assert len(nodes.begin) == 5
    assert np.diff(nodes.begin).tolist() == [512, 64, 8, 1]
    assert nodes.areas_m2[-1] == np.float32(SLOTS * POINTS / POINTS_PER_M2)
    assert np.allclose(nodes.normals, [0.0, 0.0, 1.0])
    assert np.allclose(nodes.reliefs, 0.0)
