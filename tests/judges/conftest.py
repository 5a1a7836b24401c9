"""Two small datasets, rendered and exported by the command line: judges see files, and no code.

Nothing here imports the house: what a judge says cannot come from what it judges.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.judges.command import SPLIT, rvbench

FREE_TARGET = """
name = "judged-xmm"
target = "xmm"
sun = {{ default = "0.1,0.2,1.0" }}
render = {{ samples = {samples}, max_depth = 2 }}
exposure = {{ mode = "fixed", exposure_ms = 4.0 }}
motion = {{ end_s = {end_s}, rate_hz = {rate_hz} }}
camera = {camera}

[tumble]
rho0_m = [0.0, 30.0, 0.0]
rho_dot0_m_s = [0.0, 1e-4, 0.0]
omega0_deg_s = [0.5, -0.3, 0.2]
inertia_kg_m2 = [[7052.0, -820.0, -3991.0], [-820.0, 129129.0, 0.0], [-3991.0, 0.0, 131196.0]]

[tumble.orbit]
a_km = 7143.1
e = 1.4e-4
i_deg = 98.2
argument_of_perigee_deg = 85.9
raan_deg = 79.2
true_anomaly_deg = 0.0

[tumble.onboard]
chaser_sigma_m_s = 0.2
range_m = [20.0, 40.0]
"""
DISTORTING = (
    "{ width = 80, height = 64, fx = 150.0, fy = 148.0, cx = 41.2, cy = 30.4, "
    "k1 = -0.22, k2 = 0.51, p1 = -6.6e-4, p2 = -2.1e-4, k3 = -0.13 }"
)


def _free_target(place: Path, frames: int, step_s: float, camera: str, samples: int) -> Path:
    case = place / "case.toml"
    text = FREE_TARGET.format(
        end_s=step_s * (frames - 1), rate_hz=1.0 / step_s, camera=camera, samples=samples
    )
    case.write_text(text)
    rvbench("render", case, "--out", place / "data", "--store", place / "store")
    return place / "data"


@pytest.fixture(scope="session")
def xmm(tmp_path_factory) -> Path:
    """Return XMM-Newton in four single images of 96 x 96."""
    return _free_target(tmp_path_factory.mktemp("xmm"), 4, 20.0, "{ width = 96 }", 4)


@pytest.fixture(scope="session")
def maxar(tmp_path_factory) -> Path:
    """Return a Maxar-1300 in five pairs of 64 x 64, 6.7 m to 4 m from the camera."""
    place = tmp_path_factory.mktemp("maxar")
    words = ["--width", 64, "--spp", 4, "--span-s", 0, 200, "--rate-hz", 0.02]
    out = place / "data"
    rvbench("render", "maxar-approach", *words, "--out", out, "--store", place / "store")
    return out


@pytest.fixture(scope="session")
def hundred(tmp_path_factory) -> Path:
    """Return XMM-Newton in a hundred images of a lens that distorts as SPEED+'s does."""
    return _free_target(tmp_path_factory.mktemp("hundred"), 100, 10.0, DISTORTING, 1)


@pytest.fixture(scope="session")
def exported(tmp_path_factory, maxar, xmm) -> Callable[[str], Path]:
    """Return what exports both datasets in a format, once, and has the export check itself."""
    done: dict[str, Path] = {}

    def export(kind: str) -> Path:
        if kind not in done:
            out = tmp_path_factory.mktemp("exports") / kind
            words = ["--as", kind, "--split", *SPLIT, "--licence", "CC-BY-4.0", "--check"]
            rvbench("export", maxar, xmm, *words, "--out", out)
            done[kind] = out
        return done[kind]

    return export


def pytest_configure(config: pytest.Config) -> None:
    """Let judges use what will be gone one day: that is theirs to mend, and no fault of a file."""
    for kind in ("DeprecationWarning", "ResourceWarning"):
        config.addinivalue_line("filterwarnings", f"ignore::{kind}")
