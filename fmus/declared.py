"""What the folder of a component's FMU, or the module of a user's own component, declares."""

import importlib
from typing import Any

from models.catalogue import find_factory, is_own

from .fmi.description import Experiment


def explain_no_native(name: str) -> str:
    """Why there is no native FMU of the component, and no model exchange; "" if there is one."""
    return str(find_extra(name, "PYTHON_ONLY", ""))


def experiment(name: str) -> Experiment:
    """The default experiment of tools: of ours two turns at 1000 r/min where the folder has no other."""
    usual = Experiment(1.0, 1e-3) if is_own(name) else Experiment(0.12, 1e-5)
    offered: Experiment = find_extra(name, "EXPERIMENT", usual)
    return offered


def find_extra(name: str, constant: str, default: Any) -> Any:
    """A constant of the component's folder here, of a user's own component of its module."""
    place = find_factory(name).__module__ if is_own(name) else f"fmus.{name}"
    return getattr(importlib.import_module(place), constant, default)
