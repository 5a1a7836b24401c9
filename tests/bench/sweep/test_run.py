"""A sweep goes on from wherever it was stopped, costs no light twice, and says what a run says."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from bench import api
from bench.sweep import plan, stages
from bench.sweep.outcome import write_outcome
from bench.sweep.run import SweepResult
from bench.sweep.shots import read_shot
from bench.sweep.table import Row, read_csv, read_json
from models.dataset.estimates_file import read_estimates
from models.errors import DatasetError
from tests.bench.sweep.conftest import SUNS, SmallSweep
from tests.support.patience import HANGS_S
from tests.support.small_scenes import needs_jit
from tests.support.whole_runs import identities, start


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    """Without a JIT a tree is built for every group: minutes, for the same mechanics."""
    needs_jit()


FIT_STOPS_MM = 5e-8  # a prior that is another by its detour's rounding ends a fit elsewhere
PRIOR_AS_ANGLES = 1e-12  # a dataset's prior went through a file, as three angles

Traced = Callable[[], list[list[str]]]


def sun_entry(sweep: SmallSweep, result: SweepResult, band: int) -> Path:
    """Return where the store has the first Sun's light in one exposure."""
    shot = result.shots[result.settings[0], SUNS[0]]
    return sweep.store.path(shot.light[band]["sun_S2"])


def flip(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0x10
    path.write_bytes(data)


def inodes(folder: Path, pattern: str = "*.*") -> dict[str, int]:
    """Return which files stand where; one written again is another (reading may date an entry)."""
    return {str(path.relative_to(folder)): path.stat().st_ino for path in folder.rglob(pattern)}


def test_a_sweep_done_is_not_done_again(sweep: SmallSweep, traced: Traced) -> None:
    before = inodes(sweep.out / "shots") | inodes(sweep.store.folder, "*.exr")
    result, said = sweep.run()
    assert traced() == []
    assert "to trace: 0 light groups; 3 of 3 frames are done already" in said
    assert inodes(sweep.out / "shots") | inodes(sweep.store.folder, "*.exr") == before
    assert [row.sun for row in result.rows] == ["S2", "S2", "90/30", "90/30", "0/-90", "0/-90"]
    assert {row.verdict for row in result.rows if row.pipeline == "best"} <= {
        "all found", "some missed",
    }  # fmt: skip


def test_exposures_and_lamp_powers_cost_no_light(sweep: SmallSweep, traced: Traced) -> None:
    before = inodes(sweep.store.folder, "*.exr")
    result, said = sweep.run(exposure_ms=(0.001, 0.002), lamp_w_sr=(3.0, 12.0), pipeline="best")
    assert traced() == []
    assert "to trace: 0 light groups; 0 of 12 frames are done already" in said
    assert inodes(sweep.store.folder, "*.exr") == before
    assert len(result.settings) == 4
    assert len(result.rows) == 12
    assert len({(row.exposure_ms, row.lamp_w_sr) for row in result.rows}) == 4


def test_more_draws_are_runs_of_the_same_light(sweep: SmallSweep, traced: Traced) -> None:
    """The first draw stands; the others are the maps' pipeline's, each with noise of its own."""
    once, _ = sweep.run()
    several, said = sweep.run(draws=3, threads=2)
    assert traced() == []
    assert "3 of 9 frames are done already" in said
    for before, row in zip(once.rows, several.rows, strict=True):
        assert row.position_error_mm == before.position_error_mm
        assert (row.draws, before.draws) == (3 if row.pipeline == "best" else 1, 1)
        if row.pipeline == "best" and row.position_rms_mm is not None:
            assert row.position_least_mm < row.position_rms_mm < row.position_most_mm
    assert sweep.run(draws=3)[0].rows == several.rows
    assert sweep.run()[0].rows == once.rows


def test_another_sun_costs_its_own_light_alone(sweep: SmallSweep, traced: Traced) -> None:
    result, _ = sweep.run(suns=(*SUNS, "S6"))
    assert traced() == [["sun_S6"], ["sun_S6"]]  # 800 and 850 nm; the lamps are there
    assert len(result.rows) == 8


def test_killed_in_the_light_it_goes_on_without_redoing(
    sweep: SmallSweep, traced: Traced, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """One Sun a batch, killed as the first one's pair is to be exposed: its light is kept."""
    expected, _ = sweep.run(suns=SUNS[:2])
    setting = expected.settings[0]
    for sun in expected.plan.suns:
        for band in (800, 850):
            keys = expected.shots[setting, sun.text].light[band]
            (own,) = [key for name, key in keys.items() if name.startswith("sun")]
            sweep.store.path(own).unlink()
    monkeypatch.setattr(plan, "suns_in_a_batch", lambda *_: 1)
    fresh = {"out": tmp_path / "fresh", "suns": SUNS[:2]}

    def killed(*_: object) -> bool:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(stages, "take_shots", killed)
        with pytest.raises(KeyboardInterrupt):
            sweep.run(**fresh)
    assert traced() == [["sun_S2"]] * 2  # 800 and 850 nm
    result, said = sweep.run(**fresh)
    assert [groups == ["sun_S2"] for groups in traced()] == [True, True, False, False]
    assert "to trace: 2 light groups; 0 of 2 frames are done already" in said
    assert result.rows == expected.rows


@pytest.mark.slow
def test_killed_for_good_the_same_command_ends_the_same(sweep: SmallSweep, tmp_path: Path) -> None:
    """By SIGKILL, as the second shot's record gets its name."""
    out = tmp_path / "killed"
    typed = [
        "sweep",
        sweep.request.case,
        "--time-s",
        "250",
        "--suns",
        *SUNS,
        "--threads",
        "1",
        "--draws",
        "1",
    ]
    typed += ["--store", str(sweep.store.folder), "--out", str(out)]
    process = start(*typed, struck=("SIGKILL", "*/shots/*.json"))
    process.communicate(timeout=HANGS_S)
    assert process.returncode == -signal.SIGKILL
    assert not list((out / "shots").glob("*.json"))
    process = start(*typed)
    told, errors = process.communicate(timeout=HANGS_S)
    assert process.returncode == 0, errors
    assert "0 of 3 frames are done already" in errors
    assert f"table: {out / 'sweep.csv'}" in told
    assert read_csv(out / "sweep.csv") == sweep.run()[0].rows
    assert not [path for path in out.rglob("*") if ".part" in path.name]


@pytest.mark.parametrize("band", [800, 850])
def test_a_flipped_byte_is_found_and_that_entry_traced_again(
    sweep: SmallSweep, traced: Traced, band: int
) -> None:
    result, _ = sweep.run()
    entry = sun_entry(sweep, result, band)
    whole, shots = entry.read_bytes(), identities(sweep.out / "shots")
    flip(entry)
    again, said = sweep.run()
    assert traced() == [["sun_S2"]]
    assert "to trace: 1 light groups, 1 of it damaged in the store" in said
    assert entry.read_bytes() == whole
    assert identities(sweep.out / "shots") == shots
    assert again.rows == result.rows


def test_light_that_has_left_the_store_is_traced_only_where_it_is_needed(
    sweep: SmallSweep, traced: Traced
) -> None:
    result, _ = sweep.run()
    sun_entry(sweep, result, 850).unlink()
    sweep.run()
    assert traced() == []
    shot = result.shots[result.settings[0], SUNS[0]]
    (sweep.out / "shots" / f"{shot.key[:24]}.png").unlink()
    again, _ = sweep.run()
    assert traced() == [["sun_S2"]]
    assert again.rows == result.rows


def test_light_lost_between_tracing_and_exposing_is_traced_again(
    sweep: SmallSweep, traced: Traced, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As when another process prunes the store."""
    result, _ = sweep.run()
    for path in (sweep.out / "shots").iterdir():
        path.unlink()
    really, count = stages.take_shots, []

    def robbed(*arguments: object) -> bool:
        count.append(1)
        if len(count) == 1:
            sun_entry(sweep, result, 850).unlink()
        return really(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(stages, "take_shots", robbed)
    again, _ = sweep.run()
    assert traced() == [["sun_S2"]]
    assert again.rows == result.rows


def test_the_number_of_workers_changes_nothing(swept_once: SmallSweep, tmp_path: Path) -> None:
    one, _ = swept_once.run(out=tmp_path / "one", exposure_ms=(0.002,), threads=1)
    two, _ = swept_once.run(out=tmp_path / "two", exposure_ms=(0.002,), threads=2)
    assert one.rows == two.rows
    for path in (tmp_path / "one" / "shots").iterdir():
        assert path.read_bytes() == (tmp_path / "two" / "shots" / path.name).read_bytes()


def test_it_says_what_a_run_of_the_same_moment_and_sun_says(
    sweep: SmallSweep, traced: Traced, tmp_path: Path
) -> None:
    """From the same light: the run finds the sweep's in the store, under the keys it would use."""
    result, _ = sweep.run()
    out = tmp_path / "run"
    api.render(
        sweep.request.case, out, sun=result.plan.suns[1].text,
        start_s=250.0, end_s=250.0, store=sweep.store.folder,
    )  # fmt: skip
    assert traced() == []
    api.estimate(out)
    (alone,) = read_estimates(out / "estimates" / "best.jsonl")
    record = read_shot(sweep.out, result.shots[result.settings[0], result.plan.suns[1].text])
    assert record is not None
    swept = record.estimates["best"]
    assert swept.pose is not None
    assert alone.pose is not None
    assert swept.detections is not None
    assert alone.detections is not None
    assert swept.detections.points_px.tolist() == alone.detections.points_px.tolist()
    np.testing.assert_allclose(
        swept.pose.cam_from_target.matrix(),
        alone.pose.cam_from_target.matrix(),
        atol=PRIOR_AS_ANGLES,
    )
    scored = api.score(out)["pipelines"]["best"]["per_frame"][0]
    row = next(r for r in result.rows if r.sun == "90/30" and r.pipeline == "best")
    assert [row.error_x_mm, row.error_y_mm, row.error_z_mm] == pytest.approx(
        scored["position_mm"], rel=1e-6, abs=FIT_STOPS_MM
    )
    assert (row.expected, row.range_m) == (scored["expected"], pytest.approx(scored["range_m"]))


def test_files_of_a_sweep(sweep: SmallSweep) -> None:
    result, _ = sweep.run(exposure_ms=(0.001, 0.002))
    files = write_outcome(result)
    assert [path.name for path in files.maps] == ["sun_map_1.png", "sun_map_2.png"]
    rows, about = read_json(files.json)
    assert rows == read_csv(files.csv) == result.rows
    assert about["case"] == "small"
    page = files.page.read_text()
    assert page.count("data:image/png") == 1  # the first map; the second is smaller
    # A filmstrip, those at both ends, and the frame of each tile, of which two pipelines tell.
    assert page.count("data:image/jpeg") == 1 + len(files.extremes) + len(rows) // 2
    assert len(files.extremes) == 2  # of three Suns: one kindest, one harshest
    assert "://" not in page.replace("http://www.w3.org", "")  # base64 has no colon
    write_outcome(sweep.run(exposure_ms=(0.001,))[0])
    assert [path.name for path in sorted(sweep.out.glob("sun_map*"))] == ["sun_map.png"]


def test_a_folder_of_another_scenario_or_a_dataset_is_refused(
    sweep: SmallSweep, tmp_path: Path
) -> None:
    before = identities(sweep.out)
    with pytest.raises(DatasetError, match="holds one of another \\(camera differ"):
        sweep.run(width=256)
    assert identities(sweep.out) == before
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "dataset.json").write_text("{}")
    with pytest.raises(DatasetError, match="it holds a dataset"):
        sweep.run(out=tmp_path / "data")
    with pytest.raises(DatasetError, match="found a file"):
        sweep.run(out=tmp_path / "data" / "dataset.json")


def test_the_wall_pipelines_load_no_renderer(sweep: SmallSweep) -> None:
    """Workers expose and estimate without Mitsuba, and a pipeline is handed no truth."""
    program = "import sys, bench.sweep.shots; print({'mitsuba', 'drjit'} & set(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": str(Path(api.__file__).parents[1])},
    )  # fmt: skip
    assert done.stdout.strip() == "set()"


def test_rows_name_the_sun_so_that_a_run_can_be_typed(swept_once: SmallSweep) -> None:
    result, _ = swept_once.run()
    rows: list[Row] = result.rows
    assert {row.sun_text for row in rows} == {sun.text for sun in result.plan.suns}


def test_pictures_of_the_users_own_stay(sweep: SmallSweep) -> None:
    """What is swept away when the page is made again is only what a sweep writes."""
    result, _ = sweep.run()
    write_outcome(result)
    mine = [sweep.out / "sun_map_talk.png", sweep.out / "extremes" / "my_best.png"]
    old = [sweep.out / "sun_map_7.png", sweep.out / "extremes" / "best_9.png"]
    for path in (*mine, *old):
        path.write_bytes(b"")
    write_outcome(result)
    assert all(path.exists() for path in mine)
    assert not any(path.exists() for path in old)
