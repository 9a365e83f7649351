"""A line contact in steady motion, by its dimensions or by Moes' groups M and L."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from numbers import Real
from typing import Any

from ...asperities import Asperities
from ...films.groups import Conditions, Groups, groups
from ...fluid import DENSITY_LAWS, VISCOSITY_LAWS, Lubricant
from ...hertz import ELASTIC_LIMIT, half_width, maximum_pressure

# Bodies and lubricant of `moes_contact`. M and L leave them open: in Moes' groups, films depend on them only
# through alpha, and without a viscosity law that knows pressures in Pa not even on that.
_MODULUS, _RADIUS, _LENGTH, _VISCOSITY, _SPEED_GROUP = 2.27e11, 0.02, 0.012, 0.036, 1e-11
ALPHA = 2.2e-8
_POSITIVE, _NOT_NEGATIVE, _NOT_ZERO, _FINITE = (
    "finite and > 0",
    "finite and >= 0",
    "finite and not 0",
    "finite",
)
_HOLDS: dict[str, Callable[[float], bool]] = {
    _POSITIVE: lambda value: value > 0.0,
    _NOT_NEGATIVE: lambda value: value >= 0.0,
    _NOT_ZERO: lambda value: value != 0.0,
    _FINITE: math.isfinite,
}
_AT_REST = "without entrainment no film is steady, see the transient line contact"
_NO_EFFECT = "0 leaves its effect out"


def real(name: str, value: Any) -> None:
    """ValueError unless it is one real number."""
    if not isinstance(value, Real):
        shown = " ".join(repr(value).split())
        raise ValueError(f"{name} = {shown}: must be one real number in SI units; give a float, as 0.03")


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
        for part in (self, self.lubricant, self.asperities):
            for name, value in _numbers_of(part):
                real(name, value)
        oil, rough = self.lubricant, self.asperities._asdict() if self.asperities else {}
        for name, unit, value, allowed, remedy in (
            ("load", " N", self.load, _POSITIVE, "a contact without load has no steady film of its own"),
            ("radius", " m", self.radius, _POSITIVE, "give the reduced radius, 1/(1/R1 + 1/R2)"),
            ("length", " m", self.length, _POSITIVE, "give the length over which the bodies touch"),
            ("compliance", " 1/Pa", self.compliance, _POSITIVE, "give (1 - nu1^2)/E1 + (1 - nu2^2)/E2"),
            ("viscosity", " Pa.s", oil.viscosity, _POSITIVE, "give eta0 at the contact's temperature"),
            ("velocity", " m/s", self.velocity, _NOT_ZERO, _AT_REST),
            ("pressure_viscosity", " 1/Pa", oil.pressure_viscosity, _NOT_NEGATIVE, _NO_EFFECT),
            ("eyring_stress", " Pa", oil.eyring_stress, _NOT_NEGATIVE, _NO_EFFECT),
            ("roelands_exponent", "", oil.roelands_exponent, _POSITIVE, "or choose Barus' law"),
            ("roelands_pressure", " Pa", oil.roelands_pressure, _POSITIVE, "or choose Barus' law"),
            *((key, "", number, _POSITIVE, "asperities = None is smooth") for key, number in rough.items()),
            ("sliding", " m/s", self.sliding, _FINITE, "0 is pure rolling"),
            ("squeeze", " m/s", self.squeeze, _FINITE, "0 is a steady film"),
        ):
            if not (math.isfinite(value) and _HOLDS[allowed](value)):
                raise ValueError(f"{name} = {value:g}{unit}: must be {allowed}; {remedy}")
        if not self.elastic_limit > 0.0:
            raise ValueError(
                f"elastic_limit = {self.elastic_limit:g} Pa: must be > 0; inf for bodies that never yield"
            )
        for name, law, laws in (
            ("viscosity_law", self.lubricant.viscosity_law, VISCOSITY_LAWS),
            ("density_law", self.lubricant.density_law, DENSITY_LAWS),
        ):
            if law not in range(len(laws)):
                raise ValueError(f"{name} = {law:g}: must be 0 to {len(laws) - 1}, for {', '.join(laws)}")

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


def _numbers_of(part: LineContact | Lubricant | Asperities | None) -> Iterator[tuple[str, Any]]:
    if isinstance(part, LineContact):
        found = {item.name: getattr(part, item.name) for item in fields(part)}
        yield from ((name, value) for name, value in found.items() if name not in ("lubricant", "asperities"))
    elif part is not None:
        yield from part._asdict().items()


def moes_contact(M: float, L: float, pressure_viscosity: float = ALPHA) -> LineContact:
    """Some line contact with these groups; L = 0: constant viscosity and density.

    Its bodies are made up and never yield. Roelands' law and that of the density know pressures in Pa, so
    that alpha (1/Pa) counts beside M and L.
    """
    for name, value, allowed in (
        ("M", M, _POSITIVE), ("L", L, _NOT_NEGATIVE), ("pressure_viscosity", pressure_viscosity, _POSITIVE),
    ):  # fmt: skip
        real(name, value)
        if not (math.isfinite(value) and _HOLDS[allowed](value)):
            raise ValueError(f"{name} = {value:g}: must be {allowed}")
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
