"""The image of one marker's even disc, and its derivatives by everything that is fitted.

Eleven things shape it; the ellipse's form and tilt come from the pose, the other nine are the
parameters: where it is, its size, the lens's blur, the share of charge that neighbouring pixels
exchange, its height, the ramp of its brightness in x and y, and the background.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from models.arrays import Floats, Mask
from pipelines.detection.pixel_edge import PIXEL_VARIANCE, edge_signal

PARAMETERS = 9
BLUR_RANGE_PX = (0.03, 3.0)  # below, the pixel's own square hides it
CROSSTALK_RANGE = (-0.05, 0.2)
SIZE_RANGE = (0.6, 1.6)
SHARE_RANGE = (-0.5, 3.0)


@dataclass(frozen=True, eq=False)
class DiscParameters:
    """What is fitted, in the order of the design's rows.

    Attributes
    ----------
    centre_px : (2,) array, px
        Centre of area, from the predicted one.
    size : float
        Radius over the predicted one.
    blur_px : float, px
        1-sigma of the lens's blur.
    crosstalk : float
        Share of a pixel's charge that each neighbour along a row or column gets.
    height_dn : float, DN
        Of the disc at its centre.
    ramp_dn_px : (2,) array, DN/px
    background_dn : float, DN
    shares : (k,) array
        What else an appearance has; none for an even disc.
    """

    centre_px: Floats
    size: float
    blur_px: float
    crosstalk: float
    height_dn: float
    ramp_dn_px: Floats
    background_dn: float
    shares: Floats = field(default_factory=lambda: np.zeros(0))

    @property
    def linear(self) -> Floats:
        """(4,) array: height, ramps, background."""
        return np.array([self.height_dn, *self.ramp_dn_px, self.background_dn])

    def moved(self, step: Floats) -> DiscParameters:
        """Add a step, within what makes sense.

        Parameters
        ----------
        step : (9 + k,) array
            In this class's order and units.
        """
        return replace(
            self,
            centre_px=self.centre_px + step[:2],
            size=float(np.clip(self.size + step[2], *SIZE_RANGE)),
            blur_px=float(np.clip(self.blur_px + step[3], *BLUR_RANGE_PX)),
            crosstalk=float(np.clip(self.crosstalk + step[4], *CROSSTALK_RANGE)),
            height_dn=float(self.height_dn + step[5]),
            ramp_dn_px=self.ramp_dn_px + step[6:8],
            background_dn=float(self.background_dn + step[8]),
            shares=np.clip(self.shares + step[PARAMETERS:], *SHARE_RANGE),
        )


def exchanged(images: Floats, share: float) -> Floats:
    """Let neighbours exchange charge; a rim of one pixel is used up.

    Parameters
    ----------
    images : (..., height + 2, width + 2) array
    share : float
        Of a pixel's charge that each neighbour along a row or column gets.

    Returns
    -------
    (..., height, width) array
    """
    keep = 1.0 - 2.0 * share
    rows = keep * images[..., 1:-1] + share * (images[..., 2:] + images[..., :-2])
    return keep * rows[..., 1:-1, :] + share * (rows[..., 2:, :] + rows[..., :-2, :])


def exchange_slope(image: Floats, share: float) -> Floats:
    """Differentiate the exchange of an image, (height + 2, width + 2), by its share."""
    keep = 1.0 - 2.0 * share
    across = image[:, 2:] + image[:, :-2] - 2.0 * image[:, 1:-1]
    rows = keep * image[:, 1:-1] + share * (image[:, 2:] + image[:, :-2])
    in_x = keep * across[1:-1] + share * (across[2:] + across[:-2])
    return np.asarray(in_x + rows[2:] + rows[:-2] - 2.0 * rows[1:-1])


def disc_model(
    x: Floats, y: Floats, shape_inverse: Floats, radius: float, parameters: DiscParameters
) -> tuple[Floats, Floats]:
    """Evaluate the model and its design.

    Parameters
    ----------
    x, y : (1, width + 2) and (height + 2, 1) arrays, px
        Columns and rows of the window and one pixel round it, from the predicted centre.
    shape_inverse : (2, 2) array, px^-2
        ``S^-1`` of the predicted ellipse ``d^T S^-1 d = 1``.
    radius : float, px
        Radius of the circle of equal area.
    parameters : DiscParameters

    Returns
    -------
    model : (height, width) array, DN
    design : (9, height, width) array
        Derivatives by the parameters.
    """
    x, y = np.broadcast_arrays(x - parameters.centre_px[0], y - parameters.centre_px[1])
    gradient_x = shape_inverse[0, 0] * x + shape_inverse[0, 1] * y
    gradient_y = shape_inverse[1, 0] * x + shape_inverse[1, 1] * y
    ellipse = np.sqrt(gradient_x * x + gradient_y * y) + 1e-9  # 1 on the outline
    steepness = np.hypot(gradient_x, gradient_y) + 1e-12
    slope = steepness / ellipse
    normal_x, normal_y = gradient_x / steepness, gradient_y / steepness

    size, blur = parameters.size, parameters.blur_px
    edge = edge_signal((size - ellipse) / slope, normal_x, normal_y, size * radius, blur)
    by_x, by_y = -edge.by_depth * normal_x, -edge.by_depth * normal_y
    # A brightness ramp under a blur of variance v: G * (x f) = x (G * f) + v d/dx (G * f).
    variance = blur**2 + PIXEL_VARIANCE
    ramp_x, ramp_y = parameters.ramp_dn_px
    brightness = parameters.height_dn + ramp_x * x + ramp_y * y
    raw = np.stack(
        [
            -brightness * by_x - ramp_x * edge.value,
            -brightness * by_y - ramp_y * edge.value,
            brightness * edge.by_depth / slope,
            brightness * edge.by_blur,
            edge.value,
            x * edge.value + variance * by_x,
            y * edge.value + variance * by_y,
        ]
    )
    disc = np.tensordot(parameters.linear[:3], raw[4:], axes=1)
    design = np.empty((PARAMETERS, x.shape[0] - 2, x.shape[1] - 2))
    shared = exchanged(raw, parameters.crosstalk)
    design[:4] = shared[:4]
    design[4] = exchange_slope(disc, parameters.crosstalk)
    design[5:8] = shared[4:]
    design[8] = 1.0
    model = np.tensordot(parameters.linear, design[5:], axes=1)
    return model, design


@dataclass(frozen=True, eq=False)
class EvenDisc:
    """A disc of even brightness, but for the ramp: an appearance without shares of its own.

    Attributes
    ----------
    shape_inverse : (2, 2) array, px^-2
    radius : float, px
        As ``disc_model`` has them.
    """

    shape_inverse: Floats
    radius: float

    @property
    def is_its_own_image(self) -> bool:
        """It is, but a cut is what pulls a disc, and of that its misfit tells more."""
        return False

    @property
    def expected_shares(self) -> Floats:
        """(0,) array."""
        return np.zeros(0)

    @property
    def share_sigmas(self) -> Floats:
        """(0,) array."""
        return np.zeros(0)

    def covers(self, x: Floats, y: Floats) -> Mask:
        """Tell which places it is expected to cover.

        Parameters
        ----------
        x, y : (1, width) and (height, 1) arrays, px
            From the predicted centre.

        Returns
        -------
        (height, width) array of bool
        """
        form = self.shape_inverse
        return np.asarray(form[0, 0] * x**2 + 2.0 * form[0, 1] * x * y + form[1, 1] * y**2 < 1.0)

    def model(self, x: Floats, y: Floats, parameters: DiscParameters) -> tuple[Floats, Floats]:
        """Return ``disc_model``.

        Parameters
        ----------
        x, y : (1, width + 2) and (height + 2, 1) arrays, px
            Columns and rows of the window and one pixel round it, from the predicted centre.
        parameters : DiscParameters

        Returns
        -------
        model : (height, width) array, DN
        design : (9 + k, height, width) array
        """
        return disc_model(x, y, self.shape_inverse, self.radius, parameters)
