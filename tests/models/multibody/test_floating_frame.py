"""Pushrod and rocker arm in a floating frame, Q (3), against finite segments and exact numbers."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.optimize import brentq

from models.core.quantities import Vector
from models.multibody.floating_frame import FloatingBeam, FloatingRod, LinearParts
from models.multibody.joints import fixed
from models.multibody.linear import find_frequencies, find_modes
from models.multibody.mechanism import Mechanism
from models.multibody.pushrod_train import pushrod_train
from models.multibody.shaft import Disc, SegmentedShaft
from models.valve_train.valve_spring import lumping

from .trains import pushrod_parts


def balance_exact_rod(frequency: float) -> float:
    """What keeps the rocker's end moving (N/m): E A k cot(k L) of the exact rod, rocker, valve and spring."""
    parts = pushrod_parts()
    rod, rocker, valve = parts.rod, parts.rocker, parts.valve
    w = 2.0 * math.pi * frequency
    k = w * math.sqrt(rod.density / rod.youngs_modulus)
    share, k0 = lumping(2), float(valve.spring_rate)
    coil = share.mass * k0 / (math.pi * valve.surge_frequency) ** 2
    end, own = share.end_rate * k0, (share.end_rate + share.inner_rate) * k0 - coil * w**2
    spring = end - end**2 * own / (own**2 - (share.inner_rate * k0) ** 2)
    ratio = rocker.valve_arm / rocker.rod_arm
    moved = rocker.inertia / rocker.rod_arm**2 + ratio**2 * valve.valve_mass
    stiffness = rod.youngs_modulus * rod.area * k / math.tan(k * rod.length)
    return float(stiffness - moved * w**2 + ratio**2 * spring)


def find_train_frequencies(shapes: int) -> Vector:
    """Rod, rocker, valve and two masses of the spring, held together by three constraints."""
    parts = pushrod_parts()
    given, rocker, valve = parts.rod, parts.rocker, parts.valve
    rod = FloatingRod(given.length, given.area, given.youngs_modulus, given.density, shapes)
    share, k0 = lumping(2), float(valve.spring_rate)
    coil = share.mass * k0 / (math.pi * valve.surge_frequency) ** 2
    end, inner = share.end_rate * k0, share.inner_rate * k0
    spring = np.array([[end, -end, 0.0], [-end, end + inner, -inner], [0.0, -inner, inner + end]])
    whole = LinearParts(
        block_diag(rod.matrices.mass, rocker.inertia, np.diag([valve.valve_mass, coil, coil])),
        block_diag(rod.matrices.stiffness, 0.0, spring),
    )
    lower, upper = rod.ends
    constraints = np.zeros((3, len(lower) + 4))
    constraints[0, : len(lower)] = lower  # the tappet rests
    constraints[1, : len(lower)], constraints[1, len(lower)] = upper, -rocker.rod_arm
    constraints[2, len(lower) : len(lower) + 2] = rocker.valve_arm, -1.0
    return find_modes(*whole, constraints)


@pytest.mark.long
def test_floating_frame_and_finite_segments_meet_at_the_exact_rod(record: Callable[..., None]) -> None:
    """Six shapes are exact to rounding; segments approach with the square of their number."""
    found = find_train_frequencies(6)[:3]
    for i, value in enumerate(found):
        wanted = brentq(balance_exact_rod, value - 0.05, value + 0.05, xtol=1e-10)
        quantity = f"pushrod in a floating frame: natural frequency {i + 1} (Hz)"
        record("Multibody", quantity, value, wanted, "exact rod", tolerance=1e-8 * wanted)
    errors = []
    for segments in (4, 8):
        mechanism = pushrod_train(pushrod_parts(segments=segments), 0.0)
        errors.append(find_frequencies(mechanism, mechanism.start())[2] - found[2])
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)


STEEL = {"youngs_modulus": 207e9, "density": 7850.0}
# An arm of a rocker (m) that carries a valve (kg); its mass lies in the end of the arm.
ARM, THICK, VALVE = 0.04, 0.012, 0.1


def test_a_beam_on_pins_has_timoshenkos_frequencies(record: Callable[..., None]) -> None:
    """350 mm, 20 mm, A_y = 10/9."""
    beam = FloatingBeam(0.35, 0.02, **STEEL, shapes=14)
    pins = np.array([beam.deflection_at(side * 0.5 * beam.length) for side in (-1.0, 1.0)])
    found = find_modes(*beam.matrices, pins)
    for i, wanted in enumerate((327.953561, 1296.890053, 2865.061822)):
        quantity = f"beam in a floating frame: natural frequency {i + 1} (Hz)"
        record("Multibody", quantity, found[i], wanted, "independent evaluation", tolerance=1e-8 * wanted)


def test_a_rocker_arm_with_its_valve_bends_as_its_finite_segments(record: Callable[..., None]) -> None:
    """Clamped at the hub. The error of the segments falls with the square of their number."""
    beam = FloatingBeam(ARM, THICK, **STEEL, shapes=8)
    mass, end = beam.matrices.mass.copy(), beam.deflection_at(0.5 * ARM)
    mass += VALVE * np.outer(end, end)
    hub = np.array([beam.deflection_at(-0.5 * ARM), beam.turn_at(-0.5 * ARM)])
    frame = find_modes(mass, beam.matrices.stiffness, hub)[0]
    errors = []
    for count in (8, 16):
        stations = [round(ARM * i / count, 9) for i in range(count + 1)]
        arm = SegmentedShaft(stations, THICK, {ARM: Disc(VALVE, 0.0, 0.0)})
        clamp = fixed("hub", "ground", arm.segments[0])
        mechanism = Mechanism(arm.list_bodies(), [clamp], arm.list_beams())
        errors.append(find_frequencies(mechanism, mechanism.start())[0] / frame - 1.0)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    quantity = "rocker arm of 16 segments: natural frequency over that in a floating frame, less 1"
    record("Multibody", quantity, errors[1], 0.0, "floating frame", tolerance=1e-3)
