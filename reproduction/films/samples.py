"""Line contacts sampled over the ranges of Kushwaha's Table 3."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
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
