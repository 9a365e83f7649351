"""Trains as bodies and joints: K's with 21 constraints, Q's of rigid and of elastic parts."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.multibody.direct_train import direct_train
from models.multibody.ida import solve_ida
from models.multibody.linear import find_frequencies
from models.multibody.pushrod_train import CAM, DRIVE, PIVOT, ROD_END, SEAT, TIP, PushrodTrain
from models.valve_train.cams.law import law_lift

from .projected import solve_projected

TURNED = SimpleNamespace(angle=0.0)


def list_records(**sizes: dict[str, int]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Parameters and states at rest of components with these sizes."""
    made = {name: CATALOGUE[name](**size) for name, size in sizes.items()}
    states = {name: component.state.defaults() for name, component in made.items()}
    return {n: c.parameters.defaults() for n, c in made.items()}, {**states, "flywheel": TURNED}


def test_parts_joints_and_freedoms_are_those_of_ks_tables_1_and_2():
    parts, states = list_records(camshaft={}, valve_spring={"coil_masses": 2})
    parts["camshaft"].flexible = 1.0
    mechanism = direct_train(parts, states, turning(1000.0))
    assert [len(joint.constraints) for joint in mechanism.joints] == [4, 1, 1, 5, 5, 5]
    # The shaft slides in its bearing, the cam has six but the contact, follower and coils share three.
    assert (len(mechanism.bodies), mechanism.freedoms) == (5, 9)


RATIO, MASS, ROD_MASS, INERTIA, ARM = 1.25, 0.1, 7850.0 * 50e-6 * 0.2, 6e-5, 32e-3
EVALUATION = "independent evaluation"


def pushrod_parts(segments: int, coil_masses: int = 2) -> PushrodTrain:
    """The train P1: bonded pushrod, constant lever ratio, set `kushwaha2000` with a valve of 0.1 kg."""
    parts, states = list_records(
        tappet={}, rod={"segments": max(1, segments)}, rocker={}, valve_spring={"coil_masses": 2}
    )
    states["valve_spring"] = SimpleNamespace(position=0.0, coil_position=[0.0] * coil_masses)
    parts["pushrod"], states["pushrod"] = parts["rod"], states["rod"]
    parts["pushrod"].bonded, parts["rocker"].small_motion = 1.0, 1.0
    parts["valve_spring"].valve_mass, parts["valve_spring"].preload = 0.1, 330.0
    return PushrodTrain(parts, states, segments, coil_masses)


def turning(speed_rpm: float) -> float:
    return speed_rpm * math.pi / 30.0


@pytest.mark.parametrize("method", [solve_ida, solve_projected], ids=["IDA", "projected DOP853"])
def test_loads_of_rigid_parts_are_the_closed_form(method, record):
    """W = i (f_p + k0 i s) + (m_t + m_rod + J/a^2 + i^2 m_v) s'' Omega^2, drive torque W s'."""
    train, omega = pushrod_parts(segments=0, coil_masses=0), turning(1600.0)
    train.parts["valve_spring"].damping_ratio = 0.0
    times = np.linspace(0.0, 2.0 * math.pi / omega, 181)
    motion = method(train.build(omega), times)
    lift = [law_lift(omega * t, train.parts["tappet"]) for t in times]
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
    assert pushrod_parts(segments=0).build(1.0).freedoms == 2
    assert pushrod_parts(segments=4).build(1.0).freedoms == 2 + 5


@pytest.mark.parametrize(
    ("segments", "expected"),
    [(4, (504.12796, 1008.78230, 2334.309)), (16, (504.12793, 1008.78222, 2332.77579))],
    ids=["4 segments", "exact rod"],
)
def test_natural_frequencies_of_the_train_on_a_resting_cam(segments, expected, record):
    """Of the reduced constrained equations; sixteen segments are 1/16 as far from the exact rod as four."""
    mechanism = pushrod_parts(segments=segments).build(0.0)
    found = find_frequencies(mechanism, mechanism.start())
    for i, (value, wanted) in enumerate(zip(found, expected, strict=False)):
        quantity = f"pushrod of {segments} segments: natural frequency {i + 1} (Hz)"
        tolerance = 1e-6 if segments == 4 else 6e-5
        record("Multibody", quantity, value, wanted, EVALUATION, tolerance=tolerance * wanted)
