"""The Earth's gravity field in spherical harmonics, from a committed table.

References
----------
S. Pines, Uniform representation of the gravitational potential and its derivatives, AIAA Journal
11 (1973): Cartesian, without a singularity at the poles. Normalised recursions: J. B. Lundberg and
B. E. Schutz, Recursion formulas of Legendre functions for use with nonsingular geopotential models,
JGCD 11 (1988).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from models.arrays import Floats

TABLE = Path(__file__).resolve().parent / "egm2008_36.csv"
MOST_DEGREE = 36  # of the table
MU_M3_S2 = 3.986004415e14  # the table's own, as is the radius
RADIUS_M = 6_378_136.3


@dataclass(frozen=True, eq=False)
class GravityField:
    """A gravity field in the axes that turn with the Earth.

    Attributes
    ----------
    mu_m3_s2 : float, m3/s2
    radius_m : float, m
        To which the coefficients refer.
    c, s : (n + 1, n + 1) array
        Fully normalised coefficients by degree and order; ``c[0, 0]`` is 1.
    """

    mu_m3_s2: float
    radius_m: float
    c: Floats
    s: Floats

    @property
    def degree(self) -> int:
        """The highest degree and order."""
        return len(self.c) - 1

    @property
    def j2(self) -> float:
        """The unnormalised zonal coefficient J2."""
        return -float(np.sqrt(5.0) * self.c[2, 0])

    def acceleration(self, position_in_earth: Floats) -> Floats:
        """Return the gravitational acceleration, (3,), m/s2.

        Parameters
        ----------
        position_in_earth : (3,) array, m
            Outside the Earth, in the axes that turn with it.
        """
        radius = float(np.linalg.norm(position_in_earth))
        x, y, z = (position_in_earth / radius).tolist()
        degree = self.degree
        legendre = self._legendre(z)
        turned = np.power(complex(x, y), np.arange(degree + 1))
        cosine, sine = turned.real, turned.imag
        scale = self.mu_m3_s2 / radius**2 * (self.radius_m / radius) ** np.arange(degree + 1)
        here, above = legendre[:-1, :-1], legendre[:-1, 1:]
        together = self.c * cosine + self.s * sine
        before_c, before_s = np.roll(cosine, 1), np.roll(sine, 1)  # order 0 has no weight below
        ordered = here * np.arange(degree + 1.0)
        pull = np.array(
            [
                scale @ (ordered * (self.c * before_c + self.s * before_s)).sum(axis=1),
                scale @ (ordered * (self.s * before_c - self.c * before_s)).sum(axis=1),
                scale @ (self._norms.up * above * together).sum(axis=1),
            ]
        )
        inward = -scale @ (self._norms.up_both * legendre[1:, 1:] * together).sum(axis=1)
        return pull + inward * np.array([x, y, z])

    def _legendre(self, u: float) -> Floats:
        """Return the normalised derived Legendre functions, (n + 2, n + 2), by degree and order."""
        norms = self._norms
        table = np.zeros((self.degree + 2, self.degree + 2))
        np.fill_diagonal(table, norms.diagonal)
        table[1, 0] = np.sqrt(3.0) * u
        for n in range(2, self.degree + 2):
            table[n, :n] = (
                u * norms.first[n, :n] * table[n - 1, :n]
                - norms.second[n, :n] * table[n - 2, :n]
            )  # fmt: skip
        return table

    @cached_property
    def _norms(self) -> _Norms:
        return _Norms.of_degree(self.degree)


@dataclass(frozen=True, eq=False)
class _Norms:
    """The factors of the recursion and of the sums, by degree and order."""

    diagonal: Floats
    first: Floats
    second: Floats
    up: Floats
    up_both: Floats

    @classmethod
    def of_degree(cls, degree: int) -> _Norms:
        n, m = (each.astype(np.float64) for each in np.indices((degree + 2, degree + 2)))
        order = np.arange(2.0, degree + 2.0)
        ratios = np.sqrt((2.0 * order + 1.0) / (2.0 * order))
        diagonal = np.cumprod(np.concatenate([[1.0, np.sqrt(3.0)], ratios]))
        with np.errstate(divide="ignore", invalid="ignore"):  # beside the diagonal, never used
            first = np.sqrt((2 * n + 1) * (2 * n - 1) / ((n - m) * (n + m)))
            second = np.sqrt(
                (n + m - 1) * (2 * n + 1) * (n - m - 1) / ((n + m) * (n - m) * (2 * n - 3))
            )
            half = np.where(m == 0.0, 0.5, 1.0)
            up = np.sqrt((n - m) * (n + m + 1) * half)
            up_both = np.sqrt((n + m + 2) * (n + m + 1) * (2 * n + 1) / (2 * n + 3) * half)
        below = m <= n
        return cls(
            diagonal,
            first,
            second,
            np.where(below, up, 0.0)[:-1, :-1],
            np.where(below, up_both, 0.0)[:-1, :-1],
        )


@lru_cache(maxsize=8)
def earth_gravity(degree: int) -> GravityField:
    """Return EGM2008 to a degree and order of at most 36.

    Raises
    ------
    ValueError
        If the table has no such degree.
    """
    if not 2 <= degree <= MOST_DEGREE:
        raise ValueError(f"expected a degree from 2 to {MOST_DEGREE}, got {degree}")
    c, s = np.zeros((2, degree + 1, degree + 1))
    c[0, 0] = 1.0
    with TABLE.open(encoding="utf-8") as file:
        lines = [line for line in file if not line.startswith("#")][1:]
    for line in lines:
        n, m, cosine, sine = line.split(",")
        if int(n) <= degree:
            c[int(n), int(m)], s[int(n), int(m)] = float(cosine), float(sine)
    return GravityField(MU_M3_S2, RADIUS_M, c, s)
