"""The components by name, as scenarios and FMU builds ask for them."""

from __future__ import annotations

import functools
import importlib
import os
import sys
from collections.abc import Callable, Mapping

from .contact.ehl_contact import ehl_contact
from .contact.ehl_line_contact import ehl_line_contact
from .core.component import Component
from .flywheel import flywheel
from .oscillators.bouncing_mass import falling_mass, spring_stop
from .oscillators.quarter_car import quarter_car_chassis, quarter_car_wheel
from .oscillators.two_masses import coupled_mass, sprung_mass
from .slider_crank.piston.cylinder_gas import cylinder_gas
from .slider_crank.piston.free_piston_crank import free_piston_crank
from .slider_crank.piston.piston_crank import piston_crank
from .slider_crank.slider_crank import slider_crank
from .valve_train.camshaft import camshaft
from .valve_train.coil_spring import coil_spring
from .valve_train.finger import finger
from .valve_train.journal_bearing import journal_bearing
from .valve_train.lash_adjuster import lash_adjuster
from .valve_train.multibody_valve_train import multibody_valve_train
from .valve_train.pad_friction import pad_friction
from .valve_train.pivot_friction import pivot_friction
from .valve_train.rocker import rocker
from .valve_train.rod import rod
from .valve_train.roller import roller
from .valve_train.shaft import shaft
from .valve_train.tappet import tappet
from .valve_train.valve import valve
from .valve_train.valve_spring import valve_spring

# Each factory takes its structural sizes by keyword, e.g. valve_spring(coil_masses=8).
CATALOGUE: Mapping[str, Callable[..., Component]] = {
    "camshaft": camshaft,
    "valve_spring": valve_spring,
    "valve": valve,
    "coil_spring": coil_spring,
    "shaft": shaft,
    "journal_bearing": journal_bearing,
    "tappet": tappet,
    "finger": finger,
    "rod": rod,
    "rocker": rocker,
    "pivot_friction": pivot_friction,
    "pad_friction": pad_friction,
    "roller": roller,
    "lash_adjuster": lash_adjuster,
    "multibody_valve_train": multibody_valve_train,
    "ehl_contact": ehl_contact,
    "ehl_line_contact": ehl_line_contact,
    "flywheel": flywheel,
    "slider_crank": slider_crank,
    "piston_crank": piston_crank,
    "free_piston_crank": free_piston_crank,
    "cylinder_gas": cylinder_gas,
    "quarter_car_chassis": quarter_car_chassis,
    "quarter_car_wheel": quarter_car_wheel,
    "coupled_mass": coupled_mass,
    "sprung_mass": sprung_mass,
    "falling_mass": falling_mass,
    "spring_stop": spring_stop,
}


def is_own(name: str) -> bool:
    """Whether the name is that of a user's own component, "module:factory"."""
    return ":" in name


def identify(name: str) -> str:
    """The name by which an FMU is called: that of the component, of a user's own that of its factory."""
    return name.rpartition(":")[2]


@functools.cache
def find_factory(name: str) -> Callable[..., Component]:
    """The factory of a component of the catalogue, or of a user's own as "module:factory".

    The module lies where the command is called, or is installed. KeyError for a name that is not in the
    catalogue, ValueError for a module or factory that cannot be imported.
    """
    if not is_own(name):
        return CATALOGUE[name]
    module, _, attribute = name.partition(":")
    if (here := os.getcwd()) not in sys.path:
        sys.path.append(here)
    try:
        factory: Callable[..., Component] = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise ValueError(f"{name}: cannot be imported ({error})") from None
    return factory
