"""Scenarios: what is written is what is read, and what is wrong is refused in words."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import ScenarioError
from renders.scenario.case_files import CASES, case_description, case_names, case_path
from renders.scenario.scenario import (
    SHAPING_NOTHING,
    RenderRequest,
    Scenario,
    check_scenario,
    read_scenario,
    resolve,
)
from tests.support.own_scenario import OWN_CAMERA, OWN_MARKERS, every_difference, pose_lines
from tests.support.tumble_scenario import TUMBLE

REQUEST = RenderRequest("maxar-demo", Path("unused"))


def written(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(text)
    return path


def refusal(folder: Path, text: str) -> str:
    """Return what is said about a scenario that cannot be used; it must name the file."""
    with pytest.raises(ScenarioError) as told:
        read_scenario(written(folder, text))
    assert str(told.value).startswith(str(folder / "mine.toml"))
    return str(told.value).removeprefix(str(folder / "mine.toml"))


# Keys and values


@pytest.mark.parametrize(
    ("text", "key", "meant"),
    [
        ('name = "x"\nmotoin = 1', "motoin", "motion"),
        ('name = "x"\n[motion]\nratehz = 1.0', "motion.ratehz", "rate_hz"),
        ('name = "x"\n[detector]\nread_noise = 5.0', "detector.read_noise", "read_noise_e"),
        ('name = "x"\n[render]\nsample = 4', "render.sample", "samples"),
        ('name = "x"\n[camera]\nwith = 512', "camera.with", "width"),
    ],
)
def test_an_unknown_key_is_refused_and_the_nearest_suggested(
    tmp_path: Path, text: str, key: str, meant: str
) -> None:
    said = refusal(tmp_path, text)
    assert f"unknown key {key};" in said
    assert said.endswith(f"perhaps you meant {meant}")


def test_an_unknown_key_like_no_other_lists_those_there_are(tmp_path: Path) -> None:
    said = refusal(tmp_path, 'name = "x"\n[exposure]\nzzz = 1')
    assert "expected one of mode, marker_fill," in said
    assert "perhaps" not in said


@pytest.mark.parametrize(
    ("text", "key", "came"),
    [
        ('[motion]\nrate_hz = "fast"', "motion.rate_hz", "'fast'"),
        ("[motion]\nrate_hz = 0.0", "motion.rate_hz", "0.0"),
        ("[motion]\nend_s = -3.0", "motion.end_s", "-3.0"),
        ("[motion]\nend_s = nan", "motion.end_s", "nan"),
        ("[motion]\nend_s = inf", "motion.end_s", "inf"),
        ("[camera]\nwidth = 16", "camera.width", "16"),
        ("[camera]\nwidth = 512.5", "camera.width", "512.5"),
        ("[render]\nmax_depth = 0", "render.max_depth", "0"),
        ("[detector]\nbits = 20", "detector.bits", "20"),
        ("[lamps]\nradius_m = 0.06", "lamps.radius_m", "0.06"),
        ("[prior]\nsigma_t_m = [0.1, 0.1]", "prior.sigma_t_m", ""),
        ('[prior]\nsigma_euler_deg = [1.0, "b", 1.0]', "prior.sigma_euler_deg", "'b'"),
        ("[sun]\ndefault = 3", "sun.default", "3"),
        ("[sun]\nshared = 'S1'", "sun.shared", "'S1'"),
        ("motion = 5", "motion", "5"),
    ],
)
def test_a_wrong_kind_size_or_shape_names_its_key_and_what_came(
    tmp_path: Path, text: str, key: str, came: str
) -> None:
    said = refusal(tmp_path, 'name = "x"\n' + text)
    assert key in said
    assert came in said


def test_everything_that_is_wrong_is_said_at_once(tmp_path: Path) -> None:
    said = refusal(tmp_path, 'name = "x"\n[render]\nsample = 4\nmax_depth = 0\n[optics]\nfoo = 1')
    for key in ("render.sample", "render.max_depth", "optics.foo"):
        assert key in said


def test_a_scenario_has_a_name(tmp_path: Path) -> None:
    assert "name" in refusal(tmp_path, "[render]\nsamples = 4")


def test_what_is_not_toml_or_not_there_is_refused(tmp_path: Path) -> None:
    assert "TOML" in refusal(tmp_path, "name = ")
    (tmp_path / "mine.toml").write_bytes(b"\xff\xfe\x00n")
    with pytest.raises(ScenarioError, match="TOML"):
        read_scenario(tmp_path / "mine.toml")
    with pytest.raises(ScenarioError, match="absent"):
        read_scenario(tmp_path / "absent.toml")


# Numbers have ranges, values have kinds, text is text


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "[motion]\nend_s = 1e9",
            "motion.end_s from 0 to 1e+06 (last frame, or just after it), got 1000000000.0",
        ),
        ("[motion]\nend_s = 9e5\nrate_hz = 15", "at most 100000 frames, got 1.35e+07"),
        (
            "[motion]\nend_s = inf",
            "motion.end_s from 0 to 1e+06 (last frame, or just after it), got inf",
        ),
        ("[radiation]\nflux_cm2_s = 1e12", "radiation.flux_cm2_s from 0 to 10000"),
        ("[optics]\npsf_sigma_px = 1e9", "optics.psf_sigma_px from 0 to 50"),
        ("[render]\nmarker_samples = 1000000000000", "render.marker_samples from 1 to 65536"),
        ("[optics]\nf_number = 1e-300", "optics.f_number from 0.5 to 1000"),
        ("[optics]\nf_number = 1e300", "optics.f_number from 0.5 to 1000"),
        ("[detector]\nprnu = 1e300", "detector.prnu from 0 to 0.5"),
        ("[detector]\ndark_current_e_s = 1e300", "detector.dark_current_e_s from 0 to 1e+07"),
        ("[camera]\nk1 = -5", "one-to-one over the image, got k1 -5, k2 0"),
        ("[camera]\nk3 = 1e300", "camera.k3"),
        ("[detector]\nbias_dn = 1e300", "detector.bias_dn from 0 to 65535"),
        ("[detector]\ngain_e_dn = 1e-300", "detector.gain_e_dn from 0.001 to 1e+06"),
        ("[detector]\nread_noise_e = 1e300", "detector.read_noise_e from 0 to 100000"),
        ("[detector]\nbias_dn = 4095", "at least 10 DN between bias and saturation, got 0"),
        ("[detector]\nbits = 8\nbias_dn = 300", "at least 10 DN between bias and saturation"),
        ("[detector]\nfull_well_e = 100\ngain_e_dn = 26", "got 3.85 with a bias of 100 DN"),
        ("[detector]\ngain_e_dn = 0.001", "detector.read_noise_e of at most a tenth"),
        ("[detector]\nread_noise_e = 20000", "detector.read_noise_e of at most a tenth"),
        ("[detector]\npixel_pitch_um = 1000\n[optics]\nfocus_m = 3.0", "twice the focal length"),
        (
            "[detector]\npixel_pitch_um = 1000\n[radiation]\nflux_cm2_s = 1000",
            "1e+06 particles on the chip",
        ),
        (f"[render]\nseed = {2**64}", "render.seed from 0 to 9.22337e+18"),
        (f"[render]\nsamples = {10**4000}", "a whole number of some 4000 digits"),
    ],
)
def test_a_number_beyond_its_range_is_refused_and_the_range_told(
    tmp_path: Path, text: str, said: str
) -> None:
    assert said in refusal(tmp_path, 'name = "x"\n' + text)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[camera]\nwidth = "64"', "camera.width to be a whole number"),
        ("[camera]\nwidth = 64.0", "camera.width to be a whole number"),
        ("[render]\nsamples = true", "render.samples to be a whole number"),
        ('[motion]\nrate_hz = "1"', "motion.rate_hz to be a number"),
        ("[motion]\nrate_hz = true", "motion.rate_hz to be a number"),
        ("[motion]\ntarget_wobble = 1", "motion.target_wobble to be true or false"),
        ('[motion]\ntarget_wobble = "yes"', "motion.target_wobble to be true or false"),
        ('[earth]\ndirection = ["0", 0, 1]', "earth.direction.0 to be a number"),
        ("[earth]\ndirection = [true, 0, 1]", "earth.direction.0 to be a number"),
        ("[sun]\nshared = [1]", "sun.shared.0 to be text"),
    ],
)
def test_nothing_is_coerced(tmp_path: Path, text: str, said: str) -> None:
    assert said in refusal(tmp_path, 'name = "x"\n' + text)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f'name = "{1_000_000 * "x"}"', "at most 200 characters"),
        (f'name = "{900_000 * "x"}"', "name to be at most 200 characters"),
        (f'name = "x"\ndescription = "{20_000 * "x"}"', "description to be at most 10000"),
        ("name = 'x'\nzzz = [" + 20_000_000 * "1," + "]", "more than 32 MB"),
        ("name = 'x'\nzzz = [" + 400_000 * "1," + "]", "unknown key zzz"),
        ("name = 'x'\n" + "".join(f"z{n} = 1\n" for n in range(50_000)), "and 49990 more"),
        (f"name = 'x'\n{900_000 * 'z'} = 1", "unknown key zzz"),
        ("a = " + 5000 * "[" + 5000 * "]", "nested more than 32 deep"),
        (".".join(5000 * ["a"]) + " = 1", "nested more than 32 deep"),
        (f"name = 'x'\nzzz = 1{5000 * '0'}", "digits"),
        ('name = "x\\u001b[31m"', "name to be printable text on one line"),
        ('name = "x\\ny"', "name to be printable text on one line"),
        ('name = " "', "name to be printable text on one line"),
        ('name = "x\\u202ey"', "name to be printable text on one line"),
        ('name = "x"\ndescription = "\\u001b[2J"', "description to be printable text"),
        ('name = "x"\n[sun]\ndefault = "S2\\n"', "sun.default to be printable text"),
    ],
    ids=lambda text: text[:30],
)
def test_text_and_size_have_bounds(tmp_path: Path, text: str, said: str) -> None:
    told = refusal(tmp_path, text)
    assert said in told
    assert told.isprintable()
    assert len(told) < 5000


def test_a_scenario_may_begin_with_a_byte_order_mark_and_have_any_printable_name(
    tmp_path: Path,
) -> None:
    path = written(tmp_path, '\ufeffname = "[bold red]x[/nosuch] $\\\\frac{$ Ü"\n')
    assert read_scenario(path).name == "[bold red]x[/nosuch] $\\frac{$ Ü"


def test_a_scenario_is_a_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "mine.toml")
    with pytest.raises(ScenarioError, match="a pipe, where a file was expected"):
        read_scenario(tmp_path / "mine.toml")


# What no single key can show


@pytest.mark.parametrize("sun", ["0,0,0", "1,2", "nan,0,1", "S9", "up"])
def test_a_sun_that_is_none_is_refused(tmp_path: Path, sun: str) -> None:
    path = written(tmp_path, f'name = "x"\n[sun]\ndefault = "{sun}"')
    with pytest.raises(ScenarioError, match="Sun"):
        read_scenario(path)
    path = written(tmp_path, f'name = "x"\n[sun]\nshared = ["S1", "{sun}"]')
    with pytest.raises(ScenarioError, match="Sun"):
        read_scenario(path)


def test_a_span_ends_after_its_start(tmp_path: Path) -> None:
    said = refusal(tmp_path, 'name = "x"\n[motion]\nstart_s = 20.0\nend_s = 10.0')
    assert "motion.end_s" in said
    assert "20.0 to 10.0 s" in said


def test_an_unknown_camera_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, 'name = "x"\n[camera]\npreset = "chaser"')
    with pytest.raises(ScenarioError, match="chaser_fixed, eye_in_hand"):
        read_scenario(path)


# Cases and options


def test_cases_are_found_by_name_or_path(tmp_path: Path) -> None:
    assert {"maxar-approach", "maxar-demo"} <= set(case_names())
    assert case_path("maxar-demo") == CASES / "maxar-demo.toml"
    path = written(tmp_path, 'name = "x"')
    assert case_path(str(path)) == path


def test_an_unknown_case_is_refused_and_the_nearest_suggested(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="perhaps you meant maxar-demo"):
        case_path("maxar-dmeo")
    with pytest.raises(ScenarioError, match=r"found none"):
        case_path(str(tmp_path / "absent.toml"))
    with pytest.raises(ScenarioError, match="expected a case among"):
        case_path("../cases/maxar-demo")


@pytest.mark.parametrize("case", case_names())
def test_every_case_can_be_used(case: str) -> None:
    scenario = resolve(replace(REQUEST, case=case))
    assert scenario.name == case
    assert scenario.description.strip()
    assert case_description(case) == " ".join(scenario.description.split())
    assert len(scenario.times_s) > 1


def test_options_change_what_they_name_and_nothing_else() -> None:
    options: dict[str, Any] = {
        "sun": "S5",
        "rate_hz": 0.5,
        "start_s": 10.0,
        "end_s": 20.0,
        "width": 256,
        "spp": 25,
    }
    plain = resolve(REQUEST).model_dump()
    changed = resolve(replace(REQUEST, **options)).model_dump()
    places = {
        ("sun", "default"): "S5",
        ("motion", "rate_hz"): 0.5,
        ("motion", "start_s"): 10.0,
        ("motion", "end_s"): 20.0,
        ("camera", "width"): 256,
        ("render", "samples"): 25,
    }
    for (table, key), value in places.items():
        assert changed[table][key] == value != plain[table][key]
        plain[table][key] = value
    assert changed == plain


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"spp": 0}, "from 1 to 4096"),
        ({"width": 10}, "64"),
        ({"rate_hz": -1.0}, "from 1e-06 to 15"),
        ({"sun": "0,0,0"}, "length"),
        ({"start_s": 200.0, "end_s": 100.0}, "200.0 to 100.0 s"),
    ],
)
def test_an_option_that_cannot_be_used_is_refused(options: dict[str, Any], match: str) -> None:
    with pytest.raises(ScenarioError, match=match):
        resolve(replace(REQUEST, **options))


@pytest.mark.parametrize(
    ("start_s", "end_s", "rate_hz", "count"),
    [(0.0, 330.0, 5.0, 1651), (0.0, 330.0, 0.1, 34), (0.0, 0.3, 10.0, 4), (5.0, 5.0, 1.0, 1)],
)
def test_frames_are_evenly_spaced_and_hold_both_ends(
    start_s: float, end_s: float, rate_hz: float, count: int
) -> None:
    motion = {"start_s": start_s, "end_s": end_s, "rate_hz": rate_hz}
    times = Scenario(name="x", motion=motion).times_s  # type: ignore[arg-type]
    assert len(times) == count
    assert times[0] == start_s
    assert times[-1] == pytest.approx(end_s)
    np.testing.assert_allclose(np.diff(times), 1.0 / rate_hz)


def test_larger_pixels_are_the_same_chip_seen_coarsely() -> None:
    """Half the columns: pixels twice as wide, blur half as many of them, the same field of view."""
    whole = resolve(replace(REQUEST, width=2048))
    half = resolve(replace(REQUEST, width=1024))
    assert half.simulated_detector.pixel_pitch_um == 2.0 * whole.simulated_detector.pixel_pitch_um
    assert half.simulated_optics.psf_sigma_px == 0.5 * whole.simulated_optics.psf_sigma_px
    corner = np.array([[-0.5, -0.5]])
    np.testing.assert_allclose(
        half.simulated_camera.rays(corner), whole.simulated_camera.rays(corner), rtol=1e-12
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            'mode = "manual"',
            "expected exposure.mode as one of 'schedule', 'auto', 'fixed' or 'table'",
        ),
        ('mode = "fixed"\nexposure_ms = 33.0', "expected exposure.exposure_ms below motion.pair_g"),
        ('mode = "auto"\nmax_ms = 40.0', "expected exposure.max_ms below motion.pair_gap_ms, 33"),
        (
            'mode = "auto"\nmin_ms = 2.0',
            "between exposure.min_ms and exposure.max_ms, got 1 with 2",
        ),
        ('mode = "auto"\npercentile = 101.0', "expected exposure.percentile from 1 to 100"),
        ("schedule_ms = [[0.0, 40.0]]", "and below motion.pair_gap_ms, 33 ms"),
        ("schedule_ms = [0.0, 40.0]", "expected exposure.schedule_ms.0 to be a list"),
        ("schedule_ms = [[1.0, 2.0]]\nmarker_fill = 0.5", "expected exposure.marker_fill as 0.6"),
    ],
)
def test_exposures_that_cannot_be_are_refused(tmp_path: Path, text: str, said: str) -> None:
    assert said in refusal(tmp_path, f'name = "x"\n[exposure]\n{text}')


# Identity


def leaves(table: dict[str, Any], place: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from leaves(value, (*place, key))
        elif value is not None:
            yield (*place, key)


def otherwise(value: Any) -> Any:
    """Return another value of the same kind, within every key's bounds."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return value * 0.99 + 0.001
    if isinstance(value, str):
        return OTHER_WORDS.get(value, value + "_other")
    if value and isinstance(value[0], float | list):
        return [otherwise(value[0]), *value[1:]]
    if value and isinstance(value[0], dict):
        return [{**value[0], "name": "another"}, *value[1:]]
    return value[:-1] if value else ["S1"]


ATTITUDES = {"q_target_from_icrs_wxyz"}  # an empty one is Earth-pointing
HALF_A_TURN = [0.0, 1.0, 0.0, 0.0]
OTHER_WORDS = {
    "S2": "S3",
    "schedule": "fixed",
    "poses": "approach",
    "pairs": "single",
    "stills": "interpolated",
    "2026-03-20T12:00:00Z": "2026-03-21T12:00:00Z",
}

# With every key there is, whether or not they go together; but those that only name a file.
PLAIN = Scenario.model_validate(
    {
        "name": "x",
        "tumble": TUMBLE,
        "camera": OWN_CAMERA | {"preset": "chaser_fixed", "fov_deg": 50.0, "rendered_width": 480},
        "motion": {
            "kind": "poses",
            "poses": "stills",
            "table": pose_lines(3),
            "epoch_utc": "2026-03-20T12:00:00Z",
        },
        "frame": {"kind": "pairs"},
        "markers": OWN_MARKERS,
        "told": every_difference(),
        "exposure": {"schedule_ms": [[0.0, 1.0]]},
    }
)


def with_another(place: tuple[str, ...]) -> Scenario:
    table = json.loads(PLAIN.model_dump_json())
    inner = table
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = otherwise(inner[place[-1]]) if place[-1] not in ATTITUDES else HALF_A_TURN
    return Scenario.model_validate(table)


# What is asked for has no default: it is left out unless it is typed.
PLACES = [place for place in leaves(json.loads(PLAIN.model_dump_json())) if place[0] != "asked"]


def test_the_list_of_keys_is_whole() -> None:
    """The tests below walk over every key; there are dozens, not a handful."""
    assert len(PLACES) > 120
    assert {("name",), ("motion", "rate_hz"), ("detector", "bits")} <= set(PLACES)


@pytest.mark.parametrize("place", PLACES, ids=".".join)
def test_the_fingerprint_knows_every_key_that_shapes_a_dataset(place: tuple[str, ...]) -> None:
    plain, other = PLAIN, with_another(place)
    assert other != plain
    assert (other.fingerprint() == plain.fingerprint()) == (place[0] in SHAPING_NOTHING)


@pytest.mark.parametrize("place", PLACES, ids=".".join)
def test_the_resolved_scenario_reads_back_to_the_last_digit(
    place: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "renders.scenario.scenario.check_scenario", lambda scenario, where: scenario
    )
    other = with_another(place)
    assert read_scenario(written(tmp_path, other.to_toml())) == other


@pytest.mark.parametrize("case", case_names())
def test_cases_survive_being_resolved_and_read_again(case: str, tmp_path: Path) -> None:
    scenario = resolve(replace(REQUEST, case=case, sun="0.1,-0.7,0.7"))
    again = read_scenario(written(tmp_path, scenario.to_toml()))
    assert again == scenario
    assert again.fingerprint() == scenario.fingerprint()


def test_a_resolved_scenario_spells_out_every_default() -> None:
    text = PLAIN.to_toml()
    for place in PLACES:
        assert f"{place[-1]} = " in text or f"[[{'.'.join(place)}]]" in text


def test_a_scenario_cannot_be_changed_in_place() -> None:
    scenario = check_scenario(Scenario(name="x"), "here")
    with pytest.raises(ValueError, match="frozen"):
        scenario.name = "y"  # type: ignore[misc]
