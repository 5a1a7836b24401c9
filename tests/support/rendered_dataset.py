"""The smallest dataset that was truly rendered: a free target, a few frames, a few pixels."""

from __future__ import annotations

from pathlib import Path

import tomli_w

from bench import api
from tests.support.tumble_scenario import tumble_table


def render_tumble(folder: Path, frames: int = 3, width: int = 96) -> Path:
    """Render XMM at 30 m into ``folder / data``, with a store of its own.

    Parameters
    ----------
    folder : Path
    frames : int
    width : int, px
    """
    case = folder / "tumble.toml"
    table = tumble_table(
        camera={"width": width}, motion={"end_s": 20.0 * (frames - 1), "rate_hz": 0.05}
    )
    case.write_text(tomli_w.dumps(table))
    api.render(str(case), folder / "data", store=folder / "store")
    return folder / "data"
