"""The image of a corner cube's face, and its derivatives by everything that is fitted.

A template (``detection.cube_template``) is seen through the lens, a Gaussian, and the pixel's
square, which are separable: two matrices carry it from its grid to the window, and their own
derivatives are those of the image by its place, its size and the blur. Beside the parameters of a
disc it has two shares: of light that the face sends back evenly, and of the darkness that the
edges should have.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from models.arrays import Floats, Mask
from pipelines.detection.cube_template import CubeTemplate
from pipelines.detection.disc_model import (
    PARAMETERS,
    DiscParameters,
    exchange_slope,
    exchanged,
)

EVEN_SIGMA = 1.0  # of the share that comes back evenly: nobody knows
EDGE_SIGMA = 0.5  # of the edges' darkness, over what their width says


@dataclass(frozen=True, eq=False)
class _Spread:
    """What carries a row or column of the grid to the window's pixels, and its derivatives."""

    value: Floats
    by_centre: Floats
    by_size: Floats
    by_blur: Floats


def _spread(pixels: Floats, grid: Floats, step: float, size: float, blur: float) -> _Spread:
    """Integrate a Gaussian over the squares of pixels and of the grid.

    Two boxes exchange the second difference of ``b g(u / b)`` over their edges' distances u, with
    ``g(z) = z Phi(z) + phi(z)`` under a blur of b. Pixels stand one apart, cells a step: an edge is
    two neighbours' own, and each pair of edges is looked at once.
    """
    pixel_edges = np.append(pixels, pixels[-1] + 1.0) - 0.5
    cell_edges = size * (np.append(grid, grid[-1] + step) - 0.5 * step)
    scaled = (pixel_edges[:, None] - cell_edges[None, :]) / blur
    density = np.exp(-0.5 * scaled * scaled) / np.sqrt(2.0 * np.pi)
    share = ndtr(scaled)
    within = share[1:] - share[:-1]  # of the blur, by pixel and edge of a cell
    by_away = within[:, :-1] - within[:, 1:]
    by_width = 0.5 * (within[:, :-1] + within[:, 1:])
    return _Spread(
        value=blur * _exchanged(scaled * share + density),
        by_centre=-by_away,
        by_size=step * by_width - grid * by_away,
        by_blur=_exchanged(density),
    )


def _exchanged(at_edges: Floats) -> Floats:
    by_pixel = at_edges[1:] - at_edges[:-1]
    return by_pixel[:, :-1] - by_pixel[:, 1:]


def _pictures(template: CubeTemplate, parameters: DiscParameters) -> Floats:
    """Return what is seen through lens and pixels, (6, m, n), over the grid.

    The face as it shines; by its height and by both ramps; by both shares.
    """
    even, darkness = parameters.shares
    ramp_x, ramp_y = parameters.ramp_dn_px
    brightness = parameters.height_dn + ramp_x * template.x + (ramp_y * template.y)[:, None]
    pictures: Floats = np.empty((6, *template.face.shape))
    whole, profile, leaning_x, leaning_y, by_even, by_darkness = pictures
    lit = template.aperture - darkness * template.edges
    np.subtract(template.even, lit, out=by_even)
    np.multiply(even, by_even, out=profile)
    profile += lit
    np.multiply(brightness, profile, out=whole)
    np.multiply(profile, template.x, out=leaning_x)
    np.multiply(profile, template.y[:, None], out=leaning_y)
    by_even *= brightness
    np.multiply(brightness, template.edges, out=by_darkness)
    by_darkness *= even - 1.0
    return pictures


@dataclass(frozen=True, eq=False)
class CubeFace:
    """A cube's face as an appearance.

    Attributes
    ----------
    template : CubeTemplate
    shape_inverse : (2, 2) array, px^-2
        Of the face's outline ``d^T S^-1 d = 1``.
    radius : float, px
        Of the circle of the outline's area.
    """

    template: CubeTemplate
    shape_inverse: Floats
    radius: float

    @property
    def is_its_own_image(self) -> bool:
        """It is, through its centre."""
        return True

    @property
    def expected_shares(self) -> Floats:
        """(2,) array: nothing comes back evenly, the edges are as dark as they should be."""
        return np.array([0.0, 1.0])

    @property
    def share_sigmas(self) -> Floats:
        """(2,) array."""
        return np.array([EVEN_SIGMA, EDGE_SIGMA])

    def covers(self, x: Floats, y: Floats) -> Mask:
        """Tell which places lie where the aperture is sure to be open.

        Parameters
        ----------
        x, y : (1, width) and (height, 1) arrays, px
            From the predicted centre.

        Returns
        -------
        (height, width) array of bool
        """
        form = self.shape_inverse
        ellipse = form[0, 0] * x**2 + 2.0 * form[0, 1] * x * y + form[1, 1] * y**2
        return np.asarray(ellipse < max(self.template.aperture_share, 0.05) ** 2)

    def model(self, x: Floats, y: Floats, parameters: DiscParameters) -> tuple[Floats, Floats]:
        """Evaluate the model and its design.

        Parameters
        ----------
        x, y : (1, width + 2) and (height + 2, 1) arrays, px
            Columns and rows of the window and one pixel round it, from the projected centre.
        parameters : DiscParameters
            With two shares: even, and of the edges' darkness.

        Returns
        -------
        model : (height, width) array, DN
        design : (11, height, width) array
            Derivatives by the parameters.
        """
        template, size, blur = self.template, parameters.size, parameters.blur_px
        step = template.step_px
        across = _spread(x[0] - parameters.centre_px[0], template.x, step, size, blur)
        down = _spread(y[:, 0] - parameters.centre_px[1], template.y, step, size, blur)
        pictures = _pictures(template, parameters)
        whole = pictures[0]
        rows = len(whole)
        sideways = (pictures.reshape(-1, pictures.shape[2]) @ across.value.T).reshape(
            len(pictures), rows, -1
        )
        slopes = np.concatenate([across.by_centre, across.by_size, across.by_blur])
        leaning = (whole @ slopes.T).reshape(rows, 3, -1).transpose(1, 0, 2)
        seen = down.value @ np.concatenate([leaning, sideways[1:]])
        turned = np.concatenate([down.by_centre, down.by_size, down.by_blur]) @ sideways[0]
        turned = turned.reshape(3, len(down.value), -1)
        raw = np.stack([seen[0], turned[0], seen[1] + turned[1], seen[2] + turned[2], *seen[3:]])
        image = np.tensordot(parameters.linear[:3], raw[4:7], axes=1)
        shared = exchanged(raw, parameters.crosstalk)
        design = np.empty((PARAMETERS + 2, *shared.shape[1:]))
        design[:4] = shared[:4]
        design[4] = exchange_slope(image, parameters.crosstalk)
        design[5:8] = shared[4:7]
        design[8] = 1.0
        design[PARAMETERS:] = shared[7:]
        model = np.tensordot(parameters.linear, design[5:9], axes=1)
        return model, design
