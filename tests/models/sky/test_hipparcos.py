"""The star sensor's stars stand where another catalogue has them, and are all there."""

import numpy as np
import pytest

from models.sky.hipparcos import COMPLETE_TO_MAG, TABLE, hipparcos_stars
from models.sky.star_catalogue import bright_stars

PLACE_ARCSEC = 30.0  # ten years of proper motion between the tables, and pairs told as one
BAND_MAG = 0.6  # Hp less V, of all but the reddest
LARGEST_KB = 300


def test_stars_stand_where_the_almanac_has_them():
    """99 in 100: the rest are halves of pairs, or pairs that the other table took for one."""
    ours, theirs = hipparcos_stars(), bright_stars()
    clear = theirs.visual_mag < 4.4
    cosines = theirs.directions_in_icrs[clear] @ ours.directions_in_icrs.T
    nearest = cosines.argmax(axis=1)
    apart = np.linalg.norm(
        theirs.directions_in_icrs[clear] - ours.directions_in_icrs[nearest], axis=1
    )
    near = np.rad2deg(apart) * 3600.0 < PLACE_ARCSEC
    off = ours.magnitude[nearest] - theirs.visual_mag[clear]
    assert np.mean(near) > 0.985
    assert np.median(np.rad2deg(apart)) * 3600.0 < 2.0
    assert np.mean(np.abs(off[near]) < BAND_MAG) > 0.95


def test_all_are_there_and_sorted():
    """The count grows with depth as the sky's does: by 1.7 to 1.9 a half-magnitude."""
    stars = hipparcos_stars()
    assert len(set(stars.numbers.tolist())) == len(stars.numbers) == 8798
    assert (np.diff(stars.magnitude) >= 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(stars.directions_in_icrs, axis=1), 1.0)
    counts = [np.count_nonzero(stars.magnitude <= each) for each in (5.0, 5.5, 6.0, 6.5)]
    assert COMPLETE_TO_MAG == 6.5
    ratios = np.array(counts[1:]) / np.array(counts[:-1])
    assert ratios.min() > 1.65
    assert ratios.max() < 1.95


def test_fainter_ones_are_neighbours():
    stars = hipparcos_stars()
    bright = stars.magnitude <= COMPLETE_TO_MAG
    cosines = stars.directions_in_icrs[~bright] @ stars.directions_in_icrs[bright].T
    assert np.rad2deg(np.arccos(np.clip(cosines.max(axis=1), -1.0, 1.0))).max() < 0.121


def test_the_table_says_where_it_comes_from_and_is_small():
    assert "van Leeuwen 2007" in TABLE.read_text().split("\nhip,")[0]
    assert TABLE.stat().st_size < LARGEST_KB * 1000


@pytest.mark.parametrize(
    ("number", "place"),
    [(11767, (37.95, 89.264)), (24436, (78.634, -8.202)), (62434, (191.930, -59.689))],
)
def test_known_stars(number, place):
    """Polaris, Rigel and Mimosa, by their places in any atlas."""
    stars = hipparcos_stars()
    x, y, z = stars.directions_in_icrs[stars.numbers.tolist().index(number)]
    assert np.rad2deg(np.arcsin(z)) == pytest.approx(place[1], abs=2e-3)
    alpha = np.rad2deg(np.arctan2(y, x)) % 360.0
    assert alpha == pytest.approx(place[0], abs=0.1 if number == 11767 else 2e-3)
