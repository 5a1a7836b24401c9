"""A spacecraft, its markers and the chaser as Mitsuba geometry, in the target frame.

The target never moves, so its acceleration structure is built once; the chaser, which casts the
shadow, is put in its place for each exposure. Lights are not part of the geometry: the JIT
integrator samples light groups itself, and the scalar one adds emitters of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import Floats
from models.markers import MarkerPattern
from models.materials import MATERIALS
from models.pose import RigidTransform
from models.spacecraft.corner_cube import face_axes
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from models.spacecraft.stance import BODY_ALONE, Stance
from models.surface_detail import PLAIN
from renders.tracing.surfaces import DiscPlace, Surface, bsdf_dict, surface_of, surface_of_disc
from renders.truth.part_names import CHASER_LABEL, MARKER_LABEL

if TYPE_CHECKING:
    import trimesh

    from renders.tracing.surface_table import SurfaceTable

DISC_CORNERS = 256  # of the polygon that stands for a retroreflector's circle


@dataclass(eq=False)
class SceneGeometry:
    """Shapes ready to be loaded, and what each of them is.

    Attributes
    ----------
    shapes : dict
        Mitsuba shapes by key; pass them to ``mi.load_dict`` with ``optimize=False``.
    labels : tuple of str
        Name of label k + 1; 0 is empty space.
    label_of_shape : dict
        Label by shape key.
    surface_of_shape : dict
        What each shape returns, by its key.
    chaser_parts : dict
        The chaser's parts, in their own frames, by shape key.
    chaser_in_cam : dict
        Vertices of each chaser mesh in the camera's axes, m, by shape key; see ``take``.
    discs : MarkerPattern or None
        The retroreflectors among the shapes.
    optics : RetroreflectorOptics
        What they return. As Mitsuba's BSDFs their shapes carry the front face alone; in scalar
        variants ``renders.tracing.marker_lobes`` adds the rest.
    """

    shapes: dict[str, Any]
    labels: tuple[str, ...]
    label_of_shape: dict[str, int]
    surface_of_shape: dict[str, Surface]
    chaser_parts: dict[str, Part] = field(default_factory=dict)
    chaser_in_cam: dict[str, Floats] = field(default_factory=dict, init=False)
    discs: MarkerPattern | None = None
    optics: RetroreflectorOptics = RetroreflectorOptics()  # noqa: RUF009 - frozen

    def __post_init__(self) -> None:
        if not any(part.frame for part in self.chaser_parts.values()):
            self.take(BODY_ALONE)

    def take(self, stance: Stance) -> None:
        """Let the chaser stand as told; ``place_chaser`` then moves it in a scene."""
        self.chaser_in_cam = {key: stance.corners(part) for key, part in self.chaser_parts.items()}

    @property
    def disc_keys(self) -> list[str]:
        """Keys of the retroreflectors' shapes."""
        return [] if self.discs is None else [f"marker_{name}" for name in self.discs.names]

    def scene(self, **emitters: Any) -> Any:
        """Load a scene of these shapes, with emitters if any."""
        return mi.load_dict({"type": "scene", **self.shapes, **emitters}, optimize=False)

    @cached_property
    def surfaces(self) -> SurfaceTable:
        """What every shape returns, as the one-pass kernel reads it (JIT variants)."""
        from renders.tracing.surface_table import SurfaceTable

        distinct = list(dict.fromkeys(self.surface_of_shape.values()))
        return SurfaceTable(
            distinct,
            {
                jit_number(shape): distinct.index(self.surface_of_shape[key])
                for key, shape in self.shapes.items()
            },
        )

    def shape_labels(self, scene: Any) -> dict[int, int]:
        """Return the label by the number that the ``shape_index`` AOV gives a shape."""
        numbers = {}
        for order, shape in enumerate(scene.shapes(), start=1):
            number = order
            if dr.is_jit_v(mi.Float):
                number = jit_number(shape)
            numbers[number] = self.label_of_shape[shape.id()]
        return numbers


def jit_number(shape: Any) -> int:
    """Return the number by which a JIT variant's kernels know a shape."""
    return int(dr.reinterpret_array(mi.UInt32, mi.ShapePtr(shape))[0])


def mitsuba_mesh(key: str, mesh: trimesh.Trimesh, bsdf: Any, smooth: bool) -> Any:
    """Turn a trimesh mesh into a Mitsuba mesh, in any variant.

    Parameters
    ----------
    key : str
        The shape's name.
    mesh : trimesh.Trimesh
        In m.
    bsdf : Mitsuba BSDF
    smooth : bool
        Whether normals are interpolated.
    """
    props = mi.Properties()
    props["mesh_bsdf"] = bsdf
    if not smooth:
        props["face_normals"] = True
    shape = mi.Mesh(key, len(mesh.vertices), len(mesh.faces), props, smooth, False)
    params = mi.traverse(shape)
    params["vertex_positions"] = np.ravel(mesh.vertices).astype(np.float32)
    params["faces"] = np.ravel(mesh.faces).astype(np.uint32)
    if smooth:
        params["vertex_normals"] = np.ravel(mesh.vertex_normals).astype(np.float32)
    params.update()
    return shape


def marker_transform(point: Floats, normal: Floats, radius_m: float) -> Floats:
    """Return the (4, 4) matrix that makes a unit disc in the plane z = 0 a marker's face.

    Parameters
    ----------
    point : (3,) array, m
        The disc's centre, target frame.
    normal : (3,) array
        Of any length.
    radius_m : float, m
    """
    along, across = face_axes(normal)
    outward = normal / np.linalg.norm(normal)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([along, across, outward], axis=1) * radius_m
    matrix[:3, 3] = point
    return matrix


def disc_place(point: Floats, normal: Floats, radius_m: float) -> DiscPlace:
    """Return where a marker's disc lies, with the axes of ``marker_transform``.

    Parameters
    ----------
    point : (3,) array, m
        The disc's centre, target frame.
    normal : (3,) array
        Of any length.
    radius_m : float, m
    """
    matrix = marker_transform(point, normal, radius_m)
    along, across = (tuple(float(x) for x in matrix[:3, k] / radius_m) for k in range(2))
    centre = tuple(float(x) for x in point)
    return DiscPlace(centre, along, across, float(radius_m))  # type: ignore[arg-type]


def disc_mesh(point: Floats, normal: Floats, radius_m: float) -> trimesh.Trimesh:
    """Return a marker's face as a polygon of its area, with its normal.

    Mitsuba's own disk would do, but one shape that is no mesh makes Embree walk a second tree for
    every ray: 40 % of the time of a scene under many Suns. The polygon's rim is within 6e-5 of the
    circle's radius.

    Parameters
    ----------
    point : (3,) array, m
        The disc's centre, target frame.
    normal : (3,) array
        Of any length.
    radius_m : float, m
    """
    import trimesh

    angles = 2.0 * np.pi * np.arange(DISC_CORNERS) / DISC_CORNERS
    corner = 1.0 / np.sqrt(np.sinc(2.0 / DISC_CORNERS))
    rim = corner * np.stack([np.cos(angles), np.sin(angles), np.zeros(DISC_CORNERS)], axis=1)
    number = np.arange(1, DISC_CORNERS + 1)
    fan = np.stack([np.zeros_like(number), number, number % DISC_CORNERS + 1], axis=1)
    mesh = trimesh.Trimesh(np.vstack([np.zeros(3), rim]), fan, process=False)
    mesh.apply_transform(marker_transform(point, normal, radius_m))
    return mesh


def _merged(parts: tuple[Part, ...]) -> list[Part]:
    """Join the meshes of parts that share name, material, shading and frame."""
    import trimesh

    groups: dict[tuple[str, str, bool, int], list[trimesh.Trimesh]] = {}
    for part in parts:
        key = (part.name, part.material, part.smooth, part.frame)
        groups.setdefault(key, []).append(part.mesh)
    joined = {
        key: each[0] if len(each) == 1 else trimesh.util.concatenate(each)
        for key, each in groups.items()
    }
    return [
        Part(name, mesh, material, smooth, frame)
        for (name, material, smooth, frame), mesh in joined.items()
    ]


def build_geometry(
    target: Spacecraft,
    chaser: Spacecraft | None,
    optics: RetroreflectorOptics,
    installed: MarkerPattern | None = None,
) -> SceneGeometry:
    """Turn spacecraft into Mitsuba shapes.

    Parameters
    ----------
    target : Spacecraft
        In the target frame.
    chaser : Spacecraft or None
        In the camera's frame; it only casts shadows and scatters light.
    optics : RetroreflectorOptics
    installed : MarkerPattern, optional
        Where the markers really are; the target's own pattern by default.
    """
    labels = (*target.part_names, MARKER_LABEL, CHASER_LABEL)
    surface_of_material = {
        part.material: surface_of(craft.material_of(part))
        for craft in (target, chaser)
        if craft
        for part in craft.parts
    }
    bsdfs = {name: mi.load_dict(bsdf_dict(s)) for name, s in sorted(surface_of_material.items())}
    shapes: dict[str, Any] = {}
    label_of_shape: dict[str, int] = {}
    surface_of_shape: dict[str, Surface] = {}
    chaser_parts: dict[str, Part] = {}
    for number, part in enumerate(_merged(target.parts)):
        key = f"target_{number:03d}"
        shapes[key] = mitsuba_mesh(key, part.mesh, bsdfs[part.material], part.smooth)
        label_of_shape[key] = labels.index(part.name) + 1
        surface_of_shape[key] = surface_of_material[part.material]
    markers = installed if installed is not None else target.markers
    if markers is not None:
        painted = _painted(target, markers)
        face = mi.load_dict(bsdf_dict(painted or surface_of_disc(optics)))
        for name, point, normal in zip(
            markers.names, markers.points_in_target, markers.normals_in_target, strict=True
        ):
            key = f"marker_{name}"
            mesh = disc_mesh(point, normal, markers.radius_m)
            shapes[key] = mitsuba_mesh(key, mesh, face, smooth=False)
            label_of_shape[key] = labels.index(MARKER_LABEL) + 1
            place = disc_place(point, normal, markers.radius_m)
            surface_of_shape[key] = painted or surface_of_disc(optics, place)
    if chaser is not None:
        for number, part in enumerate(_merged(chaser.parts)):
            key = f"chaser_{number:03d}"
            shapes[key] = mitsuba_mesh(key, part.mesh, bsdfs[part.material], part.smooth)
            label_of_shape[key] = labels.index(CHASER_LABEL) + 1
            # It moves in the target's frame, in which detail stands still.
            surface_of_shape[key] = replace(surface_of_material[part.material], detail=PLAIN)
            chaser_parts[key] = part
    return SceneGeometry(
        shapes, labels, label_of_shape, surface_of_shape, chaser_parts, markers, optics
    )


def _painted(target: Spacecraft, markers: MarkerPattern) -> Surface | None:
    """Return what painted dots return; None of retroreflectors."""
    if not markers.paint:
        return None
    paint = target.materials.get(markers.paint) or MATERIALS[markers.paint]
    return replace(surface_of(paint), two_sided=False)


def place_chaser(scene: Any, geometry: SceneGeometry, cam_from_target: RigidTransform) -> None:
    """Move the chaser so that its camera stands where ``cam_from_target`` says.

    One whose parts move in each other has to ``take`` its stance first.

    Parameters
    ----------
    scene : Mitsuba scene
        Of these shapes; changed in place.
    geometry : SceneGeometry
    cam_from_target : RigidTransform
    """
    if not geometry.chaser_in_cam:
        return
    target_from_cam = cam_from_target.inverse()
    params = mi.traverse(scene)
    for key, vertices in geometry.chaser_in_cam.items():
        moved = target_from_cam @ vertices
        params[f"{key}.vertex_positions"] = np.ravel(moved).astype(np.float32)
    params.update()
