"""The monolithic reference: two methods solve all equations of a System together."""

from .energy import EnergyBalance
from .equilibrium import equilibrium
from .problem import Event, check_ode, check_solvable
from .reference import LONGEST_STEP, Reference, solve

__all__ = [
    "LONGEST_STEP", "EnergyBalance", "Event", "Reference", "check_ode", "check_solvable", "equilibrium",
    "solve",
]  # fmt: skip
