"""The components by name, as scenarios and FMU builds ask for them."""

import functools
import importlib
import importlib.util
import os
import re
import sys
import traceback
from collections import UserDict
from collections.abc import Callable, MutableMapping
from pathlib import Path
from types import ModuleType
from typing import Any

from .core.bonds import counts_energies
from .core.component import Component

# The module of each component, below this package. Its factory has the component's name and takes structural
# sizes by keyword, e.g. valve_spring(coil_masses=8).
MODULES = {
    "camshaft": "valve_train.camshaft",
    "valve_spring": "valve_train.valve_spring",
    "valve": "valve_train.valve",
    "coil_spring": "valve_train.coil_spring",
    "shaft": "valve_train.shaft",
    "journal_bearing": "valve_train.journal_bearing",
    "tappet": "valve_train.tappet",
    "finger": "valve_train.finger",
    "rod": "valve_train.rod",
    "rocker": "valve_train.rocker",
    "pivot_friction": "valve_train.pivot_friction",
    "pad_friction": "valve_train.pad_friction",
    "roller": "valve_train.roller",
    "pin_bearing": "valve_train.pin_bearing",
    "needle_bearing": "valve_train.needle_bearing",
    "guide_friction": "valve_train.guide_friction",
    "tappet_spin": "valve_train.tappet_spin",
    "lash_adjuster": "valve_train.lash_adjuster",
    "ehl_contact": "contact.ehl_contact",
    "ehl_line_contact": "contact.ehl_line_contact",
    "flywheel": "flywheel",
    "slider_crank": "slider_crank.slider_crank",
    "piston_crank": "slider_crank.piston.piston_crank",
    "free_piston_crank": "slider_crank.piston.piston_crank",
    "cylinder_gas": "slider_crank.piston.cylinder_gas",
    "piston_clearance": "slider_crank.piston_clearance",
    "quarter_car_chassis": "oscillators.quarter_car",
    "quarter_car_wheel": "oscillators.quarter_car",
    "coupled_mass": "oscillators.two_masses",
    "sprung_mass": "oscillators.two_masses",
    "falling_mass": "oscillators.bouncing_mass",
    "spring_stop": "oscillators.bouncing_mass",
    "planes": "nonlinear_loop",
    "sphere": "nonlinear_loop",
}


class _Catalogue(UserDict[str, Any]):
    """The factories by name, which all count energies if asked (see `counts_energies`).

    A module is imported when its component is asked for: few runs need many.
    """

    def __getitem__(self, name: str) -> Callable[..., Component]:
        found = self.data[name]
        if isinstance(found, str):
            found = getattr(importlib.import_module(f".{found}", __package__), name)
        return counts_energies(found)


CATALOGUE: MutableMapping[str, Callable[..., Component]] = _Catalogue(MODULES)


def is_own(name: str) -> bool:
    """Whether the name is that of a user's own component, "module:factory"."""
    return ":" in name


def identify(name: str) -> str:
    """The name by which an FMU is called: that of the component, of a user's own that of its factory."""
    return name.rpartition(":")[2]


@functools.cache
def find_factory(name: str) -> Callable[..., Component]:
    """The factory of a component of the catalogue, or of a user's own as "module:factory".

    The module lies where the command is called, or is installed; or it is a file, "folder/file.py:factory".
    KeyError for a name that is not in the catalogue, ValueError for a module or factory that cannot be
    imported.
    """
    if not is_own(name):
        return CATALOGUE[name]
    factory = import_own(name)
    if not callable(factory):
        raise ValueError(f"{name}: is a {type(factory).__name__}, must be a function that gives a Component")
    return counts_energies(factory)


def import_own(name: str) -> Any:
    """A user's own object, named as "module:object" or "file.py:object"; ValueError where it cannot be
    imported.

    A module lies where the command is called, or is installed. Python's own modules have none of ours.
    """
    module, _, attribute = name.rpartition(":")
    file = module.endswith(".py")
    if not all(part.isidentifier() for part in (*(() if file else module.split(".")), attribute)):
        raise ValueError(f"{name}: must be module:object")
    if not file and module.partition(".")[0] in sys.stdlib_module_names:
        raise ValueError(f"{name}: {module} is a module of Python; name one of your own as module:object")
    try:
        return getattr(_load_file(module) if file else _import_module(module), attribute)
    except (ImportError, AttributeError, OSError) as error:
        raise ValueError(f"{name}: cannot be imported ({error})") from None
    except (Exception, SystemExit) as error:
        raise ValueError(f"{name}: its import fails with {describe_failure(error)}") from None


def describe_failure(error: BaseException) -> str:
    """What an error in a user's own file is, with the line."""
    others = tuple(str(Path(module).parent) for module in (__file__, importlib.__file__))
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames[1:] if not frame.filename.startswith((*others, "<frozen"))]
    place = f" ({Path(own[-1].filename).name}, line {own[-1].lineno})" if own else ""
    return f"{type(error).__name__}: {error}{place}"


def _import_module(name: str) -> ModuleType:
    if (here := os.getcwd()) not in sys.path:
        sys.path.append(here)
    return importlib.import_module(name)


def _load_file(path: str) -> ModuleType:
    """The module of a file, under a name of its own: files of one name may lie in different folders."""
    name = re.sub(r"\W", "_", path)
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError("no Python file")
    sys.modules[name] = module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
