"""Equations of FMUs for model exchange, to be integrated by tribocosim's solvers."""

from pathlib import Path

from ..opened_fmu import FmuSettings
from ..own_process import Limits
from .equations import ExchangeFmu, FmuEquations
from .in_own_process import EquationsInOwnProcess

__all__ = ["ExchangeFmu", "FmuEquations", "open_equations"]


def open_equations(
    name: str, path: Path, settings: FmuSettings, inputs: tuple[str, ...], limits: Limits | None
) -> FmuEquations:
    """The equations of the FMU at `path` with these driven inputs; with `limits` in its own process."""
    if limits is None:
        return ExchangeFmu(name, path, settings, inputs)
    return EquationsInOwnProcess(name, path, settings, limits, inputs)
