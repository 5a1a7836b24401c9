"""The reference of a scenario's keys is that of its tables, and leaves none unexplained."""

from collections.abc import Iterator
from pathlib import Path

import tomli_w

from bench.scenario_reference import EXAMPLE, PLACE, reference
from renders.scenario.scenario import Scenario, read_scenario
from renders.scenario.table import Table
from tests.support.own_scenario import OWN_MARKERS, pose_lines


def leaves(table: Table, within: str = "") -> Iterator[str]:
    """Walk the keys of a plain scenario, as pydantic and not as the reference has them."""
    for key in type(table).model_fields:
        value = getattr(table, key)
        if isinstance(value, Table):
            yield from leaves(value, f"{within}{key}.")
        else:
            yield f"{within}{key}"


def test_the_committed_reference_is_that_of_the_tables() -> None:
    assert PLACE.read_text() == reference(), "run: python -m bench.scenario_reference"


def test_every_key_stands_in_it_with_a_meaning() -> None:
    rows = [line for line in reference().splitlines() if line.startswith("| `")]
    cells = [[cell.strip() for cell in row.strip("|").split(" | ")] for row in rows]
    assert all(len(row) == 6 and row[5] for row in cells), [r for r in cells if not r[-1]]
    named = {row[0].strip("`") for row in cells}
    # Their keys are listed, absent as they are.
    tables = {
        "tumble", "frame", "markers", "told", "drift", "own_target", "surface", "arm",
        "range_finder", "navigation", "shutter", "orbits",
    }  # fmt: skip
    plain = Scenario(name="x")  # type: ignore[call-arg]
    assert {key.split(".")[-1] for key in leaves(plain)} - named <= tables


def test_units_and_ranges_are_those_of_the_keys() -> None:
    text = reference()
    for row in (
        "| `gain_e_dn` | number | e/DN | `26.0` | from 0.001 to 1e+06 | electrons a number |",
        "| `omega0_deg_s` | list of 3 numbers | deg/s | required | from -360 to 360 |",
        "| `fx` | number | px | left out | from 1 to 1e+06 |",
        "| `bits` | whole number |  | `12` | from 8 to 16 | of the converter |",
    ):
        assert row in text


def test_its_example_can_be_used(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(EXAMPLE)
    (tmp_path / "markers.toml").write_text(tomli_w.dumps(OWN_MARKERS))
    lines = pose_lines(3)
    (tmp_path / "poses.csv").write_text("\n".join(lines))
    scenario = read_scenario(tmp_path / "mine.toml")
    assert (scenario.motion_kind, scenario.frame_kind) == ("poses", "pairs")
    assert len(scenario.times_s) == 3
    assert scenario.told is not None
    text = reference()
    assert EXAMPLE in text
    assert lines[0] in text
