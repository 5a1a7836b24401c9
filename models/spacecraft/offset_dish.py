"""An offset paraboloidal dish: a face that looks along -z of its own frame, a back, and ribs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh

from models.arrays import Floats
from models.spacecraft.solids import cylinder, joined, mesh_of, placed, standing, tube

RINGS, SPOKES = 14, 72


@dataclass(frozen=True)
class OffsetDish:
    """The sizes of a dish; the parent paraboloid's axis runs along z at y = 0.

    Attributes
    ----------
    diameter_m, focal_length_m : float, m
        Diameter seen along the axis.
    axis_x_m, vertex_z_m : float, m
        Where the parent's axis and vertex lie.
    clearance_m : float, m
        From the axis to the dish's inner edge.
    shell_m : float, m
        Thickness.
    """

    diameter_m: float
    focal_length_m: float
    axis_x_m: float
    vertex_z_m: float
    clearance_m: float
    shell_m: float

    @property
    def focus(self) -> Floats:
        """The paraboloid's focus, (3,) m."""
        return np.array([self.axis_x_m, 0.0, self.vertex_z_m - self.focal_length_m])

    @property
    def centre_x_m(self) -> float:
        """Where the dish's middle lies, x in m."""
        return self.axis_x_m + self.clearance_m + 0.5 * self.diameter_m

    def surface_height(self, x: Floats, y: Floats) -> Floats:
        """Return z of the reflecting face, m: ``z = z_vertex - rho^2 / 4 f``.

        Parameters
        ----------
        x, y : (...,) arrays, m
            In the dish's frame.

        Returns
        -------
        (...,) array, m
        """
        return np.asarray(
            self.vertex_z_m - ((x - self.axis_x_m) ** 2 + y**2) / (4.0 * self.focal_length_m)
        )

    def face(self) -> trimesh.Trimesh:
        """Return the reflecting side, concave towards -z."""
        x, y = self._disc_grid()
        return _sheet(np.stack([x, y, self.surface_height(x, y)], axis=-1), upward=False)

    def back(self) -> trimesh.Trimesh:
        """Return the back and the edge of the shell."""
        x, y = self._disc_grid()
        z = self.surface_height(x, y)
        back = np.stack([x, y, z + self.shell_m], axis=-1)
        rim = np.stack([back[-1], np.stack([x[-1], y[-1], z[-1]], axis=-1)])
        j = np.arange(SPOKES)
        after = (j + 1) % SPOKES
        edge = np.concatenate(
            [
                np.stack([j, j + SPOKES, after + SPOKES], axis=-1),
                np.stack([j, after + SPOKES, after], axis=-1),
            ]
        )
        return joined([_sheet(back, upward=True), mesh_of(rim.reshape(-1, 3), edge)])

    def ribs(self) -> trimesh.Trimesh:
        """Return the stiffening ring and six radial ribs on the back, and the hub of the arm."""
        angle = 2.0 * np.pi * np.arange(49) / 48
        middle = self.centre_x_m
        reach = 0.29 * self.diameter_m
        ring = tube(self.on_back(middle + reach * np.cos(angle), reach * np.sin(angle)), 0.022, 6)
        ribs = []
        for turn in np.deg2rad(np.arange(0.0, 360.0, 60.0)):
            radius = np.linspace(0.06, 0.46, 9) * self.diameter_m
            ribs.append(
                tube(self.on_back(middle + radius * np.cos(turn), radius * np.sin(turn)), 0.022, 6)
            )
        hub = placed(
            cylinder(0.15, -0.02, 0.05, 24), standing(self._back_centre(), self._normal_at_centre())
        )
        return joined([ring, *ribs, hub])

    def hub(self) -> Floats:
        """Return where the arm meets the hub on the back, (3,) m."""
        return np.asarray(self._back_centre() + 0.05 * self._normal_at_centre())

    def centre(self) -> Floats:
        """Return the middle of the reflecting face, (3,) m."""
        x = self.centre_x_m
        return np.array([x, 0.0, float(self.surface_height(np.array(x), np.array(0.0)))])

    def on_back(self, x: Floats, y: Floats) -> Floats:
        """Return points 2 cm behind the back, where its ribs run, (..., 3) m."""
        return np.stack([x, y, self.surface_height(x, y) + self.shell_m + 0.02], axis=-1)

    def _back_centre(self) -> Floats:
        return self.on_back(np.array(self.centre_x_m), np.array(0.0))

    def _normal_at_centre(self) -> Floats:
        """Return the back's normal at the dish's centre."""
        slope = -(self.centre_x_m - self.axis_x_m) / (2.0 * self.focal_length_m)
        normal = np.array([-slope, 0.0, 1.0])
        return normal / np.linalg.norm(normal)

    def _disc_grid(self) -> tuple[Floats, Floats]:
        """Return (rings, spokes) x and y of the dish; ring 0 is its centre."""
        radius = 0.5 * self.diameter_m * np.linspace(0.0, 1.0, RINGS)[:, None]
        angle = 2.0 * np.pi * np.arange(SPOKES) / SPOKES
        return self.centre_x_m + radius * np.cos(angle), radius * np.sin(angle)


def _sheet(rows: Floats, upward: bool) -> trimesh.Trimesh:
    """Join rings of points, the first of them a pole, into a surface."""
    i, j = np.meshgrid(np.arange(len(rows) - 1), np.arange(SPOKES), indexing="ij")
    a, b = i * SPOKES + j, i * SPOKES + (j + 1) % SPOKES
    d, c = a + SPOKES, b + SPOKES
    faces = np.concatenate(
        [
            np.stack([a, d, c], axis=-1).reshape(-1, 3),
            np.stack([a, c, b], axis=-1)[1:].reshape(-1, 3),
        ]
    )
    return mesh_of(rows.reshape(-1, 3), faces if upward else faces[:, ::-1])
