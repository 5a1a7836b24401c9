"""What is on board before the first frame, as the files of a dataset's public half."""

from __future__ import annotations

from models.dataset.image_dataset import FORMAT as IMAGE_FORMAT
from models.dataset.image_dataset import knowledge_to_toml, navigation_to_csv

from models.dataset.dataset import FORMAT, detector_to_toml, markers_to_toml, prior_to_toml
from models.wireframe.wireframe_file import wireframe_to_json
from renders.world.tumble_world import TumbleWorld
from renders.world.world import World


def dataset_format(world: World) -> str:
    """Return the format of the dataset that a world gives."""
    return IMAGE_FORMAT if isinstance(world, TumbleWorld) else FORMAT


def public_files(world: World, run: int = 0) -> dict[str, str]:
    """Return the texts of the files that a run is given, by name.

    ``dataset.json``, ``frames.csv`` and the frames themselves are not among them.

    Raises
    ------
    ScenarioError
        If the target has no markers where pairs need them, or no wireframe where images do.
    """
    if isinstance(world, TumbleWorld):
        return _of_images(world, run)
    knowledge = world.knowledge(run)
    return {
        "camera.toml": knowledge.camera.to_toml(),
        "detector.toml": detector_to_toml(knowledge.detector),
        "markers.toml": markers_to_toml(knowledge.markers),
        "prior.toml": prior_to_toml(knowledge),
    }


def _of_images(world: TumbleWorld, run: int) -> dict[str, str]:
    onboard = world.onboard(run)
    return {
        "camera.toml": onboard.camera.to_toml(),
        "detector.toml": detector_to_toml(world.scenario.simulated_detector),
        "knowledge.toml": knowledge_to_toml(onboard),
        "wireframe.json": wireframe_to_json(onboard.target),
        "navigation.csv": navigation_to_csv(
            (exposure.frame, world.navigation(exposure, run)) for exposure in world.exposures
        ),
    }
