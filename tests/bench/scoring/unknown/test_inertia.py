"""The inertia's error at the end: of its trace, in true axes, whichever way it is off."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.scoring.unknown import parts
from models.estimate import Estimate, NamedState
from pipelines.unknown_target.pipeline import INERTIA

TRUE_KG_M2 = np.array([[700.0, 30.0, -20.0], [30.0, 900.0, 10.0], [-20.0, 10.0, 400.0]])
TURN = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()  # true_from_own


def error_percent(
    monkeypatch: pytest.MonkeyPatch, off: float, tumble: dict[str, object] | None = None
) -> float | None:
    """Say the true inertia in the pipeline's own axes, one entry off by a share of the trace."""
    table = {"tumble": {"inertia_kg_m2": TRUE_KG_M2.tolist()} if tumble is None else tumble}
    monkeypatch.setattr(parts, "scenario_tables", lambda folder: table)
    told = TRUE_KG_M2 / 2000.0
    told[1, 1] += off
    state = NamedState({"inertia_of_trace_1": TURN.T @ told @ TURN}, np.zeros((0, 0)))
    frame = SimpleNamespace(
        estimate=Estimate(0, 0.0, reason="in the dark", states={INERTIA: state}),
        true_from_own=TURN,
    )
    truth = SimpleNamespace(dataset=SimpleNamespace(folder=Path("nowhere")))
    found = parts.inertia([[frame]], truth, "best")  # type: ignore[list-item, arg-type]
    return None if found is None else found.entries_percent


@pytest.mark.parametrize("off", [0.03, -0.03, 0.0])
def test_an_entry_that_is_off_is_told_by_its_size(
    monkeypatch: pytest.MonkeyPatch, off: float
) -> None:
    assert error_percent(monkeypatch, off) == pytest.approx(100.0 * abs(off), abs=1e-9)


def test_nothing_is_told_where_no_true_inertia_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    assert error_percent(monkeypatch, 0.0, {}) is None
