"""The monolithic reference: a whole System as one problem, without splitting, by two methods."""

from .adherence import solve_adherence
from .difference import Difference, difference, time_weights
from .energy import EnergyBalance
from .equilibrium import equilibrium
from .problem import Event, check_ode
from .reference import Reference, solve

__all__ = [
    "Difference",
    "EnergyBalance",
    "Event",
    "Reference",
    "check_ode",
    "difference",
    "equilibrium",
    "solve",
    "solve_adherence",
    "time_weights",
]
