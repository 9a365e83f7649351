"""Co-simulation masters. To add one, write a file with a frozen dataclass and list it here.

A master's `step` advances all participants by one macro step and leaves their outputs in the coupling's
values. Its fields are the options of a scenario's [master] table.
"""

from dataclasses import is_dataclass
from typing import Any

from models.catalogue import import_own

from ..errors import one_of
from .gauss_seidel import GaussSeidel
from .iterated import Iterated
from .jacobi import Jacobi
from .newton import Newton
from .own import explain_steps
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


def find_master(name: str) -> type[Any]:
    """The master of that name, or a user's own as "module:object"; ValueError if there is none."""
    if ":" not in name:
        if name not in MASTERS:
            raise ValueError(
                f"{name!r}: {one_of(MASTERS, name)} (or auto in a scenario, or your own as module:object)"
            )
        return MASTERS[name]
    kind = import_own(name)
    members = ("implicit", "extrapolation", "degree", "order", "iterate", "acceleration", "step")
    lacking = [member for member in members if not hasattr(kind, member)]
    if not (isinstance(kind, type) and is_dataclass(kind)) or lacking:
        lacks = f"lacks {', '.join(lacking)}" if lacking else "is no dataclass"
        raise ValueError(f"{name}: {lacks}; must be a class as orchestrator.masters.protocol.Master says")
    return explain_steps(kind, name)


__all__ = ["MASTERS", "GaussSeidel", "Iterated", "Jacobi", "Master", "Newton", "find_master", "find_name"]
