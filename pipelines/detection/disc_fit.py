"""A marker's centre by weighted least squares of what it should look like, with its covariance.

The outline is known from the pose; the rest of its appearance, an even disc
(``detection.disc_model``) or a corner cube (``detection.cube_model``), is fitted to the signed
difference of the pair, every pixel weighted by the detector's own noise. Against a weighted
centroid (equation 6) this is not pulled by lamp fall-off across the disc, nor by the threshold;
pixels that saturate are simply left out, and what the fit cannot explain (a cut, a shadow's edge)
shows in the misfit of its shape and widens the covariance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from models.arrays import AnyArray, Floats, Mask
from models.sensors.camera_chip import Detector
from pipelines.detection.disc_model import PARAMETERS, DiscParameters, EvenDisc
from pipelines.detection.disc_window import DiscWindow, cut_window

ITERATIONS = 12
CONVERGED_PX = 1e-4
WORSE = 1.0 + 1e-6  # growth of the cost that is not rounding
LONGEST_STEP_PX = 1.0
SIZE_TOLERANCE = 0.05  # 1-sigma of the predicted radius, relative
CROSSTALK_TOLERANCE = 0.1  # 1-sigma of the share that neighbours exchange
RAMP_TOLERANCE = 0.03  # 1-sigma of the brightness's change over one radius, relative
OBSERVED = np.array([2, 3, 4, 6, 7])  # the parameters that these four are about; shares follow
SIGNIFICANT = 4.0  # sigmas of chi-square above which a misfit is one of shape
# How far a cut that leaves a misfit of 1 pulls the centre (measured by cutting discs from a side).
PULL_PX, PULL_PX3 = 2.8, 18.0
# 1-sigma of the centre from taking the edge within a pixel as straight, where no blur softens it.
BENT_EDGE_PX3, SOFT_EDGE_PX = 0.02, 0.35
MODEL_MISFIT = 0.002  # what the model itself leaves at worst, scattered over the pixels
MIN_PIXELS = 2 * PARAMETERS
SECTORS = 8  # of the window, each with its opposite, by which a cube's misfits are judged
# A fit hides most of a cut: the variance is up to so many times what sectors tell (measured by
# cutting cubes from a side), the more the further they are beyond noise.
HIDDEN, SHOWN_EXCESS = 9.0, 20.0


class Appearance(Protocol):
    """What a marker looks like: nine parameters of any, and shares of its own."""

    @property
    def radius(self) -> float:
        """Of the circle of its outline's area, px."""

    @property
    def is_its_own_image(self) -> bool:
        """Whether misfits are judged by opposite sectors, which then tell more than their size."""

    @property
    def expected_shares(self) -> Floats:
        """(k,) array, before the fit."""

    @property
    def share_sigmas(self) -> Floats:
        """(k,) array, 1-sigma of them."""

    def covers(self, x: Floats, y: Floats) -> Mask:
        """Tell which places are bright.

        Parameters
        ----------
        x, y : (1, width) and (height, 1) arrays, px
            From the predicted centre.

        Returns
        -------
        (height, width) array of bool
        """

    def model(self, x: Floats, y: Floats, parameters: DiscParameters) -> tuple[Floats, Floats]:
        """Return the image, and its derivatives by the 9 + k parameters.

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


@dataclass(frozen=True)
class ExpectedBlur:
    """What is known of the lens and chip before the fit.

    Attributes
    ----------
    psf_sigma_px, tolerance_px : float, px
        Blur of the lens and its 1-sigma.
    start_px, start_crosstalk : float
        Where the fit begins: what it found last, which saves steps and changes nothing else.
    """

    psf_sigma_px: float
    tolerance_px: float
    start_px: float
    start_crosstalk: float = 0.0


@dataclass(frozen=True, eq=False)
class DiscFit:
    """What the fit says.

    Attributes
    ----------
    parameters : DiscParameters
    covariance_px2 : (2, 2) array, px^2
        Of the centre, from the detector's noise, widened by the misfit.
    height_sigma_dn : float, DN
    shape_misfit : float
        Root mean square of what neither disc nor noise explains, over the height.
    misfit_chi2 : float
        Reduced chi-square of all that the fit leaves.
    """

    parameters: DiscParameters
    covariance_px2: Floats
    height_sigma_dn: float
    shape_misfit: float
    misfit_chi2: float


@dataclass(frozen=True, eq=False)
class _Prior:
    """What is known of size, blur, crosstalk, ramp and shares, as 5 + k more observations."""

    blur: ExpectedBlur
    ramp_tolerance_dn_px: float
    appearance: Appearance

    @property
    def weight(self) -> Floats:
        ramp = self.ramp_tolerance_dn_px
        sigmas = [SIZE_TOLERANCE, self.blur.tolerance_px, CROSSTALK_TOLERANCE, ramp, ramp]
        return np.concatenate([sigmas, self.appearance.share_sigmas]) ** -2.0

    def residual(self, parameters: DiscParameters) -> Floats:
        return np.array(
            [
                1.0 - parameters.size,
                self.blur.psf_sigma_px - parameters.blur_px,
                -parameters.crosstalk,
                *-parameters.ramp_dn_px,
                *(self.appearance.expected_shares - parameters.shares),
            ]
        )

    def cost(self, parameters: DiscParameters) -> float:
        return float(np.sum(self.weight * self.residual(parameters) ** 2))

    def add_to(self, normal: Floats, right: Floats, parameters: DiscParameters) -> None:
        observed = np.concatenate([OBSERVED, np.arange(PARAMETERS, len(right))])
        normal[observed, observed] += self.weight
        right[observed] += self.weight * self.residual(parameters)


@dataclass(frozen=True, eq=False)
class _Look:
    """The model at a point."""

    parameters: DiscParameters
    model: Floats
    design: Floats
    residual: Floats


@dataclass(frozen=True, eq=False)
class _Accepted:
    """The last point at which the fit was better than before, and the step from it."""

    parameters: DiscParameters
    step: Floats
    weight: Floats
    residual: Floats
    influence: Floats
    covariance: Floats
    total: float

    def worsened_by(self, look: _Look, prior: _Prior) -> bool:
        cost = float(np.sum(self.weight * look.residual**2)) + prior.cost(look.parameters)
        return cost > self.total * WORSE


def _start(window: DiscWindow, appearance: Appearance, blur: ExpectedBlur) -> DiscParameters:
    inside = appearance.covers(window.x[:, 1:-1], window.y[1:-1])
    core, rim = (
        window.difference[inside & window.usable],
        window.difference[~inside & window.usable],
    )
    background = float(np.median(rim)) if len(rim) else 0.0
    height = float(np.median(core)) - background if len(core) else 1.0
    return DiscParameters(
        np.zeros(2),
        1.0,
        blur.start_px,
        blur.start_crosstalk,
        height,
        np.zeros(2),
        background,
        appearance.expected_shares,
    )


@dataclass(frozen=True, eq=False)
class _Problem:
    """One marker's pixels and what is known of it."""

    window: DiscWindow
    appearance: Appearance
    detector: Detector
    prior: _Prior

    def look(self, parameters: DiscParameters) -> _Look:
        model, design = self.appearance.model(self.window.x, self.window.y, parameters)
        return _Look(parameters, model, design, self.window.difference - model)

    def linearised(self, look: _Look) -> _Accepted | None:
        """Weigh the pixels by the model's own noise and solve for a step."""
        parameters = look.parameters
        variance = self.window.variance(look.model, parameters.background_dn, self.detector)
        weight = self.window.usable / variance
        flat = look.design.reshape(len(look.design), -1)
        weighted = flat * weight.reshape(-1)
        normal, right = weighted @ flat.T, weighted @ look.residual.reshape(-1)
        self.prior.add_to(normal, right, parameters)
        scale = np.sqrt(np.diag(normal)) + 1e-12
        balance = np.outer(scale, scale)
        try:
            covariance: Floats = np.linalg.inv(normal / balance).astype(np.float64) / balance
        except np.linalg.LinAlgError:
            return None
        step = covariance @ right
        if not np.isfinite(step).all():
            return None
        total = float(np.sum(weight * look.residual**2)) + self.prior.cost(parameters)
        influence = covariance[:2] @ weighted
        return _Accepted(parameters, step, weight, look.residual, influence, covariance, total)

    def summary(self, last: _Accepted) -> DiscFit | None:
        """Say how good a fit is; None if it is none."""
        noise = last.covariance[:2, :2]
        if last.parameters.height_dn <= 0.0 or np.linalg.eigvalsh(noise)[0] <= 0.0:
            return None
        chi2, shape_misfit = _misfit(last, self.window.usable)
        if not np.isfinite(chi2):
            return None
        if self.appearance.is_its_own_image:
            covariance = 0.5 * (noise + noise.T) + uneven_covariance(last, self.window)
        else:
            covariance = 0.5 * max(1.0, chi2) * (noise + noise.T)
            covariance += _pull_px2(last.parameters, shape_misfit, self.appearance.radius)
        return DiscFit(
            parameters=last.parameters,
            covariance_px2=covariance,
            height_sigma_dn=float(np.sqrt(last.covariance[5, 5])),
            shape_misfit=shape_misfit,
            misfit_chi2=chi2,
        )


def fit_disc(
    image_800: AnyArray,
    image_850: AnyArray,
    area_centre_px: Floats,
    shape_px2: Floats,
    detector: Detector,
    saturation_dn: float,
    blur: ExpectedBlur,
) -> DiscFit | None:
    """Fit one disc.

    Parameters
    ----------
    image_800, image_850 : (height, width) arrays, DN
    area_centre_px : (2,) array, px
        Predicted centre of area of the outline.
    shape_px2 : (2, 2) array, px^2
        Predicted ellipse, ``d^T S^-1 d = 1``.
    detector : Detector
    saturation_dn : float, DN
        Pixels at or above it are left out.
    blur : ExpectedBlur

    Returns
    -------
    DiscFit or None
        None where too few pixels are left or the fit runs away: there is no such disc there.
    """
    radius = float(np.linalg.det(shape_px2) ** 0.25)
    disc = EvenDisc(np.linalg.inv(shape_px2).astype(np.float64), radius)
    half_extent = np.sqrt(np.diag(shape_px2))
    window = cut_window(image_800, image_850, area_centre_px, half_extent, saturation_dn)
    return None if window is None else fit_appearance(window, disc, detector, blur)


def fit_appearance(
    window: DiscWindow, appearance: Appearance, detector: Detector, blur: ExpectedBlur
) -> DiscFit | None:
    """Fit what a marker should look like to its window.

    Parameters
    ----------
    window : DiscWindow
    appearance : Appearance
        About the window's own predicted centre.
    detector : Detector
    blur : ExpectedBlur

    Returns
    -------
    DiscFit or None
        As ``fit_disc``.
    """
    if np.count_nonzero(window.usable) < MIN_PIXELS:
        return None
    parameters = _start(window, appearance, blur)
    ramp_dn_px = RAMP_TOLERANCE * max(abs(parameters.height_dn), 1.0) / appearance.radius
    problem = _Problem(window, appearance, detector, _Prior(blur, ramp_dn_px, appearance))
    furthest = float(max(np.abs(window.x).max(), np.abs(window.y).max()))

    accepted, shorten = None, 1.0
    for _ in range(ITERATIONS):
        look = problem.look(parameters)
        if accepted is not None and accepted.worsened_by(look, problem.prior):
            shorten *= 0.25
            parameters = accepted.parameters.moved(shorten * accepted.step)
            continue
        accepted = problem.linearised(look)
        if accepted is None or np.abs(parameters.centre_px).max() > furthest:
            return None
        length = float(np.hypot(accepted.step[0], accepted.step[1]))
        if length < CONVERGED_PX:
            break
        shorten = min(1.0, LONGEST_STEP_PX / length)
        parameters = parameters.moved(shorten * accepted.step)
    return None if accepted is None else problem.summary(accepted)


def _misfit(last: _Accepted, usable: Mask) -> tuple[float, float]:
    """Return reduced chi-square, and the rms of what is no noise over the height."""
    left, weight = last.residual[usable], last.weight[usable]
    freedom = max(len(left) - len(last.step), 1)
    chi2 = float(np.sum(weight * left**2)) / freedom
    if not chi2 > 1.0 + SIGNIFICANT * np.sqrt(2.0 / freedom):
        return chi2, 0.0
    # What noise alone explains is no misfit of shape.
    left_over = float(np.mean(left**2)) * (1.0 - 1.0 / chi2)
    return chi2, float(np.sqrt(left_over)) / last.parameters.height_dn


def _pull_px2(parameters: DiscParameters, shape_misfit: float, radius: float) -> Floats:
    """Return the variance of the centre that a misfit of an even disc brings."""
    cut = float(np.sqrt(max(shape_misfit**2 - MODEL_MISFIT**2, 0.0)))
    pull_px = cut * (PULL_PX + PULL_PX3 / radius**2)
    exchanged = np.sqrt(max(2.0 * parameters.crosstalk, 0.0))
    softness_px = float(np.hypot(parameters.blur_px, exchanged))
    bend_px = BENT_EDGE_PX3 / radius**2 * max(1.0 - softness_px / SOFT_EDGE_PX, 0.0)
    return np.asarray((pull_px**2 + bend_px**2) * np.eye(2))


def uneven_covariance(last: _Accepted, window: DiscWindow) -> Floats:
    """Return what misfits that are not the same on both sides of the centre do to it, (2, 2) px^2.

    What differs alike on opposite sides (lines at another turn, another aperture) pulls both ways
    and leaves the centre where it is. So the window is parted into sectors, each with its
    opposite; what the residuals of one such pair add to the centre is noise, or a misfit's pull.
    All add up to nothing, as the fit is at its best; their scatter is what the centre may be off
    (the sandwich covariance of clustered residuals, Liang and Zeger 1986).
    """
    x = window.x[:, 1:-1] - last.parameters.centre_px[0]
    y = window.y[1:-1] - last.parameters.centre_px[1]
    turn = np.arctan2(*np.broadcast_arrays(y, x)) % np.pi
    sector = np.minimum((turn * (SECTORS / np.pi)).astype(np.int64), SECTORS - 1).reshape(-1)
    pull = last.influence * last.residual.reshape(-1)
    weight = np.maximum(last.weight.reshape(-1), 1e-300)
    noise = last.influence**2 / weight * (last.weight.reshape(-1) > 0.0)
    pulls = np.stack([np.bincount(sector, axis, SECTORS) for axis in pull], axis=1)
    foreseen = np.stack([np.bincount(sector, axis, SECTORS) for axis in noise], axis=1)
    excess = float((pulls**2).sum() / max(foreseen.sum(), 1e-300))
    if excess <= 1.0 + SIGNIFICANT / np.sqrt(SECTORS):
        return np.zeros((2, 2))
    hidden = 1.0 + (HIDDEN - 1.0) / (1.0 + (SHOWN_EXCESS / excess) ** 2)
    return np.asarray(hidden * SECTORS / (SECTORS - 1.0) * pulls.T @ pulls)
