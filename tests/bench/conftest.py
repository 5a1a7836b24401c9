"""One small dataset, estimated, scored and reported once, for the tests that only read it."""

import pytest

from bench import api
from tests.support.synthetic_dataset import SyntheticDataset, write_dataset


@pytest.fixture(scope="session")
def scored_dataset(tmp_path_factory) -> SyntheticDataset:
    dataset = write_dataset(tmp_path_factory.mktemp("scored") / "data", frames=4)
    api.estimate(dataset.folder)
    api.score(dataset.folder)
    api.report(dataset.folder)
    return dataset
