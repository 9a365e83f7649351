"""Co-simulation masters. To add one: a file with a frozen dataclass, listed here.

A master is `step(exchange, time, step) -> iterations`: it advances all participants from `time` to
`time + step` and leaves their outputs there in `exchange.values`. Its fields are the options of a
scenario's [master] table.
"""

from __future__ import annotations

from typing import Any

from .gauss_seidel import GaussSeidel
from .iterated import Iterated
from .jacobi import Jacobi
from .protocol import Master

MASTERS: dict[str, type[Any]] = {
    "jacobi": Jacobi,
    "gauss_seidel": GaussSeidel,
    "iterated": Iterated,
}

__all__ = ["MASTERS", "GaussSeidel", "Iterated", "Jacobi", "Master"]
