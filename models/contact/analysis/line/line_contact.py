"""A line contact in steady motion, by its dimensions or by Moes' groups M and L."""

import math
from dataclasses import dataclass, fields
from numbers import Real
from typing import Any

from ....core.quantities import Quantity
from ...asperities import Asperities
from ...films.groups import Conditions, Groups, groups
from ...fluid import DENSITY_LAWS, VISCOSITY_LAWS, Lubricant
from ...hertz import ELASTIC_LIMIT, half_width, maximum_pressure

# Bodies and lubricant of `moes_contact`. M and L leave them open: in Moes' groups, films depend on them only
# through alpha, and without a viscosity law that knows pressures in Pa not even on that.
_MODULUS, _RADIUS, _LENGTH, _VISCOSITY, _SPEED_GROUP = 2.27e11, 0.02, 0.012, 0.036, 1e-11
ALPHA = 2.2e-8
_ROUGH = Quantity("1", "asperities = None: smooth", positive=True)
# By the names of the fields of a contact, its lubricant and its asperities.
RANGES = {
    "load": Quantity("N", "without any a contact has no steady film", positive=True),
    "velocity": Quantity("m/s", "mean of the surfaces'"),
    "radius": Quantity("m", "reduced: 1/(1/R1 + 1/R2)", positive=True),
    "length": Quantity("m", "over which the bodies touch", positive=True),
    "compliance": Quantity("1/Pa", "(1 - nu1^2)/E1 + (1 - nu2^2)/E2", positive=True),
    "sliding": Quantity("m/s", "0: pure rolling"),
    "squeeze": Quantity("m/s", "0: a steady film"),
    "viscosity": Quantity("Pa.s", "eta0 at the contact's temperature", positive=True),
    "pressure_viscosity": Quantity("1/Pa", "0 leaves its effect out", minimum=0.0),
    "viscosity_law": Quantity("1", "position in the list", choices=VISCOSITY_LAWS),
    "density_law": Quantity("1", "position in the list", choices=DENSITY_LAWS),
    "roelands_exponent": Quantity("1", "or choose Barus' law", positive=True),
    "roelands_pressure": Quantity("Pa", "or choose Barus' law", positive=True),
    "eyring_stress": Quantity("Pa", "0 leaves its effect out", minimum=0.0),
    **dict.fromkeys(Asperities._fields, _ROUGH),
}


def check(name: str, value: Any, quantity: Quantity | None) -> None:
    """ValueError unless it is one real number, in the range of its quantity."""
    if not isinstance(value, Real):
        shown = " ".join(repr(value).split())
        raise ValueError(f"{name} = {shown}: must be one real number in SI units; give a float, as 0.03")
    if quantity and (fault := quantity.fault(name, float(value))):
        raise ValueError(fault)


@dataclass(frozen=True)
class LineContact:
    """A line contact in steady motion, SI units.

    `load` (N) on `length` (m), entraining `velocity` (m/s; mean of the surfaces', its sign the direction),
    reduced `radius` (m), `compliance` (1/Pa) as `hertz.elastic_compliance`; the surfaces' difference of
    velocity `sliding` (m/s) counts for lubricants with an Eyring stress. `squeeze` (m/s, positive:
    separating) is a rate at which the gap is taken to change all along the contact, as in quasi-static
    solutions. `asperities` carry a part of the load; None: smooth surfaces. Bodies yield where the
    pressure is above `elastic_limit` (Pa; inf: never), which a film warns of.
    ValueError for what is no contact.
    """

    load: float
    velocity: float
    radius: float
    length: float
    compliance: float
    lubricant: Lubricant
    sliding: float = 0.0
    squeeze: float = 0.0
    asperities: Asperities | None = None
    elastic_limit: float = ELASTIC_LIMIT

    def __post_init__(self) -> None:
        own = {item.name: getattr(self, item.name) for item in fields(self)}
        oil, rough = own.pop("lubricant"), own.pop("asperities")
        for name, value in (own | oil._asdict() | (rough._asdict() if rough else {})).items():
            check(name, value, RANGES.get(name))
        if self.velocity == 0.0:
            raise ValueError(
                "velocity = 0 m/s: must not be 0; without entrainment no film is steady, see the transient "
                "line contact"
            )
        if not self.elastic_limit > 0.0:
            raise ValueError(
                f"elastic_limit = {self.elastic_limit:g} Pa: must be > 0; inf for bodies that never yield"
            )

    @property
    def film_scale(self) -> float:
        """R U_S^1/2, the unit of Moes' film (m), with U_S = 2 eta0 |u|/(E' R) and E' = 2/compliance."""
        return self.radius * math.sqrt(2.0 * self._groups.speed)

    @property
    def M(self) -> float:
        """Moes' load, W U_S^-1/2."""
        return self._groups.load / math.sqrt(2.0 * self._groups.speed)

    @property
    def L(self) -> float:
        """Moes' viscosity under pressure, alpha E' U_S^1/4; 0 where viscosity is constant."""
        return self._groups.material * (2.0 * self._groups.speed) ** 0.25

    @property
    def half_width(self) -> float:
        """Hertz's b (m)."""
        return half_width(self.load, self.radius, self.length, self.compliance)

    @property
    def hertz_pressure(self) -> float:
        """The largest pressure of the dry contact (Pa)."""
        return maximum_pressure(self.load, self.radius, self.length, self.compliance)

    @property
    def _groups(self) -> Groups:
        constant = VISCOSITY_LAWS[int(self.lubricant.viscosity_law)] == "constant"
        alpha = 0.0 if constant else self.lubricant.pressure_viscosity
        at = Conditions(
            self.velocity, self.radius, self.length, self.compliance, self.lubricant.viscosity, alpha
        )
        return groups(2.0 / self.compliance, self.load, at)


def moes_contact(M: float, L: float, pressure_viscosity: float = ALPHA) -> LineContact:
    """Some line contact with these groups; L = 0: constant viscosity and density.

    Its bodies are made up and never yield. Roelands' law and that of the density know pressures in Pa, so
    that alpha (1/Pa) counts beside M and L.
    """
    check("M", M, Quantity("1", "Moes' load", positive=True))
    check("L", L, Quantity("1", "Moes' viscosity under pressure", minimum=0.0))
    check("pressure_viscosity", pressure_viscosity, Quantity("1/Pa", "of Roelands' law", positive=True))
    constant = L == 0.0
    speed_group = _SPEED_GROUP if constant else (L / (pressure_viscosity * _MODULUS)) ** 4
    return LineContact(
        load=M * math.sqrt(speed_group) * _MODULUS * _RADIUS * _LENGTH,
        velocity=0.5 * speed_group * _MODULUS * _RADIUS / _VISCOSITY,
        radius=_RADIUS,
        length=_LENGTH,
        compliance=2.0 / _MODULUS,
        lubricant=Lubricant(
            _VISCOSITY,
            pressure_viscosity,
            float(VISCOSITY_LAWS.index("constant" if constant else "roelands")),
            float(DENSITY_LAWS.index("constant" if constant else "dowson_higginson")),
        ),
        elastic_limit=math.inf,
    )
