"""Magnitudes of parameters in practice, to notice values in a wrong unit.

Each range is wide: it says what engines and their valve trains have, not what is a good design.
"""

import math

from .core.quantities import Plausible

_MASS = (("g", 1e-3),)
_LENGTH = (("mm", 1e-3), ("um", 1e-6))
_STIFFNESS = (("N/mm", 1e3),)
_ANGLE = (("deg", math.pi / 180.0),)
_PRESSURE = (("MPa", 1e6), ("GPa", 1e9), ("bar", 1e5), ("kPa", 1e3))

SPEED = Plausible(
    0.0, 300.0 * math.pi, (("rpm", math.pi / 30.0),), "engines of production cars turn at 9000 rpm at most"
)
ANGLE = Plausible(0.0, 4.0 * math.pi, _ANGLE, "a four-stroke cycle has 720 deg")
TURN = Plausible(0.0, 2.0 * math.pi, _ANGLE, "a turn has 360 deg")
GROOVE = Plausible(0.0, 0.5 * math.pi, _ANGLE, "grooves of bearings are narrower than 90 deg")
LEVER_ANGLE = Plausible(0.0, 0.5 * math.pi, _ANGLE, "levers rest within 90 deg of the level")
RAMP = Plausible(1e-6, 10.0, (("ms", 1e-3),), "runs of these models last some seconds at most")

VALVE_MASS = Plausible(5e-3, 5.0, _MASS, "valves with their followers have 5 g to 5 kg")
PART_MASS = Plausible(5e-3, 50.0, _MASS, "cams, rods and pistons of engines have 5 g to 50 kg")
SPRING_RATE = Plausible(1e3, 1e6, _STIFFNESS, "valve springs have 1 to 1000 N/mm")
PRELOAD = Plausible(
    1.0, 2e4, (("N", 1.0), ("kN", 1e3)), "valve springs press with 1 N to 20 kN on closed valves"
)
SEAT_STIFFNESS = Plausible(1e5, 1e11, _STIFFNESS, "seats and coils of metal have 100 N/mm at least")
SURGE_FREQUENCY = Plausible(30.0, 10e3, (("kHz", 1e3),), "valve springs surge at 30 Hz to 10 kHz")

LASH = Plausible(1e-6, 5e-3, _LENGTH, "valves have a few tenths of a millimetre of lash")
CAM_LIFT = Plausible(1e-4, 0.1, _LENGTH, "cams lift by 0.1 to 100 mm")
PART_LENGTH = Plausible(1e-3, 2.0, _LENGTH, "parts of engines measure 1 mm to 2 m")
CAM_RADIUS = Plausible(1e-3, 0.5, _LENGTH, "cams and their shafts measure 1 to 500 mm")
# Below 10 m: pads and rollers of 10 mm are usual.
CURVATURE = Plausible(1e-4, 5.0, _LENGTH, "contacts have radii of 0.1 mm to 5 m")
WIRE = Plausible(1e-4, 0.02, _LENGTH, "wires of springs measure 0.1 to 20 mm")
PLAY = Plausible(1e-7, 0.02, _LENGTH, "pistons have 0.1 um to 20 mm of play")
CLEARANCE = Plausible(
    1e-7, 1e-3, (("um", 1e-6), ("mm", 1e-3)), "plungers, guides and bearings have 0.1 um to 1 mm of clearance"
)
OFFSET = Plausible(1e-5, 0.2, _LENGTH, "pins and centres of mass lie 0.01 to 200 mm off")
AREA = Plausible(1e-8, 1e-2, (("mm2", 1e-6),), "sections of rods measure 0.01 to 10000 mm2")
VOLUME = Plausible(1e-11, 1e-3, (("mm3", 1e-9),), "oil chambers hold 0.01 mm3 to a litre")
FILM = Plausible(1e-10, 1e-4, (("um", 1e-6), ("nm", 1e-9)), "films have 0.1 nm to 100 um")

YOUNGS_MODULUS = Plausible(1e6, 2e12, (("GPa", 1e9), ("MPa", 1e6)), "solids have 1 MPa to 2000 GPa")
YIELD_PRESSURE = Plausible(1e7, 1e11, _PRESSURE, "metals and ceramics yield at 10 MPa to 100 GPa")
SHEAR_STRESS = Plausible(1e4, 1e10, _PRESSURE, "oils and boundary films shear at 10 kPa to 10 GPa")
GAS_PRESSURE = Plausible(1e3, 1e8, _PRESSURE, "gas in engines has 1 kPa to 100 MPa")

# SAE J300: no engine oil is thinner than 1.7 mPa.s in a hot bearing; thicker than 5 Pa.s it hardly flows.
VISCOSITY = Plausible(2e-4, 5.0, (("mPa.s", 1e-3),), "lubricants have 0.2 mPa.s to 5 Pa.s")
PRESSURE_VISCOSITY = Plausible(1e-10, 1e-6, (("1/GPa", 1e-9),), "lubricants have 0.1 to 1000 1/GPa")
