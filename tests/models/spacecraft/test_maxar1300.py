"""The Maxar-1300's sizes, names, outward faces, and free lines of sight to its markers."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest
import trimesh

from models.arrays import Floats
from models.materials import MATERIALS
from models.spacecraft import (
    bus,
    launch_adaptor_ring,
    marker_support,
    mirror_panel,
    offset_reflector,
    solids,
)
from models.spacecraft.maxar1300 import maxar1300
from models.spacecraft.part import Spacecraft
from models.spacecraft.retroreflector_layout import RETROREFLECTORS

TRIANGLES = 300_000  # what a render may cost
# Surfaces that are sheets: foil, tape, glass on its substrate, mirrors, and a dish's two skins.
SHEETS = {
    "mli_gold",
    "mli_aluminium",
    "solar_cell",
    "solar_interconnect",
    "optical_solar_reflector",
}
DISHES = {"reflector_plus_x", "reflector_minus_x"}
NAMED_IN_THE_ISSUE = {
    "launch_adaptor_ring",
    "apogee_engine",
    "mli_blanket",
    "solar_wing_plus_y",
    "solar_wing_minus_y",
    "yoke_plus_y",
    "yoke_minus_y",
    "reflector_plus_x",
    "reflector_minus_x",
    "reflector_arm_plus_x",
    "feed_plus_x",
    "feed_minus_x",
    "marker_supports",
    "thrusters",
    "radiator_plus_y",
    "radiator_minus_y",
    "earth_deck",
}


@pytest.fixture(scope="module")
def craft() -> Spacecraft:
    return maxar1300()


def vertices_of(craft: Spacecraft, *names: str) -> Floats:
    return np.concatenate([np.asarray(p.mesh.vertices) for p in craft.parts if p.name in names])


def hits(craft: Spacecraft, starts: Floats, ends: Floats) -> Floats:
    """Return the share of each segment, (n,), at which it first meets a part; inf for none.

    Moller and Trumbore 1997, over the triangles whose boxes meet the segments' common box.
    """
    corners = np.concatenate([np.asarray(p.mesh.triangles) for p in craft.parts])
    low = np.minimum(starts, ends).min(axis=0)
    high = np.maximum(starts, ends).max(axis=0)
    near = ((corners.max(axis=1) >= low) & (corners.min(axis=1) <= high)).all(axis=1)
    a, b, c = np.moveaxis(corners[near], 1, 0)
    along_b, along_c = b - a, c - a
    first = np.full(len(starts), np.inf)
    for index, (start, step) in enumerate(zip(starts, ends - starts, strict=True)):
        p = np.cross(step, along_c)
        determinant = (along_b * p).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            offset = start - a
            u = (offset * p).sum(axis=1) / determinant
            q = np.cross(offset, along_b)
            v = (q @ step) / determinant
            t = (along_c * q).sum(axis=1) / determinant
            met = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0) & (t < 1.0)
        first[index] = t[met].min(initial=np.inf)
    return first


def bodies_of(meshes: list[trimesh.Trimesh]) -> list[trimesh.Trimesh]:
    """Weld the vertices that meet and return the connected bodies."""
    whole = trimesh.util.concatenate([mesh.copy() for mesh in meshes])
    whole.merge_vertices(digits_vertex=8)
    return list(whole.split(only_watertight=False))


def test_bus_has_the_size_of_its_class(craft: Spacecraft) -> None:
    box = vertices_of(craft, "bus_structure", "mli_blanket")
    size = box.max(axis=0) - box.min(axis=0)
    bulge = 2.0 * max(blanket.max_height_m for blanket, _, _ in bus.blankets())
    assert (size >= [2.4, 2.4, 3.6]).all()
    assert (size <= np.array([2.4, 2.4, 3.6]) + bulge).all()
    assert bulge < 0.08  # or it would be a tent
    assert box[:, 2].max() < 0.0


def test_ring_lies_in_the_plane_of_the_target_frame(craft: Spacecraft) -> None:
    ring = vertices_of(craft, "launch_adaptor_ring")
    assert ring[:, 2].max() == 0.0
    edge = ring[ring[:, 2] > -launch_adaptor_ring.LIP_M - 1e-9]
    assert np.hypot(*edge[:, :2].T).max() == pytest.approx(0.83, abs=1e-9)
    assert np.allclose(edge.mean(axis=0)[:2], 0.0, atol=1e-9)
    assert 0.10 <= -bus.FACE_Z_M <= 0.20


def test_apogee_engine_stands_inside_the_ring(craft: Spacecraft) -> None:
    engine = vertices_of(craft, "apogee_engine")
    assert engine[:, 2].max() < 0.0
    assert np.hypot(*engine[:, :2].T).max() < 0.3


def test_wings_span_that_of_a_1300(craft: Spacecraft) -> None:
    low, high = craft.bounds
    assert 26.0 <= high[1] - low[1] <= 31.0
    for sign, name in ((1.0, "solar_wing_plus_y"), (-1.0, "solar_wing_minus_y")):
        assert (sign * vertices_of(craft, name)[:, 1] > 0.5 * bus.WIDTH_M).all()


@pytest.mark.parametrize("side", ["plus_x", "minus_x"])
def test_reflector_sends_a_beam_from_earth_into_its_feed(craft: Spacecraft, side: str) -> None:
    sign = 1.0 if side == "plus_x" else -1.0
    focus = offset_reflector.DISH.focus * [sign, 1.0, 1.0]
    (face,) = [
        p.mesh for p in craft.parts if p.name == f"reflector_{side}" and p.material == "white_paint"
    ]
    size = face.bounds[1] - face.bounds[0]
    assert 2.0 <= size[0] <= 2.4
    assert (face.face_normals[:, 2] < 0.0).all()
    incoming = np.array([0.0, 0.0, 1.0])
    normals, middles = face.face_normals, face.triangles_center
    reflected = incoming - 2.0 * (normals @ incoming)[:, None] * normals
    to_focus = focus - middles
    miss = np.linalg.norm(np.cross(to_focus, reflected), axis=1)
    # A flat facet of 8 by 10 cm on a paraboloid of radius 3.8 m leans up to 0.6 degrees from it.
    assert (
        np.percentile(miss, 95.0) < 2.0 * np.deg2rad(0.6) * np.linalg.norm(to_focus, axis=1).max()
    )
    assert (
        np.linalg.norm((to_focus / np.linalg.norm(to_focus, axis=1)[:, None] - reflected).mean(0))
        < 5e-3
    )


def test_has_the_parts_an_engineer_looks_for(craft: Spacecraft) -> None:
    assert set(craft.part_names) >= NAMED_IN_THE_ISSUE
    assert len(craft.part_names) < 255  # labels are bytes and 0 is space


def test_every_part_has_a_known_material(craft: Spacecraft) -> None:
    assert {part.material for part in craft.parts} <= set(MATERIALS)


def test_stays_within_the_triangle_budget(craft: Spacecraft) -> None:
    assert sum(len(part.mesh.faces) for part in craft.parts) <= TRIANGLES


def test_no_triangle_is_degenerate(craft: Spacecraft) -> None:
    for part in craft.parts:
        assert np.isfinite(part.mesh.vertices).all(), part.name
        assert part.mesh.area_faces.min() > 1e-8, part.name


def test_bodies_are_closed_and_face_outward(craft: Spacecraft) -> None:
    for part in craft.parts:
        if part.material in SHEETS or part.name in DISHES:
            continue
        for body in bodies_of([part.mesh]):
            assert body.is_watertight, part.name
            assert body.volume > 0.0, part.name


@pytest.mark.parametrize("name", sorted(DISHES))
def test_dish_is_one_closed_shell(craft: Spacecraft, name: str) -> None:
    skins = bodies_of([part.mesh for part in craft.parts if part.name == name and part.smooth])
    assert len(skins) == 1
    assert skins[0].is_watertight
    area = 0.25 * np.pi * offset_reflector.DIAMETER_M**2
    assert skins[0].volume == pytest.approx(area * offset_reflector.SHELL_M, rel=0.01)


def test_foil_faces_outward_on_all_six_sides(craft: Spacecraft) -> None:
    half = 0.5 * np.array([bus.WIDTH_M, bus.WIDTH_M, bus.LENGTH_M])
    middle = np.array([0.0, 0.0, bus.FACE_Z_M - half[2]])
    foil = solids.joined(part.mesh for part in craft.parts if part.name == "mli_blanket")
    outward = (foil.triangles_center - middle) / half
    side = np.abs(outward).argmax(axis=1)
    row = np.arange(len(side))
    assert (foil.face_normals[row, side] * outward[row, side] > 0.0).all()
    assert set(zip(side, outward[row, side] > 0.0, strict=True)) == {
        (axis, positive) for axis in range(3) for positive in (False, True)
    }


def test_outer_foils_are_film_and_metal(craft: Spacecraft) -> None:
    blankets = {p.material for p in craft.parts if p.name == "mli_blanket"}
    assert blankets == {"mli_gold", "mli_aluminium"}
    assert all(p.smooth for p in craft.parts if p.name == "mli_blanket")


def test_buttons_stand_on_foil_that_they_clip_down(craft: Spacecraft) -> None:
    (buttons,) = [part.mesh for part in craft.parts if part.name == "mli_buttons"]
    foil = vertices_of(craft, "mli_blanket")
    for body in bodies_of([buttons]):
        low, high = body.bounds
        under = foil[((foil >= low - 1e-9) & (foil <= high + 1e-9)).sum(axis=1) >= 2]
        near = np.linalg.norm(under - 0.5 * (low + high), axis=1) < bus.BUTTON_RADIUS_M
        # Half of its thickness below the button's middle is where the panel holds the foil.
        inside = np.linalg.norm(under[near] - 0.5 * (low + high), axis=1)
        assert (inside >= 0.5 * bus.BUTTON_M - 1e-9).all()


def test_cells_and_heat_shield_face_the_chaser(craft: Spacecraft) -> None:
    for part in craft.parts:
        if part.material in {"solar_cell", "solar_interconnect"} and "wing" in part.name:
            assert (part.mesh.face_normals[:, 2] > 0.999).all()
    shield = next(part.mesh for part in craft.parts if part.name == "heat_shield")
    assert (shield.face_normals[:, 2] > 0.0).all()


def test_radiator_mirrors_face_outward(craft: Spacecraft) -> None:
    for sign, name in ((1.0, "radiator_plus_y"), (-1.0, "radiator_minus_y")):
        for part in craft.parts:
            if part.name == name and part.material == "optical_solar_reflector":
                lean = part.mesh.face_normals @ [0.0, sign, 0.0]
                # Each of the two tilts is cut off at 2.5 standard deviations.
                assert lean.min() > np.cos(np.deg2rad(2.5 * 1.42 * mirror_panel.TILE_TILT_DEG))
                assert lean.max() < 1.0


def test_is_built_the_same_every_time() -> None:
    def digest(craft: Spacecraft) -> str:
        state = hashlib.sha256()
        for part in craft.parts:
            state.update(part.name.encode() + part.material.encode())
            state.update(np.asarray(part.mesh.vertices).tobytes())
            state.update(np.asarray(part.mesh.faces).tobytes())
        return state.hexdigest()

    assert digest(maxar1300.__wrapped__()) == digest(maxar1300())


def test_every_marker_stands_a_millimetre_proud_of_a_black_plate(craft: Spacecraft) -> None:
    centres, normals = RETROREFLECTORS.points_in_target, RETROREFLECTORS.normals_in_target
    depth_m = 0.01 * hits(craft, centres, centres - 0.01 * normals)
    assert np.allclose(depth_m, marker_support.FACE_PROUD_M, atol=1e-9)
    parts = [part for part in craft.parts if part.name == "marker_supports"]
    assert [part.material for part in parts] == ["black_paint", "anodised_aluminium"]
    bezels = np.asarray(parts[1].mesh.vertices)
    away = np.linalg.norm(bezels[:, None] - centres, axis=2).min(axis=1)
    assert (away > RETROREFLECTORS.radius_m).all()  # none lies over a face
    assert (marker_support.plate_radii(RETROREFLECTORS) > RETROREFLECTORS.radius_m).all()


def test_foil_pokes_through_neither_supports_nor_ring(craft: Spacecraft) -> None:
    foil = vertices_of(craft, "mli_blanket", "mli_tape")
    side = 0.5 * marker_support.BASE_M
    for x, y, _ in RETROREFLECTORS.points_in_target:
        under = foil[(np.abs(foil[:, 0] - x) <= side) & (np.abs(foil[:, 1] - y) <= side)]
        top = under[under[:, 2] > bus.EARTH_FACE_Z_M + 1.0, 2]
        assert (top <= bus.FACE_Z_M + marker_support.BASE_LIFT_M).all()
    at_ring = np.hypot(*foil[:, :2].T) < bus.RING_CUTOUT_M + 0.002
    front = foil[at_ring & (foil[:, 2] > -0.5), 2]
    assert (front <= bus.FACE_Z_M + launch_adaptor_ring.FOOT_M).all()


@pytest.mark.parametrize("range_m", [6.7, 4.0, 2.5, 1.8])
def test_nothing_stands_between_camera_and_markers(craft: Spacecraft, range_m: float) -> None:
    # The aim wanders up to 0.27 m towards -x in the approach, and the pose by 2 degrees.
    markers = RETROREFLECTORS
    aim = markers.points_in_target.mean(axis=0)
    wander = range_m * np.tan(np.deg2rad(2.0))
    angle = 2.0 * np.pi * np.arange(8) / 8
    rim = markers.radius_m * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(8)])
    faces = np.concatenate(
        [markers.points_in_target[:, None] + rim, markers.points_in_target[:, None]], axis=1
    )
    faces = faces.reshape(-1, 3)
    for dx, dy in ((0.0, 0.0), (-0.27, 0.0), (wander, wander), (-0.27 - wander, -wander)):
        camera = np.broadcast_to([aim[0] + dx, aim[1] + dy, range_m], faces.shape)
        assert np.isinf(hits(craft, faces, camera)).all()


def test_markers_see_free_sky_up_to_45_degrees(craft: Spacecraft) -> None:
    polar, azimuth = np.meshgrid(
        np.deg2rad([0.0, 15.0, 25.0, 35.0, 40.0, 44.9]), np.deg2rad(np.arange(0, 360, 5))
    )
    sky = np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1
    ).reshape(-1, 3)
    for point in RETROREFLECTORS.points_in_target:
        start = np.broadcast_to(point, sky.shape)
        assert np.isinf(hits(craft, start, start + 10.0 * sky)).all()


def test_nothing_rises_above_a_marker_within_15_cm(craft: Spacecraft) -> None:
    everything = np.concatenate([np.asarray(part.mesh.vertices) for part in craft.parts])
    for point in RETROREFLECTORS.points_in_target:
        near = np.hypot(*(everything[:, :2] - point[:2]).T) < 0.15
        assert everything[near, 2].max() <= point[2]


def test_a_wide_plate_would_shade_its_lower_neighbour() -> None:
    # The rule for plates is the geometry of 45 degrees: the mast of #10 bites, the others do not.
    widths = dict(
        zip(RETROREFLECTORS.names, marker_support.plate_radii(RETROREFLECTORS), strict=True)
    )
    assert widths["10"] < marker_support.PLATE_RADIUS_M
    assert {widths[name] for name in widths if name != "10"} == {marker_support.PLATE_RADIUS_M}
