"""The formulas that are judged, with their sources, and the conditions for which they were made."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from models.contact.analysis.line.line_contact import LineContact
from models.contact.ehl_contact import TABLE_3, ContactParameters
from models.contact.films import FILMS
from models.contact.films.groups import Conditions, groups
from models.contact.fluid import Lubricant
from models.contact.hertz import pair_compliance

CENTRAL, MINIMUM = "central", "minimum"


@dataclass(frozen=True)
class Formula:
    """`valid` says whether a contact is among those that the formula was made for, `conditions` which."""

    name: str
    label: str
    source: str
    text: str
    film: str
    conditions: str
    valid: Callable[[LineContact], bool]

    def of(self, contact: LineContact) -> float:
        """The film (m)."""
        c = contact
        return self.evaluate(c.load, c.velocity, c.radius, c.length, c.compliance, c.lubricant)

    def film_at(self, p: ContactParameters, load: float, velocity: float, radius: float) -> float:
        """The film (m) of a contact with these parameters, which may be at rest."""
        return self.evaluate(load, velocity, radius, p.length, pair_compliance(p), p)

    def evaluate(
        self,
        load: float,
        velocity: float,
        radius: float,
        length: float,
        compliance: float,
        fluid: Lubricant | ContactParameters,
    ) -> float:
        at = Conditions(velocity, radius, length, compliance, fluid.viscosity, fluid.pressure_viscosity)
        return float(FILMS[self.name](load, at))


def compute_asymptotes(M: float, L: float) -> dict[str, float]:
    """The films in Moes' unit where one effect rules: Martin's, Blok's 1.66 (alpha eta0 u/R)^(2/3), and the
    elastic ones of Moes."""
    return {
        "rigid-isoviscous": 2.45 / M,
        "rigid-piezoviscous": 1.05 * L ** (2.0 / 3.0),
        "elastic-isoviscous": 2.05 * M**-0.2,
        "elastic-piezoviscous": 0.99 * M**-0.125 * L**0.75,
    }


def find_regime(contact: LineContact) -> str:
    """The effect that rules. Load flattens bodies and thins a piezoviscous film, so that the lower of its two
    asymptotes holds (rigid for M < 0.62 L^2/3); of that and the isoviscous ones, the largest."""
    found = compute_asymptotes(contact.M, contact.L)
    piezoviscous = ("rigid-piezoviscous", "elastic-piezoviscous")
    del found[max(piezoviscous, key=lambda name: found[name])]
    return max(found, key=lambda name: found[name])


def is_elastic_piezoviscous(contact: LineContact) -> bool:
    """What power laws of elastohydrodynamic films are made for."""
    return find_regime(contact) == "elastic-piezoviscous"


def is_in_table_3(contact: LineContact) -> bool:
    """Whether G, W and U are inside Kushwaha's Table 3, without squeeze."""
    c, fluid = contact, contact.lubricant
    at = Conditions(c.velocity, c.radius, c.length, c.compliance, fluid.viscosity, fluid.pressure_viscosity)
    g = groups(math.pi / c.compliance, c.load, at)
    values = {"material": g.material, "load": g.load, "speed": g.speed}
    return all(TABLE_3[name][0] <= value <= TABLE_3[name][1] for name, value in values.items())


def holds_anywhere(contact: LineContact) -> bool:
    return True


_TABLE_3 = "G, W, U in Table 3"
_REGIME = "elastic-piezoviscous"
FORMULAS = (
    Formula(
        "kushwaha", "Kushwaha (+)", "Kushwaha et al. 2000, (10), as printed", "1.67 W^0.059 U^0.541 G^0.421",
        CENTRAL, _TABLE_3, is_in_table_3,
    ),
    Formula(
        "kushwaha_negative", "Kushwaha (−)", "the same, sign of the load changed",
        "1.67 W^−0.059 U^0.541 G^0.421", CENTRAL, _TABLE_3, is_in_table_3,
    ),
    Formula(
        "dowson_toyoda", "Dowson-Toyoda", "Dowson and Toyoda 1979", "3.06 G^0.56 U^0.69 W^−0.10",
        CENTRAL, _REGIME, is_elastic_piezoviscous,
    ),
    Formula(
        "pan_hamrock_central", "Pan-Hamrock", "Pan and Hamrock 1989", "2.922 G^0.470 U^0.692 W^−0.166",
        CENTRAL, _REGIME, is_elastic_piezoviscous,
    ),
    Formula(
        "dowson_higginson", "Dowson-Higginson", "Dowson and Higginson 1966", "2.65 G^0.54 U^0.70 W^−0.13",
        MINIMUM, _REGIME, is_elastic_piezoviscous,
    ),
    Formula(
        "pan_hamrock_minimum", "Pan-Hamrock", "Pan and Hamrock 1989", "1.714 G^0.568 U^0.694 W^−0.128",
        MINIMUM, _REGIME, is_elastic_piezoviscous,
    ),
    Formula(
        "moes_venner", "Moes", "Moes 1992, Venner 1991", "H(M, L) between four asymptotes",
        MINIMUM, "any entrainment", holds_anywhere,
    ),
)  # fmt: skip
