"""Q's single train of rigid and of elastic parts, against closed forms and independent numbers."""

import math

import numpy as np
import pytest

from models.multibody.ida import solve_ida
from models.multibody.linear import find_frequencies, find_rest
from models.multibody.mechanism import Mechanism
from models.multibody.pushrod_train import CAM, DRIVE, PIVOT, ROD_END, SEAT, TIP, pushrod_train
from models.valve_train.cams.law import law_lift

from .projected import solve_projected
from .trains import pushrod_parts

RATIO, MASS, ROD_MASS, INERTIA, ARM = 1.25, 0.1, 7850.0 * 50e-6 * 0.2, 6e-5, 32e-3
EVALUATION = "independent evaluation"
# Loads at the cam and at the valve (N), least and largest over a turn.
LOADS = {1000.0: (410.582, 851.34, 328.996, 680.544), 1600.0: (404.055, 857.199, 325.440, 683.573)}
REVOLUTIONS = 6
# Vibrations of 504 Hz between two instants: 1e-5 of the loads.
POINTS = 5761


def turning(speed_rpm: float) -> float:
    return speed_rpm * math.pi / 30.0


@pytest.mark.parametrize("method", [solve_ida, solve_projected], ids=["IDA", "projected DOP853"])
def test_loads_of_rigid_parts_are_the_closed_form(method, record):
    """W = i (f_p + k0 i s) + (m_t + m_rod + J/a^2 + i^2 m_v) s'' Omega^2, drive torque W s'."""
    parts, omega = pushrod_parts(segments=0, coil_masses=0), turning(1600.0)
    parts.valve.damping_ratio = 0.0
    times = np.linspace(0.0, 2.0 * math.pi / omega, 181)
    motion = method(pushrod_train(parts, omega), times)
    lift = [law_lift(omega * t, parts.tappet) for t in times]
    s, ds, dds = (np.array([getattr(x, name) for x in lift]) for name in ("s", "ds", "dds"))
    moving = MASS + ROD_MASS + INERTIA / ARM**2 + RATIO**2 * MASS
    cam = RATIO * (330.0 + 35e3 * RATIO * s) + moving * dds * omega**2
    tip = 330.0 + 35e3 * RATIO * s + MASS * RATIO * dds * omega**2
    rod = cam - (MASS + ROD_MASS) * dds * omega**2
    found = {
        "load of the cam": (motion.load(CAM), cam),
        "load of the valve": (motion.load(TIP), tip),
        "load of the rocker's end": (motion.load(ROD_END), rod),
        "load of the pushrod's seat": (motion.load(SEAT), rod + ROD_MASS * dds * omega**2),
        "drive torque": (motion.multiplier(DRIVE)[:, 0], cam * ds),
        "force on the pivot": (-motion.reaction(PIVOT).force[:, 1], rod + tip),
    }
    for name, (value, expected) in found.items():
        error = np.max(np.abs(value - expected)) / np.max(np.abs(expected))
        quantity = f"rigid pushrod train: {name}, error over largest"
        record("Multibody", quantity, error, 0.0, "closed form", tolerance=2e-7)


def test_joints_of_the_train_leave_what_is_elastic():
    """On a driven cam a rigid train keeps the freedoms of its coils; an elastic pushrod adds five."""
    assert pushrod_train(pushrod_parts(segments=0), 1.0).freedoms == 2
    assert pushrod_train(pushrod_parts(segments=4), 1.0).freedoms == 2 + 5


@pytest.mark.parametrize(
    ("segments", "expected"),
    [(4, (504.12796, 1008.78230, 2334.309)), (16, (504.12793, 1008.78222, 2332.77579))],
    ids=["4 segments", "exact rod"],
)
def test_natural_frequencies_of_the_train_on_a_resting_cam(segments, expected, record):
    """Of the reduced constrained equations; sixteen segments are 1/16 as far from the exact rod as four."""
    mechanism = pushrod_train(pushrod_parts(segments=segments), 0.0)
    found = find_frequencies(mechanism, find_rest(mechanism))
    for i, (value, wanted) in enumerate(zip(found, expected, strict=False)):
        quantity = f"pushrod of {segments} segments: natural frequency {i + 1} (Hz)"
        tolerance = 1e-6 if segments == 4 else 6e-5
        record("Multibody", quantity, value, wanted, EVALUATION, tolerance=tolerance * wanted)


def loaded_train(speed_rpm: float) -> Mechanism:
    """With 330 N at the resting valve: the preload makes up for the pushrod's compression."""
    first = pushrod_train(pushrod_parts(), turning(speed_rpm))
    resting = find_rest(first).multipliers[first.find_rows(TIP)][0]
    return pushrod_train(pushrod_parts(preload=660.0 - resting), turning(speed_rpm))


@pytest.mark.long
@pytest.mark.parametrize("speed_rpm", [1000.0, 1600.0])
def test_loads_of_the_train_on_an_elastic_pushrod(speed_rpm, record):
    mechanism, turn = loaded_train(speed_rpm), 60.0 / speed_rpm
    times = np.append(0.0, np.linspace(REVOLUTIONS - 1, REVOLUTIONS, POINTS) * turn)
    # At 1e-8 single loads between IDA's steps are off by up to 2e-4.
    motion = solve_ida(mechanism, times, 1e-9, find_rest(mechanism))
    found = [f(motion.load(contact)[1:]) for contact in (CAM, TIP) for f in (np.min, np.max)]
    names = ("least cam load", "largest cam load", "least valve load", "largest valve load")
    for name, value, expected in zip(names, found, LOADS[speed_rpm], strict=True):
        quantity = f"elastic pushrod train at {speed_rpm:g} r/min: {name} (N)"
        # Its two evaluations, by Fourier series and in time, agree to 4e-5.
        record("Multibody", quantity, value, expected, EVALUATION, tolerance=4e-5 * expected)
