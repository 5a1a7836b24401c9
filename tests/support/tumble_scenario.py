"""The smallest scenario of a free target: XMM at 30 m, a few frames, a few pixels."""

from __future__ import annotations

from typing import Any

TUMBLE: dict[str, Any] = {
    "orbit": {
        "a_km": 7143.1,
        "e": 1.4e-4,
        "i_deg": 98.2,
        "argument_of_perigee_deg": 85.9,
        "raan_deg": 79.2,
        "true_anomaly_deg": 0.0,
    },
    "rho0_m": [0.0, 30.0, 0.0],
    "rho_dot0_m_s": [0.0, 1e-4, 0.0],
    "omega0_deg_s": [0.5, -0.3, 0.2],
    "inertia_kg_m2": [
        [7052.0, -820.0, -3991.0],
        [-820.0, 129129.0, 0.0],
        [-3991.0, 0.0, 131196.0],
    ],
    "onboard": {"chaser_sigma_m_s": 0.2, "range_m": [20.0, 40.0]},
}


def tumble_table(**changes: Any) -> dict[str, Any]:
    """Return a scenario of three frames at 64 columns; ``changes`` replace whole keys."""
    return {
        "name": "small-tumble",
        "target": "xmm",
        "camera": {"width": 64},
        "motion": {"end_s": 100.0, "rate_hz": 0.02},
        "sun": {"default": "0.1,0.2,1.0"},
        "earth": {"shines": True},
        "render": {"samples": 4, "max_depth": 2},
        "exposure": {"mode": "fixed", "exposure_ms": 4.0},
        "tumble": TUMBLE,
        **changes,
    }
