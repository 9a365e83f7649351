"""Equations of FMUs for model exchange, to be integrated by tribocosim's solvers."""

from __future__ import annotations

from pathlib import Path

from ..opened_fmu import FmuSettings
from .equations import ExchangeFmu, FmuEquations
from .in_own_process import EquationsInOwnProcess

__all__ = ["ExchangeFmu", "FmuEquations", "open_equations"]


def open_equations(
    name: str, path: Path, settings: FmuSettings, inputs: tuple[str, ...], own_process: bool
) -> FmuEquations:
    """The equations of the FMU at `path` with these driven inputs."""
    kind = EquationsInOwnProcess if own_process else ExchangeFmu
    return kind(name, path, settings, inputs)
