"""What is wrong with a mesh, and what to do about each: measured, never guessed from its name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from models.arrays import Floats
from models.spacecraft.own.build import MOST_PART_NAMES
from models.spacecraft.own.description import UNITS_M
from models.spacecraft.own.mesh_file import IN_METRES, MeshFile
from models.spacecraft.own.welded import Welded, welded

LARGE_M, SMALL_M = 110.0, 0.05  # the largest station, a picosatellite
MANY_FACES, MANY_PARTS = 1_000_000, 200
OFF_HULL_SHARE = 1e-6  # of the size
LIKELY_M = 60.0  # the most of a spacecraft whose mesh is in metres; beyond, it is the first
GUESSED = ("mm", "m", "cm", "in")  # of these that gives a possible size


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong, or that one should know.

    Attributes
    ----------
    kind : str
        ``mend``: pictures or motion will be wrong; ``know``: they may not be what one expects.
    what, todo : str
        ``todo`` is empty where there is nothing to be done.
    """

    kind: Literal["mend", "know"]
    what: str
    todo: str


@dataclass(frozen=True, eq=False)
class Surface:
    """The surface of a whole mesh in numbers.

    Attributes
    ----------
    faces, points, bodies : int
        Once welded.
    degenerate, twice : int
        Faces without area; faces that lie on another.
    rims : int
        Edges with one face.
    open_bodies : int
        Bodies that have such.
    shared_by_many : int
        Edges with three faces or more.
    inconsistent : int
        Edges whose two faces look to opposite sides.
    inside_out : int
        Closed bodies whose faces look inwards.
    """

    faces: int
    points: int
    bodies: int
    degenerate: int
    twice: int
    rims: int
    open_bodies: int
    shared_by_many: int
    inconsistent: int
    inside_out: int

    @classmethod
    def of(cls, mesh: MeshFile) -> Surface:
        """Measure a mesh, each of its pieces welded by itself."""
        total: dict[str, int] = dict.fromkeys(cls.__dataclass_fields__, 0)
        for piece in mesh.pieces:
            for name, count in _counts(welded(piece.triangles)).items():
                total[name] += count
        return cls(**total)


def _counts(body: Welded) -> Mapping[str, int]:
    if not len(body.faces):
        return MappingProxyType({"degenerate": body.degenerate, "twice": body.twice})
    edges, bodies = body.edges, body.bodies
    count = int(bodies.max()) + 1
    rim = np.zeros(count, dtype=bool)
    rim[bodies[edges.first[edges.count == 1]]] = True
    strange = np.zeros(count, dtype=bool)
    strange[bodies[edges.first[(edges.count > 2) | ((edges.count == 2) & ~edges.against)]]] = True
    a, b, c = np.moveaxis(body.points[body.faces] - body.points.mean(axis=0), 1, 0)
    volume = np.bincount(bodies, np.einsum("fi,fi->f", a, np.cross(b, c)), minlength=count)
    return {
        "faces": len(body.faces),
        "points": len(body.points),
        "bodies": count,
        "degenerate": body.degenerate,
        "twice": body.twice,
        "rims": int((edges.count == 1).sum()),
        "open_bodies": int(rim.sum()),
        "shared_by_many": int((edges.count > 2).sum()),
        "inconsistent": int(((edges.count == 2) & ~edges.against).sum()),
        "inside_out": int((~rim & ~strange & (volume < 0.0)).sum()),
    }


def size_of(mesh: MeshFile) -> Floats:
    """Return the sides of a mesh's box, (3,), in its own unit."""
    return np.asarray(np.ptp(mesh.vertices, axis=0))


def guessed_unit(mesh: MeshFile) -> str:
    """Return the unit in which a mesh is most likely of a spacecraft's size."""
    if mesh.path.suffix.lower() in IN_METRES:
        return "m"
    largest = float(size_of(mesh).max())
    if largest <= LIKELY_M:
        return "m"
    possible = [unit for unit in GUESSED if SMALL_M <= UNITS_M[unit] * largest <= LARGE_M]
    return [*possible, "m"][0]


def faults_of(
    mesh: MeshFile,
    surface: Surface,
    *,
    unit: str | None,
    centre_of_mass_in_mesh_m: Floats | None = None,
) -> list[Fault]:
    """Return what is wrong with a mesh, the worst first.

    Parameters
    ----------
    mesh : MeshFile
    surface : Surface
        Of it.
    unit : str or None
        None: nobody has told it.
    centre_of_mass_in_mesh_m : (3,) array, optional, m
        As told.
    """
    found = [
        *_of_size(mesh, unit),
        *_of_surface(surface),
        *_of_contents(mesh, surface),
        *_of_mass(mesh, unit, centre_of_mass_in_mesh_m),
    ]
    return sorted(found, key=lambda fault: fault.kind != "mend")


def _of_size(mesh: MeshFile, unit: str | None) -> Iterator[Fault]:
    size = size_of(mesh)
    if unit is None and mesh.path.suffix.lower() not in IN_METRES:
        guess = guessed_unit(mesh)
        sides = " x ".join(f"{side:.3g}" for side in UNITS_M[guess] * size)
        yield Fault(
            "mend",
            f"no unit: {mesh.path.suffix} files do not say what one is; it is "
            f"{' x '.join(f'{side:.4g}' for side in size)} of them",
            f'say unit = "..."; "{guess}", which makes it {sides} m, is our guess',
        )
    largest = float(size.max()) * UNITS_M[unit or guessed_unit(mesh)]
    if not SMALL_M <= largest <= LARGE_M:
        yield Fault(
            "mend",
            f"absurd size: {largest:.3g} m at its longest",
            f"say another unit, one of {', '.join(UNITS_M)}",
        )


def _of_surface(surface: Surface) -> Iterator[Fault]:
    if surface.rims:
        yield Fault(
            "know",
            f"open: {surface.open_bodies} of {surface.bodies} bodies, with {surface.rims} edges of "
            "one face",
            "sheets, such as solar panels, may be: both sides are rendered; close other holes "
            "where it was made, for light gets in",
        )
    if surface.inside_out:
        yield Fault(
            "know",
            f"inverted: {surface.inside_out} closed bodies whose faces look inwards",
            "they are turned when read",
        )
    if surface.inconsistent:
        yield Fault(
            "mend",
            f"inverted: {surface.inconsistent} edges between faces that look to opposite sides",
            "make the normals consistent where it was made; curved surfaces are shaded flat there",
        )
    if surface.shared_by_many:
        yield Fault(
            "know",
            f"not a surface: {surface.shared_by_many} edges with three faces or more",
            "corners and edges are found there all the same",
        )
    if surface.twice:
        yield Fault(
            "know",
            f"duplicate: {surface.twice} faces that lie on another",
            "one of each is kept",
        )
    if surface.degenerate:
        yield Fault(
            "know",
            f"degenerate: {surface.degenerate} faces without area",
            "they are left out",
        )


def _of_contents(mesh: MeshFile, surface: Surface) -> Iterator[Fault]:
    names = len({piece.name for piece in mesh.pieces})
    if names > MANY_PARTS:
        yield Fault(
            "know",
            f"{names} parts, each with a name",
            f"names are shortened until at most {MOST_PART_NAMES} are left; join parts of one "
            "material where it was made, if you want to name them",
        )
    if surface.faces > MANY_FACES:
        yield Fault(
            "know",
            f"{surface.faces} faces",
            "a coarser mesh starts sooner, and takes less memory",
        )
    for name in mesh.missing[:10]:
        yield Fault(
            "mend",
            f"missing: {name}, which the mesh names",
            "copy it beside the mesh, or give its parts materials in the TOML",
        )
    transparent = sorted({piece.name for piece in mesh.pieces if piece.look.transparent})
    if transparent:
        yield Fault(
            "know",
            f"transparent: {', '.join(transparent[:5])}",
            "it is rendered as if it were solid",
        )
    for note in mesh.notes:
        yield Fault("know", f"left out: {note}", "")


def _of_mass(mesh: MeshFile, unit: str | None, told: Floats | None) -> Iterator[Fault]:
    if told is None or unit is None:
        return
    points = UNITS_M[unit] * mesh.vertices
    outside = bool((told < points.min(axis=0)).any() or (told > points.max(axis=0)).any())
    try:
        planes = ConvexHull(points).equations
        size = float(np.ptp(points, axis=0).max())
        outside |= bool((planes[:, :3] @ told + planes[:, 3]).max() > OFF_HULL_SHARE * size)
    except QhullError:  # flat
        pass
    if outside:
        where = ", ".join(f"{x:.3g}" for x in told)
        yield Fault(
            "mend",
            f"centre of mass outside: ({where}) m, in the mesh's axes, lies beyond its hull",
            "say it in the axes of the mesh file, in m; perhaps its unit is another",
        )
