"""What a pipeline that tracks known markers must know before the first frame."""

from __future__ import annotations

from dataclasses import dataclass

from models.arrays import Floats
from models.camera import Camera
from models.markers import MarkerPattern
from models.onboard import OnboardKnowledge, needed
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector


@dataclass(frozen=True, eq=False)
class FlightKnowledge:
    """The parts of what is on board that such a pipeline cannot do without.

    Attributes
    ----------
    camera : Camera
        As calibrated, not as simulated.
    detector : Detector
        Gain, bias, read noise and full well, as calibrated.
    markers : MarkerPattern
        As surveyed, not as installed.
    prior : RigidTransform
        ``cam_from_target`` at the first frame, as drawn.
    prior_sigma_m : (3,) array, m
    prior_sigma_deg : (3,) array, deg
        The prior's 1-sigma in translation and in (alpha, beta, gamma).
    """

    camera: Camera
    detector: Detector
    markers: MarkerPattern
    prior: RigidTransform
    prior_sigma_m: Floats
    prior_sigma_deg: Floats

    @classmethod
    def of(cls, onboard: OnboardKnowledge, pipeline: str) -> FlightKnowledge:
        """Take the parts that are needed.

        Parameters
        ----------
        onboard : OnboardKnowledge
        pipeline : str
            Who needs them, for the message.

        Raises
        ------
        DatasetError
            If the markers or the prior are not on board.
        """
        prior = needed(onboard.prior, "prior.toml", pipeline)
        return cls(
            camera=needed(onboard.camera, "camera.toml", pipeline),
            detector=needed(onboard.detector, "detector.toml", pipeline),
            markers=needed(onboard.markers, "markers.toml", pipeline),
            prior=prior.cam_from_target,
            prior_sigma_m=prior.sigma_m,
            prior_sigma_deg=prior.sigma_deg,
        )
