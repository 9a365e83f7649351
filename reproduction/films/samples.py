"""Line contacts sampled over the ranges of Kushwaha's Table 3, and power laws fitted to their films."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import qmc

from models.contact.analysis.line.line_contact import LineContact
from models.contact.analysis.line.steady import SteadyFilm
from models.contact.ehl_contact import TABLE_3
from models.contact.fluid import Lubricant
from models.contact.hertz import elastic_compliance
from models.core.quantities import Vector

from .formulas import Formula
from .numerical import list_heights, solve_films

# Steel on steel; by similarity the other dimensions do not count.
COMPLIANCE = elastic_compliance(207e9, 0.3, 207e9, 0.3)
RADIUS, LENGTH, VISCOSITY = 0.02, 0.012, 0.036
# Martin's film of rigid bodies, H = 2.448/M.
MARTIN = 2.448
# Where the search for the joined law starts: Moes' elastic-piezoviscous film (its logarithm and the
# exponents of M and L), joined by squares.
START = (0.0, -0.125, 0.75, 2.0)
# Constant of the squeeze term of (10).
SQUEEZE = 96.775


@dataclass(frozen=True)
class Sample:
    """Scrambled Sobol' points in the logarithms of G, W, U (Kushwaha's, with E = pi/compliance) and in w_s.

    Films (m) of the steady contact and of the one whose bodies close at w_s times the entraining velocity.
    """

    contacts: Sequence[LineContact]
    material: Vector
    load: Vector
    speed: Vector
    squeeze: Vector
    steady: Sequence[SteadyFilm | None]
    squeezed: Sequence[SteadyFilm | None]

    @property
    def M(self) -> Vector:
        return np.array([contact.M for contact in self.contacts])

    @property
    def L(self) -> Vector:
        return np.array([contact.L for contact in self.contacts])

    @property
    def speed_group(self) -> Vector:
        """U_S of Moes."""
        return np.array([(contact.film_scale / contact.radius) ** 2 for contact in self.contacts])

    def over_numerical(self, formula: Formula) -> Vector:
        """A formula over the steady numerical film, at every contact."""
        film = np.array([formula.of(contact) for contact in self.contacts])
        return film / list_heights(self.steady, f"{formula.film}_film")

    def squeezed_over_numerical(self, formula: Formula) -> Vector:
        """Kushwaha's film with its squeeze term over the numerical film of the closing bodies."""
        film = np.array([formula.of(contact) for contact in self.contacts])
        return film * np.exp(-SQUEEZE * self.squeeze) / list_heights(self.squeezed, f"{formula.film}_film")


def draw_sample(exponent: int, seed: int) -> Sample:
    """2^exponent contacts."""
    unit = qmc.Sobol(4, scramble=True, rng=seed).random_base2(exponent)
    logs = [np.log(TABLE_3[name]) for name in ("material", "load", "speed")]
    G, W, U = (np.exp(low + unit[:, k] * (high - low)) for k, (low, high) in enumerate(logs))
    squeeze = TABLE_3["squeeze"][0] + unit[:, 3] * (TABLE_3["squeeze"][1] - TABLE_3["squeeze"][0])
    modulus = math.pi / COMPLIANCE
    contacts = [
        LineContact(
            w * modulus * RADIUS * LENGTH, u * modulus * RADIUS / VISCOSITY, RADIUS, LENGTH, COMPLIANCE,
            Lubricant(VISCOSITY, g / modulus),
        )
        for g, w, u in zip(G, W, U, strict=True)
    ]  # fmt: skip
    closing = [replace(c, squeeze=s * c.velocity) for c, s in zip(contacts, squeeze, strict=True)]
    return Sample(contacts, G, W, U, squeeze, solve_films(contacts), solve_films(closing))


@dataclass(frozen=True)
class PowerLaw:
    """h/R = constant U^speed G^material W^load exp(-squeeze_constant w_s U^-1/4).

    U = eta0 u/(E' R), G = alpha E', W = load/(E' R L), E' = 2/compliance. Exponents a, b, c of U, G, W have
    a - b/4 + c/2 = 1/2, and w_s U^-1/4 is the group that squeeze comes in: the law of a film that depends
    on two groups, or three. With `blend` s > 0 it is joined with Martin's film of rigid bodies, 4.9 U/W, by
    the sum of their s-th powers.
    """

    film: str
    constant: float
    speed: float
    material: float
    load: float
    squeeze_constant: float
    blend: float = 0.0

    def H(self, s: Sample, squeezed: bool) -> Vector:
        """The film in Moes' unit at the contacts of a sample."""
        U, k = 0.5 * s.speed_group, self.squeeze_constant
        W, G = s.M * np.sqrt(s.speed_group), s.L * s.speed_group**-0.25
        H = self.constant * U**self.speed * G**self.material * W**self.load / np.sqrt(s.speed_group)
        if self.blend > 0.0:
            H = _join(H, s.M, self.blend)
        return H * np.exp(-k * s.squeeze * U**-0.25) if squeezed else H

    @property
    def text(self) -> str:
        """h/R of the steady film."""
        signed = f"{self.load:.4f}".replace("-", "−")
        power = f"{self.constant:.4g} U^{self.speed:.4f} G^{self.material:.4f} W^{signed}"
        if not self.blend:
            return power
        return f"[({power})^s + ({2.0 * MARTIN:.3g} U/W)^s]^(1/s), s = {self.blend:.3f}"


@dataclass(frozen=True)
class Error:
    """Relative, on a sample."""

    rms: float
    worst: float


def measure_error(law: PowerLaw, s: Sample, squeezed: bool) -> Error:
    """How far a power law is from the numerical films."""
    found = list_heights(s.squeezed if squeezed else s.steady, f"H_{law.film}")
    off = (law.H(s, squeezed) / found - 1.0)[np.isfinite(found)]
    return Error(float(np.sqrt(np.mean(np.square(off)))), float(np.max(np.abs(off))))


def fit_law(film: str, s: Sample, blended: bool) -> PowerLaw:
    """Least squares of ln H on a sample. H = C M^c L^b by construction, alone or joined with Martin's."""
    found = list_heights(s.steady, f"H_{film}")
    known = np.isfinite(found)
    M, L, H = s.M[known], s.L[known], found[known]
    columns = np.column_stack([np.ones(H.size), np.log(M), np.log(L)])
    values = np.linalg.lstsq(columns, np.log(H), rcond=None)[0]
    blend = 0.0
    if blended:

        def measure_miss(v: Vector) -> Vector:
            return np.log(_join(np.exp(columns @ v[:3]), M, v[3]) / H)

        *values, blend = least_squares(measure_miss, START).x
    constant, load, material = values
    # From U_S = 2 U, M = W U_S^-1/2 and L = G U_S^1/4 to U, G, W.
    speed = 0.5 + 0.25 * material - 0.5 * load
    squeeze = _fit_squeeze_constant(s, film) * 2.0**-0.25
    return PowerLaw(film, math.exp(constant) * 2.0**speed, speed, material, load, squeeze, float(blend))


def _join(H: Vector, M: Vector, blend: float) -> Vector:
    return np.asarray((H**blend + (MARTIN / M) ** blend) ** (1.0 / blend))


def _fit_squeeze_constant(s: Sample, film: str) -> float:
    """k in h/h_steady = exp(-k w_s U_S^-1/4); the group of w_s that similarity asks for."""
    ratio = list_heights(s.squeezed, f"H_{film}") / list_heights(s.steady, f"H_{film}")
    x = -s.squeeze * s.speed_group**-0.25
    known = np.isfinite(ratio)
    return float(np.sum(x[known] * np.log(ratio[known])) / np.sum(x[known] ** 2))
