"""Kinds of quantities that many components have: unit, usual size, range, unit on display, plausible size.

Calling one makes a record's field: `length: float = kinds.LENGTH("length of the rod", 0.2)`.
"""

from . import plausible
from .core.quantities import Quantity

# Whatever has the unit.
NUMBER = Quantity("1")
TIME = Quantity("s")
MASS = Quantity("kg")
STIFFNESS = Quantity("N/m")
ENERGY = Quantity("J")
POWER = Quantity("W")

# Parts.
LENGTH = Quantity("m", nominal=0.1, positive=True, display_unit="mm", plausible=plausible.PART_LENGTH)
WIDTH = Quantity("m", nominal=1e-2, positive=True, display_unit="mm", plausible=plausible.PART_LENGTH)
ARM = Quantity("m", nominal=1e-2, display_unit="mm", plausible=plausible.PART_LENGTH)
DIAMETER = Quantity("m", nominal=1e-2, positive=True, display_unit="mm", plausible=plausible.CAM_RADIUS)
ARC = Quantity("m", nominal=1e-2, positive=True, display_unit="mm", plausible=plausible.CURVATURE)
OFFSET = Quantity("m", nominal=1e-3, display_unit="mm", plausible=plausible.OFFSET)
CAM_LIFT = Quantity("m", nominal=1e-2, positive=True, display_unit="mm", plausible=plausible.CAM_LIFT)
LASH = Quantity("m", nominal=1e-4, display_unit="mm", plausible=plausible.LASH)
CLEARANCE = Quantity("m", nominal=1e-5, positive=True, display_unit="um", plausible=plausible.CLEARANCE)
PART_MASS = Quantity("kg", plausible=plausible.PART_MASS)
INERTIA = Quantity("kg.m2", nominal=1e-4, positive=True)
ROD_INERTIA = Quantity("kg.m2", nominal=1e-3, minimum=0.0)
YOUNGS_MODULUS = Quantity("Pa", nominal=1e11, positive=True, plausible=plausible.YOUNGS_MODULUS)
SPRING_RATE = Quantity("N/m", nominal=3e4, positive=True, plausible=plausible.SPRING_RATE)
SEAT_STIFFNESS = Quantity("N/m", plausible=plausible.SEAT_STIFFNESS)
DAMPING = Quantity("N.s/m", minimum=0.0)
TURNING_DAMPING = Quantity("N.m.s", minimum=0.0)
DAMPING_RATIO = Quantity("1", nominal=0.01, minimum=0.0)
FRICTION_COEFFICIENT = Quantity("1", nominal=0.1, minimum=0.0)
VISCOSITY = Quantity("Pa.s", nominal=1e-2, positive=True, plausible=plausible.VISCOSITY)
SWITCH = Quantity("1", boolean=True)

# Motions.
PLACE = Quantity("m", nominal=0.1)
DISTANCE = Quantity("m", nominal=1e-2, display_unit="mm")
DISPLACEMENT = Quantity("m", nominal=1e-3, display_unit="mm")
GAP = Quantity("m", nominal=1e-4, display_unit="um")
DEFLECTION = Quantity("m", nominal=1e-5, display_unit="um")
FILM = Quantity("m", nominal=1e-6, display_unit="um")
VELOCITY = Quantity("m/s")
ACCELERATION = Quantity("m/s2", nominal=1e3)
GRAVITY = Quantity("m/s2", "gravity along the path, towards the cam; 0: not counted", nominal=10.0)
ANGLE = Quantity("rad", display_unit="deg")
PHASE = Quantity("rad", display_unit="deg", plausible=plausible.ANGLE)
LEVER_ANGLE = Quantity("rad", display_unit="deg", plausible=plausible.LEVER_ANGLE)
SPEED = Quantity("rad/s", nominal=100.0, display_unit="rpm")
ROTATION_RATE = Quantity("rad/s", nominal=10.0)
ANGULAR_ACCELERATION = Quantity("rad/s2", nominal=100.0)
TILT = Quantity("rad", nominal=1e-3)
COUNT = Quantity("1", count=True)

# Loads.
FORCE = Quantity("N", nominal=500.0)
WALL_FORCE = Quantity("N", nominal=1e3)
SIDE_FORCE = Quantity("N", nominal=100.0)
FRICTION = Quantity("N", nominal=10.0)
IMPULSE = Quantity("N.s")
TORQUE = Quantity("N.m", nominal=10.0)
FRICTION_TORQUE = Quantity("N.m", nominal=0.1)
PIN_TORQUE = Quantity("N.m", nominal=0.01)
PRESSURE = Quantity("Pa", nominal=1e6, display_unit="MPa")
GAS_PRESSURE = Quantity("Pa", nominal=1e5, display_unit="kPa", plausible=plausible.GAS_PRESSURE)
