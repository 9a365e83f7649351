"""A helical compression spring from its wire: force, rate, surge, stress, fatigue.

The wire is cut into equal shares of its active coils. A share dn closes where its pitch is used up:

    e = 8 F D^3/(G d^4),  g = p - sqrt(d^2 - u^2)     deflection and gap, each per coil
    x(F) = integral of min(e, g) dn,  1/k = integral of 8 D^3/(G d^4) dn over the open coils

with the wire's diameter d, the mean diameter D, the pitch p and the radial step u per coil, by which coils of
a cone lie within each other. Shear of the section and the helix angle are left out, as in EN 13906-1.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from ..core.quantities import Vector
from .wire_materials import Fatigue, Material

# Shares of the wire. The first frequency of a cylindrical spring is then too low by 4e-7.
SHARES = 1000
# Of D/d: closer coils cannot be wound, wider ones are a slip of the unit.
LEAST_INDEX, LARGEST_INDEX = 2.0, 50.0


def wahl(index: Vector) -> Vector:
    """(4 c - 1)/(4 c - 4) + 0.615/c (Wahl 1963), with c = D/d."""
    return (4.0 * index - 1.0) / (4.0 * index - 4.0) + 0.615 / index


def bergstraesser(index: Vector) -> Vector:
    """(4 c + 2)/(4 c - 3), the factor of EN 13906-1."""
    return (4.0 * index + 2.0) / (4.0 * index - 3.0)


STRESS_FACTORS = {"bergstraesser": bergstraesser, "wahl": wahl}


@dataclass(frozen=True)
class WireSpring:
    """Wire and mean diameters, pitches (m) and coils; `mean_diameter` and `pitch` are at equal distances
    along the active coils, from the fixed to the moving end, with straight lines between them.

    ValueError for coils that cannot be wound.
    """

    diameter: float
    mean_diameter: Vector
    pitch: Vector
    active_coils: float
    end_coils: float
    material: Material
    stress_factor: str = "bergstraesser"

    def __post_init__(self) -> None:
        d = self.diameter
        for mean in (float(self.mean_diameter.min()), float(self.mean_diameter.max())):
            if not LEAST_INDEX <= mean / d <= LARGEST_INDEX:
                raise ValueError(
                    f"mean_diameter = {1e3 * mean:g} mm: must be {LEAST_INDEX:g} to {LARGEST_INDEX:g} times "
                    f"the wire's {1e3 * d:g} mm"
                )
        if self.pitch.max() > self.mean_diameter.max():
            raise ValueError(
                f"pitch = {1e3 * self.pitch.max():g} mm: must be at most the mean diameter, "
                f"{1e3 * self.mean_diameter.max():g} mm, as the helix is taken for flat"
            )
        if float(self.gap.min()) < 0.0:
            raise ValueError(
                f"pitch = {1e3 * self.pitch.min():g} mm: must leave a gap between wires of {1e3 * d:g} mm; "
                "enlarge the pitch or the free length"
            )

    @property
    def share(self) -> float:
        """Coils of a share of the wire."""
        return self.active_coils / SHARES

    def _spread(self, values: Vector) -> Vector:
        middle = (np.arange(SHARES) + 0.5) / SHARES
        return np.interp(middle, np.linspace(0.0, 1.0, values.size), values)

    @cached_property
    def diameters(self) -> Vector:
        """Mean diameter of each share."""
        return self._spread(self.mean_diameter)

    @cached_property
    def flexibility(self) -> Vector:
        """Deflection of a coil by a newton, in each share (m/N)."""
        return 8.0 * self.diameters**3 / (self.material.shear_modulus * self.diameter**4)

    @cached_property
    def gap(self) -> Vector:
        """Gap of a free coil, in each share."""
        cone = np.abs(np.gradient(self.diameters, self.share)) / 2.0 if self.mean_diameter.size > 1 else 0.0
        return self._spread(self.pitch) - np.sqrt(np.maximum(self.diameter**2 - cone**2, 0.0))

    @cached_property
    def closing_force(self) -> Vector:
        """At which the coils of each share touch (N)."""
        return self.gap / self.flexibility

    @property
    def solid_travel(self) -> float:
        """Compression from the free length until all coils touch."""
        return float(np.sum(self.gap)) * self.share

    @property
    def free_length(self) -> float:
        return float(np.sum(self._spread(self.pitch))) * self.share + self.end_coils * self.diameter

    @property
    def active_mass(self) -> float:
        return float(np.sum(self._masses))

    @property
    def _masses(self) -> Vector:
        section = np.pi * self.diameter**2 / 4.0
        return self.material.density * section * np.pi * self.diameters * self.share

    def compress(self, force: float) -> float:
        """Compression from the free length (m)."""
        return float(np.sum(np.minimum(force * self.flexibility, self.gap))) * self.share

    def find_force(self, travel: float) -> float:
        """The force (N) of a compression; ValueError unless it is less than the solid one."""
        if not 0.0 <= travel < self.solid_travel * (1.0 - 1e-12):
            raise ValueError(
                f"compresses its free length {1e3 * self.free_length:.4g} mm by {1e3 * travel:.4g} mm: must "
                f"be >= 0 and less than {1e3 * self.solid_travel:.4g} mm, where all coils touch"
            )
        # Between two closing forces the compression is linear in the force.
        closing = np.sort(self.closing_force)
        order = np.argsort(self.closing_force)
        open_after = np.cumsum(self.flexibility[order][::-1])[::-1]
        closed = np.concatenate([[0.0], np.cumsum(self.gap[order])])[:-1]
        reached = (closed + closing * open_after) * self.share
        i = int(np.searchsorted(reached, travel))
        return float((travel / self.share - closed[i]) / open_after[i])

    def is_open(self, force: float) -> Vector:
        """Of each share 1 if its coils do not touch, else 0."""
        return np.asarray(self.closing_force > force, dtype=np.float64)

    def rate(self, force: float) -> float:
        """Of the open coils (N/m)."""
        return 1.0 / (float(self.is_open(force) @ self.flexibility) * self.share)

    def surge_frequencies(self, force: float, count: int = 2) -> Vector:
        """The first natural frequencies (Hz) of the open coils, whose ends stand still; closed ones between
        them move as one mass."""
        opened = self.is_open(force) > 0.0
        inside = slice(int(np.argmax(opened)), opened.size - int(np.argmax(opened[::-1])))
        opened = opened[inside]
        node = np.cumsum(opened | np.append(True, opened[:-1])) - 1
        mass = np.bincount(node, self._masses[inside])
        # Masses in the middle of their shares: half a share to each neighbour, and to the ends.
        half = 0.5 * self.share * np.bincount(node, self.flexibility[inside] * opened)
        between = 1.0 / (half[:-1] + half[1:])
        rates = np.concatenate([[1.0 / half[0]], between, [1.0 / half[-1]]])
        diagonal = (rates[:-1] + rates[1:]) / mass
        beside = -between / np.sqrt(mass[:-1] * mass[1:])
        squares = scipy.linalg.eigh_tridiagonal(diagonal, beside, True, "i", (0, count - 1))
        return np.asarray(np.sqrt(squares) / (2.0 * np.pi))

    @cached_property
    def stress_by_force(self) -> Vector:
        """Largest shear stress of the section over the force on the coil, in each share (1/m2)."""
        factor = STRESS_FACTORS[self.stress_factor](self.diameters / self.diameter)
        return factor * 8.0 * self.diameters / (np.pi * self.diameter**3)

    def stress(self, force: float) -> Vector:
        """Of each share (Pa); coils that touch carry no more than the force that closes them."""
        return self.stress_by_force * np.minimum(force, self.closing_force)

    def safety(self, low: float, high: float) -> float:
        """Against fatigue between two forces, of the share that has the least."""
        fatigue = self.fatigue
        below, above = self.stress(low), self.stress(high)
        used = fatigue.use(0.5 * (above - below), 0.5 * (above + below))
        return 1.0 / float(np.max(used))

    @property
    def fatigue(self) -> Fatigue:
        return self.material.fatigue(self.diameter)

    def cut(self, force: float, segments: int) -> Vector:
        """The gaps (m) that segments of equal flexibility have left under a force, from the moving end."""
        opened = self.is_open(force)
        left = opened * (self.gap - force * self.flexibility) * self.share
        passed = np.concatenate([[0.0], np.cumsum(left)])
        flexible = np.concatenate([[0.0], np.cumsum(opened * self.flexibility)])
        edges = np.linspace(0.0, flexible[-1], segments + 1)
        return np.diff(np.interp(edges, flexible, passed))[::-1]
