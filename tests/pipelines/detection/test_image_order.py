"""Whether a pair's images are exchanged shows in what shines at one wavelength alone."""

from __future__ import annotations

import numpy as np

from pipelines.detection.image_difference import shines_swapped, swapped
from pipelines.detection.image_pair import image_pair
from tests.support.synthetic_pair import Scene, facing_pose, render_pair


def test_only_what_outshines_the_markers_makes_a_pair_seem_swapped() -> None:
    """Noise has steps both ways: it may look like a pose, but says nothing of the images' order."""
    pose = facing_pose(4.0)
    lit = image_pair(render_pair(Scene(clutter=3), pose))
    unlit = image_pair(render_pair(Scene(levels=np.zeros(10)), pose))
    assert shines_swapped(swapped(lit))
    assert not any(shines_swapped(each) for each in (lit, unlit, swapped(unlit)))
