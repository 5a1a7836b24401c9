"""Read a specification of a random dataset, and refuse what could not be drawn."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from bench.random_dataset.spec_tables import Spec
from models.errors import ScenarioError, UnreadableError, cause
from models.lights.sun import unit_direction
from models.reading.toml_file import read_toml
from renders.scenario.camera_choice import camera_of, check_camera
from renders.scenario.camera_tables import check_lens
from renders.scenario.embedded_files import with_camera_read
from renders.scenario.errors import explain

SUM_TOLERANCE = 1e-6


def read_spec(path: Path) -> Spec:
    """Read a specification, and the cameras' files that it names.

    Raises
    ------
    ScenarioError
        If it is not TOML, has an unknown key, or says what cannot be; the message names file and
        key.
    """
    try:
        table: dict[str, Any] = read_toml(path)
    except UnreadableError as error:
        raise ScenarioError(
            f"{path}: expected a dataset's specification as TOML, got: {cause(error)}; "
            "`rvbench new dataset NAME` writes one"
        ) from error
    cameras = table.get("camera")
    if isinstance(cameras, list):
        table["camera"] = [with_camera_read(camera, path) for camera in cameras]
    try:
        spec = Spec(**table)
    except ValidationError as error:
        raise ScenarioError(explain(str(path), error, Spec, {})) from error
    return check_spec(spec, str(path))


def check_spec(spec: Spec, where: str) -> Spec:
    """Refuse what no single key can show.

    Raises
    ------
    ScenarioError
        The message names the keys.
    """
    spans: dict[str, tuple[float, float] | None] = {
        "pose.range_m": spec.pose.range_m,
        "sun.phase_deg": spec.sun.phase_deg,
        "exposure.exposure_ms": spec.exposure.exposure_ms,
        "vary.psf_sigma_px": spec.vary.psf_sigma_px,
        **{f"target.{n}.range_m": each.range_m for n, each in enumerate(spec.target)},
    }
    for key, span in spans.items():
        if span is not None and span[0] > span[1]:
            raise ScenarioError(
                f"{where}: expected {key} as least and most, got {list(span)}: "
                f"[{span[1]:g}, {span[0]:g}] may have been meant"
            )
    shares = (spec.split.train, spec.split.val, spec.split.test)
    if abs(sum(shares) - 1.0) > SUM_TOLERANCE:
        raise ScenarioError(
            f"{where}: expected split.train, val and test to add up to 1, got "
            f"{' + '.join(f'{share:g}' for share in shares)} = {sum(shares):g}"
        )
    back = spec.background
    if back.space + back.stars + back.earth <= 0.0:
        raise ScenarioError(
            f"{where}: expected one of background.space, stars and earth above 0, got none"
        )
    try:
        unit_direction(spec.pose.axis)
    except ScenarioError as error:
        raise ScenarioError(
            f"{where}: expected pose.axis of three numbers, not all zero, "
            f"got {list(spec.pose.axis)}"
        ) from error
    if "seed" in spec.render.model_fields_set:
        raise ScenarioError(
            f"{where}: expected render.seed to be left out, the dataset's seed draws it for each "
            f"folder; got {spec.render.seed}"
        )
    _check_names(spec, where)
    for table in spec.camera:
        check_camera(table, f"{where}: camera {table.name}")
        check_lens(lambda table=table: camera_of(table), f"{where}: camera {table.name}")  # type: ignore[misc]
    return spec


def differences(there: dict[str, Any], asked: dict[str, Any], within: str = "") -> list[str]:
    """Return in words what differs between two specifications' tables, key by key.

    Parameters
    ----------
    there, asked : dict
        As ``Spec.model_dump`` gives them.
    within : str
        Where they stand.
    """
    found = []
    for key in dict.fromkeys([*there, *asked]):
        old, new = there.get(key), asked.get(key)
        if old == new:
            continue
        if isinstance(old, dict) and isinstance(new, dict):
            found += differences(old, new, f"{within}{key}.")
        elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
            pairs = zip(map(_as_table, old), map(_as_table, new), strict=True)
            for number, (one, other) in enumerate(pairs):
                found += differences(one, other, f"{within}{key}.{number}.")
        else:
            found.append(f"{within}{key}".removesuffix(".") + f" is {old!r}, now {new!r}")
    return found


def _as_table(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {"": value}


def _check_names(spec: Spec, where: str) -> None:
    for key, names in (
        ("camera", [camera.name for camera in spec.camera]),
        ("target", [target.spacecraft for target in spec.target]),
    ):
        name, count = Counter(name.lower() for name in names).most_common(1)[0]
        if count > 1:
            told = "name" if key == "camera" else "spacecraft"
            raise ScenarioError(
                f"{where}: expected each [[{key}]] with a {told} of its own, got {name!r} "
                f"{count} times"
            )
