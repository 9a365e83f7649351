"""Co-simulation masters. To add one, write a file with a frozen dataclass and list it here.

A master's `step` advances all participants by one macro step and leaves their outputs in the coupling's
values. Its fields are the options of a scenario's [master] table.
"""

from typing import Any

from .gauss_seidel import GaussSeidel
from .iterated import Iterated
from .jacobi import Jacobi
from .newton import Newton
from .protocol import Master

MASTERS: dict[str, type[Any]] = {
    "jacobi": Jacobi,
    "gauss_seidel": GaussSeidel,
    "iterated": Iterated,
    "newton": Newton,
}


def find_name(master: Master) -> str:
    """The master as a scenario names it."""
    return next((name for name, kind in MASTERS.items() if isinstance(master, kind)), type(master).__name__)


__all__ = ["MASTERS", "GaussSeidel", "Iterated", "Jacobi", "Master", "Newton", "find_name"]
