"""The contact of the set kushwaha2000 in round numbers, on grids that are coarse enough for tests."""

from __future__ import annotations

import functools

from models.contact.analysis.finite_line.contact import FiniteLine, Running
from models.contact.analysis.finite_line.dry import dry
from models.contact.analysis.finite_line.grid import Resolution
from models.contact.analysis.finite_line.profiles import Straight
from models.contact.analysis.finite_line.steady import steady
from models.contact.fluid import Lubricant
from models.contact.hertz import elastic_compliance

STEEL = elastic_compliance(207e9, 0.3, 207e9, 0.3)
OIL = Lubricant(viscosity=0.036, pressure_viscosity=1.8e-8)
LENGTH = 12e-3
STRAIGHT = FiniteLine(LENGTH, STEEL, OIL, Straight())
AT = Running(load=500.0, velocity=0.5, radius=20e-3)
# The fewest nodes that give no warning; a second for a film.
COARSE = Resolution(nodes_per_half_width=12.0, end_cell=0.2, growth=0.3, fewest_lines=24)

film_of = functools.cache(steady)
dry_of = functools.cache(dry)
