"""Small datasets without a renderer, for estimates from elsewhere: a tumble, and pairs."""

import pytest

from tests.support.synthetic_dataset import SyntheticDataset, write_dataset
from tests.support.synthetic_images import SyntheticImages, write_images


@pytest.fixture(scope="session")
def tumble(tmp_path_factory) -> SyntheticImages:
    """Eight images of XMM at 30 m, 64 px wide; tests only read it."""
    return write_images(tmp_path_factory.mktemp("tumble") / "xmm", 8, 40.0, width_px=64)


@pytest.fixture(scope="session")
def pairs(tmp_path_factory) -> SyntheticDataset:
    """Three pairs of a Maxar-1300 at 3 m, without their images; tests only read it."""
    return write_dataset(tmp_path_factory.mktemp("pairs") / "data", 3, images=False, width_px=64)
