"""A shaft with discs as finite elements in torsion and bending, and its modes.

Qin and Zuo 2000 join rigid segments by Timoshenko connectors. These are Timoshenko elements of the same
stiffness with consistent inertia, also of rotation. A disc is a cam, a gear or any mass that turns with the
shaft. The shaft turns about z; x and y are its two planes of bending, which have the same modes.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import NDArray

from ..core.quantities import Vector

# Length of the elements over the diameter. An element has one shear force and converges with its square: the
# third frequency of bending is then good to 1.2e-4, that of torsion to 9.5e-4.
FINE = 0.25
# Part of the largest eigenvalue of the mass matrix below which a shape is one of the others again.
DEPENDENT = 1e-10


@dataclass(frozen=True)
class Disc:
    """At the place z (m): mass (kg), moments of inertia about the shaft and about a diameter (kg m2)."""

    place: float
    mass: float
    polar_inertia: float
    transverse_inertia: float


@dataclass(frozen=True)
class Bearing:
    """At the place z (m), with a radial stiffness (N/m); infinite: pinned."""

    place: float
    stiffness: float = math.inf


@dataclass(frozen=True)
class Shaft:
    """A round shaft from z = 0, where it is driven, to its free end.

    `drive_stiffness` (N m/rad) of belt, chain or gears is between the drive and the shaft; infinite: none.
    `journals` are places (m) where other parts bear the shaft, with forces from outside.
    """

    length: float
    diameter: float
    discs: Sequence[Disc]
    bearings: Sequence[Bearing] = ()
    bore: float = 0.0
    youngs_modulus: float = 207e9
    poissons_ratio: float = 0.3
    density: float = 7850.0
    shear_coefficient: float = 0.9
    drive_stiffness: float = math.inf
    journals: Sequence[float] = ()

    @property
    def stations(self) -> list[float]:
        """Places (m) where forces and torques act: discs, then journals."""
        return [*(disc.place for disc in self.discs), *self.journals]

    @property
    def area(self) -> float:
        return 0.25 * math.pi * (self.diameter**2 - self.bore**2)

    @property
    def second_moment(self) -> float:
        """Of area, about a diameter; the polar one is twice as large."""
        return math.pi * (self.diameter**4 - self.bore**4) / 64.0

    @property
    def shear_modulus(self) -> float:
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))


@dataclass(frozen=True)
class Modes:
    """Modes: angular frequencies (m,), modal masses (m,), shapes at the stations (m, stations), at most 1.

    `share` (m,) is what turning the whole shaft does to each mode of torsion, phi^T M 1 (kg m2). `gyroscopic`
    (m, m) couples both planes of bending at unit speed (kg). `inertia` is that of the whole shaft (kg m2).
    """

    frequency: Vector
    mass: Vector
    shape: Vector
    share: Vector
    gyroscopic: Vector
    inertia: float


def find_nodes(shaft: Shaft) -> Vector:
    """Places of the nodes: both ends, stations, bearings, and between them."""
    places = [0.0, shaft.length, *shaft.stations, *(b.place for b in shaft.bearings)]
    ends = np.unique(np.round(places, 9))
    between = [
        np.linspace(a, b, math.ceil((b - a) / (FINE * shaft.diameter)), endpoint=False)
        for a, b in pairwise(ends)
    ]
    return np.append(np.concatenate(between), ends[-1])


def _node(nodes: Vector, place: float) -> int:
    return int(np.argmin(np.abs(nodes - place)))


def torsion_matrices(shaft: Shaft, nodes: Vector) -> tuple[Vector, Vector]:
    """Stiffness and mass of the rotations, the driven end included."""
    n = nodes.size
    K, M = np.zeros((n, n)), np.zeros((n, n))
    polar = 2.0 * shaft.second_moment
    for i, length in enumerate(np.diff(nodes)):
        part = slice(i, i + 2)
        K[part, part] += shaft.shear_modulus * polar / length * np.array([[1.0, -1.0], [-1.0, 1.0]])
        M[part, part] += shaft.density * polar * length / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    for disc in shaft.discs:
        i = _node(nodes, disc.place)
        M[i, i] += disc.polar_inertia
    return K, M


def bending_matrices(shaft: Shaft, nodes: Vector) -> tuple[Vector, Vector, Vector]:
    """Stiffness, mass and gyroscopic matrix of (displacement, slope) at the nodes, in one plane."""
    n = 2 * nodes.size
    K, M, G = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n))
    EI, rotary = shaft.youngs_modulus * shaft.second_moment, shaft.density * shaft.second_moment
    shear = shaft.shear_coefficient * shaft.shear_modulus * shaft.area
    for i, length in enumerate(np.diff(nodes)):
        part = slice(2 * i, 2 * i + 4)
        P = 12.0 * EI / (shear * length**2)
        K[part, part] += _beam_stiffness(EI, length, P)
        turning = _rotary_inertia(rotary, length, P)
        M[part, part] += _translatory_inertia(shaft.density * shaft.area, length, P) + turning
        # Of a thin slice the polar moment of inertia is twice that about a diameter.
        G[part, part] += 2.0 * turning
    for disc in shaft.discs:
        i = 2 * _node(nodes, disc.place)
        M[i, i] += disc.mass
        M[i + 1, i + 1] += disc.transverse_inertia
        G[i + 1, i + 1] += disc.polar_inertia
    for bearing in shaft.bearings:
        if math.isfinite(bearing.stiffness):
            i = 2 * _node(nodes, bearing.place)
            K[i, i] += bearing.stiffness
    return K, M, G


def _beam_stiffness(EI: float, length: float, P: float) -> Vector:
    """Of a Timoshenko element, P = 12 E I/(kappa G A L^2)."""
    L = length
    return np.asarray(
        EI / ((1.0 + P) * L**3) * np.array(
            [
                [12.0, 6.0 * L, -12.0, 6.0 * L],
                [6.0 * L, (4.0 + P) * L**2, -6.0 * L, (2.0 - P) * L**2],
                [-12.0, -6.0 * L, 12.0, -6.0 * L],
                [6.0 * L, (2.0 - P) * L**2, -6.0 * L, (4.0 + P) * L**2],
            ]
        )
    )  # fmt: skip


def _translatory_inertia(mass_per_length: float, length: float, P: float) -> Vector:
    L = length
    a = 13.0 / 35.0 + 7.0 * P / 10.0 + P**2 / 3.0
    b = (11.0 / 210.0 + 11.0 * P / 120.0 + P**2 / 24.0) * L
    c = 9.0 / 70.0 + 3.0 * P / 10.0 + P**2 / 6.0
    d = (13.0 / 420.0 + 3.0 * P / 40.0 + P**2 / 24.0) * L
    e = (1.0 / 105.0 + P / 60.0 + P**2 / 120.0) * L**2
    f = (1.0 / 140.0 + P / 60.0 + P**2 / 120.0) * L**2
    matrix = [[a, b, c, -d], [b, e, d, -f], [c, d, a, -b], [-d, -f, -b, e]]
    return np.asarray(mass_per_length * L / (1.0 + P) ** 2 * np.array(matrix))


def _rotary_inertia(inertia_per_length: float, length: float, P: float) -> Vector:
    L = length
    a = 6.0 / 5.0
    b = (1.0 / 10.0 - P / 2.0) * L
    c = (2.0 / 15.0 + P / 6.0 + P**2 / 3.0) * L**2
    d = (1.0 / 30.0 + P / 6.0 - P**2 / 6.0) * L**2
    matrix = [[a, b, -a, b], [b, c, -b, -d], [-a, -b, a, -b], [b, -d, -b, c]]
    return np.asarray(inertia_per_length / ((1.0 + P) ** 2 * L) * np.array(matrix))


def find_torsion(shaft: Shaft, lowest: int) -> Modes:
    """The lowest modes and those that make the twist under steady torques at the stations exact."""
    nodes = find_nodes(shaft)
    K, M = torsion_matrices(shaft, nodes)
    whole = float(M.sum())
    turned = M @ np.ones(nodes.size)
    if math.isfinite(shaft.drive_stiffness):
        K[0, 0] += shaft.drive_stiffness
        free = np.arange(nodes.size)
    else:
        free = np.arange(1, nodes.size)
    at = [_node(nodes, place) for place in shaft.stations]
    frequency, vectors = _reduce(K, M, free, at, lowest, np.zeros((nodes.size, 0)))
    share = vectors[free].T @ turned[free]
    return _scale(frequency, vectors[at].T, share, np.zeros((frequency.size,) * 2), whole)


def find_bending(shaft: Shaft, lowest: int) -> Modes:
    """As of torsion, under steady forces, with the motions that are rigid first, of frequency 0.

    ValueError if fewer than two bearings and journals hold the shaft.
    """
    supports = {*(bearing.place for bearing in shaft.bearings), *shaft.journals}
    if len(supports) < 2:
        raise ValueError(f"{len(supports)} bearings and journals: a shaft that bends needs at least two")
    nodes = find_nodes(shaft)
    K, M, G = bending_matrices(shaft, nodes)
    pinned = {2 * _node(nodes, b.place) for b in shaft.bearings if math.isinf(b.stiffness)}
    free = np.array([i for i in range(2 * nodes.size) if i not in pinned])
    at = [2 * _node(nodes, place) for place in shaft.stations]
    frequency, vectors = _reduce(K, M, free, at, lowest, rigid_motions(shaft, nodes))
    gyroscopic = vectors[free].T @ G[np.ix_(free, free)] @ vectors[free]
    return _scale(frequency, vectors[at].T, np.zeros(frequency.size), gyroscopic, 0.0)


def rigid_motions(shaft: Shaft, nodes: Vector) -> Vector:
    """Displacements and slopes of the nodes (2 nodes, motions) that bend neither shaft nor bearings.

    Without bearings the shaft may move and tilt, in one bearing tilt about it.
    """
    if len(shaft.bearings) > 1:
        return np.zeros((2 * nodes.size, 0))
    centre = shaft.bearings[0].place if shaft.bearings else 0.0
    moved = np.column_stack([np.ones(nodes.size), np.zeros(nodes.size)]).ravel()
    tilted = np.column_stack([nodes - centre, np.ones(nodes.size)]).ravel()
    return np.column_stack([tilted] if shaft.bearings else [moved, tilted])


def _scale(frequency: Vector, shape: Vector, share: Vector, gyroscopic: Vector, inertia: float) -> Modes:
    """Modes of modal mass 1 as ones of which the largest displacement of a station is 1."""
    size = 1.0 / np.max(np.abs(shape), axis=1)
    return Modes(
        frequency, size**2, size[:, None] * shape, size * share, np.outer(size, size) * gyroscopic, inertia
    )


def rigid_bending(stations: int) -> Modes:
    """One mode in which no station moves."""
    shape, coupling = np.zeros((1, stations)), np.zeros((1, 1))
    return Modes(np.array([2e3 * math.pi]), np.ones(1), shape, np.zeros(1), coupling, 0.0)


def _reduce(
    K: Vector, M: Vector, free: NDArray[np.intp], loaded: Sequence[int], lowest: int, rigid: Vector
) -> tuple[Vector, Vector]:
    """The rigid motions, and Ritz modes of the lowest others together with the shapes under unit loads.

    Angular frequencies, and modes of unit mass as columns; coordinates that are not free are zero.
    """
    at = np.flatnonzero(np.isin(free, loaded))
    whole = K.shape[0]
    K, M, rigid = K[np.ix_(free, free)], M[np.ix_(free, free)], rigid[free]
    count = rigid.shape[1]
    rigid = rigid @ np.linalg.inv(np.linalg.cholesky(rigid.T @ M @ rigid)).T
    inertia = M @ rigid
    squares, vectors = scipy.linalg.eigh(K, M, subset_by_index=(0, min(lowest + count, K.shape[0]) - 1))
    exact = vectors[:, count:]
    # Loads on a free shaft are balanced by its inertia; its rigid motions are held with any stiffness.
    loads = np.eye(K.shape[0])[:, at] - inertia @ rigid[at].T
    static = np.linalg.solve(K + squares[-1] * inertia @ inertia.T, loads)
    static -= exact @ (exact.T @ (M @ static))
    mass = static.T @ M @ static
    size, turned = np.linalg.eigh(mass / np.sqrt(np.outer(np.diag(mass), np.diag(mass))))
    basis = static / np.sqrt(np.diag(mass)) @ turned[:, size > DEPENDENT * size.max()]
    basis = np.column_stack([exact, basis])
    squares, mixed = scipy.linalg.eigh(basis.T @ K @ basis, basis.T @ M @ basis)
    modes = np.zeros((whole, count + squares.size))
    modes[free] = np.column_stack([rigid, basis @ mixed])
    return np.r_[np.zeros(count), np.sqrt(squares)], modes


def name_elements(name: str, values: Vector) -> dict[str, float]:
    """As parameters of a component: name[1], name[2], ..."""
    return {f"{name}[{i + 1}]": float(value) for i, value in enumerate(np.ravel(values))}


def list_parameters(
    torsion: Modes, bending: Modes, damping_time: float, damping_ratio: float
) -> dict[str, float]:
    """The parameters of the component `shaft`. Damping ratios are `damping_ratio` + damping_time omega/2."""
    found = {"inertia": torsion.inertia}
    for name, mass, modes in (("torsion", "inertia", torsion), ("bending", "mass", bending)):
        found |= name_elements(f"{name}_frequency", modes.frequency / (2.0 * math.pi))
        found |= name_elements(f"{name}_damping", damping_ratio + 0.5 * damping_time * modes.frequency)
        found |= name_elements(f"{name}_{mass}", modes.mass)
        found |= name_elements(f"{name}_shape", modes.shape)
    found |= name_elements("torsion_share", torsion.share)
    return found | name_elements("gyroscopic", bending.gyroscopic)
