"""The numbers behind the statements."""

import math
from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from models.catalogue import CATALOGUE
from models.core.quantities import Vector
from models.valve_train.beam import Disc, Shaft, bending_matrices, find_bending, find_torsion

from ..statement import Values
from .runs import EXHAUST, HEAD_AREA, HIGH, INTAKE, LOW, NO_AREA, RATED, SLOW, Runs

SEGMENTS = (2, 4, 8)
# A steel rod, and a shaft of round section.
ROD = {"length": 0.2, "area": 50e-6, "youngs_modulus": 207e9, "density": 7850.0}
SHAFT = Shaft(0.1, 0.02, (), (), shear_coefficient=0.9)
BEAM_LENGTH = 0.4


def compare_with_kinematics(runs: Runs) -> Values:
    """Largest deviation of the valve from its slow motion, and the share of the turn without contact."""
    found = {
        f"{word}_deviation": float(np.abs(runs.deviate(speed)).max())
        for word, speed in (("low", LOW), ("rated", RATED), ("high", HIGH))
    }
    loads = {
        word: runs.cycle(speed)["cam_contact.load"] for word, speed in (("rated", RATED), ("high", HIGH))
    }
    return found | {
        "rated_load": float(loads["rated"].min()),
        "high_lost": float(np.mean(loads["high"] <= 0.0)),
        "rated_rpm": RATED,
        "high_rpm": HIGH,
    }


def compare_blow(runs: Runs) -> Values:
    """Extremes of the cam's load at the high speed, and those of a train that is rigid and never parts (N).

    The load of the latter is a parabola of the speed at each angle, found from the slow and the rated cycle.
    """
    slow, rated, high = (runs.cycle(speed)["cam_contact.load"] for speed in (SLOW, RATED, HIGH))
    rigid = slow + (rated - slow) * (HIGH**2 - SLOW**2) / (RATED**2 - SLOW**2)
    return {
        "rigid_least": float(rigid.min()),
        "rigid_largest": float(rigid.max()),
        "largest": float(high.max()),
    }


def refine_pushrod(runs: Runs) -> Values:
    """Largest changes of the valve's acceleration (m/s2) and the cam's load (N) with twice the segments."""
    cycles = [runs.cycle(RATED, segments) for segments in (1, *SEGMENTS)]
    accelerations, loads = (
        np.array([cycle[name] for cycle in cycles])
        for name in ("valve_spring.acceleration", "cam_contact.load")
    )
    return {
        "accelerations": np.abs(np.diff(accelerations, axis=0)).max(axis=1).tolist(),
        "loads": np.abs(np.diff(loads, axis=0)).max(axis=1).tolist(),
        "acceleration": float(np.abs(accelerations).max()),
    }


def compare_forces(runs: Runs) -> Values:
    """Largest forces at the rated speed (N)."""
    cycle, slow = runs.cycle(RATED), runs.cycle(SLOW)
    contacts = ("cam_contact", "valve_contact")
    return {
        "spring": float(cycle["valve_spring.spring_force"].max()),
        "friction": max(float(np.abs(cycle[f"{name}.friction_force"]).max()) for name in contacts),
        "inertia": float(np.abs(cycle["cam_contact.load"] - slow["cam_contact.load"]).max()),
    }


def compute_rods(runs: Runs) -> Values:
    """Static rate and first frequency of rods of segments, fixed below and free above, over the exact."""
    exact = math.sqrt(ROD["youngs_modulus"] / ROD["density"]) / (4.0 * ROD["length"])
    rate = ROD["youngs_modulus"] * ROD["area"] / ROD["length"]
    stiffness = [_rod_matrix(n) for n in SEGMENTS]
    mass = [ROD["density"] * ROD["area"] * ROD["length"] / n for n in SEGMENTS]
    return {
        "frequency_errors": [
            math.sqrt(np.linalg.eigvalsh(k)[0] / m) / (2.0 * math.pi) / exact - 1.0
            for k, m in zip(stiffness, mass, strict=True)
        ],
        # The force at the end passes the half segment above the last centre, too.
        "rates": [
            1.0 / (np.linalg.inv(k)[-1, -1] + 1.0 / (2.0 * n * rate)) / rate
            for k, n in zip(stiffness, SEGMENTS, strict=True)
        ],
    }


def _rod_matrix(segments: int) -> Vector:
    """Stiffness of the component's segments (N/m), fixed below, without the last half segment."""
    component = CATALOGUE["rod"](segments=segments)
    free = {**ROD, "bonded": 1.0, "damping_time": 0.0}
    p, u = component.parameters.vector(free), component.inputs.vector()
    mass = ROD["density"] * ROD["area"] * ROD["length"] / segments
    found, dx = np.empty((segments, segments)), component.state.vector()
    for i in range(segments):
        x = component.state.vector({f"displacement[{i + 1}]": 1.0})
        component.flat_derivative(0.0, x, u, p, dx)
        rates = component.state.named(dx)
        found[:, i] = [-mass * rates[f"velocity[{k + 1}]"] for k in range(segments)]
    found[-1, -1] -= 2.0 * segments * ROD["youngs_modulus"] * ROD["area"] / ROD["length"]
    return found


def compute_connector(runs: Runs) -> Values:
    """Tip flexibility of the printed K and of a Timoshenko beam."""
    second, area, length = SHAFT.second_moment, SHAFT.area, SHAFT.length
    bending, shear = SHAFT.youngs_modulus * second, SHAFT.shear_coefficient * SHAFT.shear_modulus * area
    P = 12.0 * bending / (shear * length**2)
    printed = (
        bending
        / (1.0 + P)
        * np.array([[12.0 / length**3, -6.0 / length**2], [-6.0 / length**2, (4.0 + P) / length]])
    )
    K, _, _ = bending_matrices(SHAFT, np.array([0.0, length]))
    return {
        "printed_flexibility": float(np.linalg.inv(printed)[0, 0]),
        "beam_flexibility": float(np.linalg.inv(K[2:4, 2:4])[0, 0]),
        "asymmetry": float(np.abs(K - K.T).max() / np.abs(K).max()),
    }


def compute_beams(runs: Runs) -> Values:
    """First frequency of free beams of rigid segments over that of the continuous beam, less 1.

    Neighbours are joined by one connector between their centres, or by two in series, as printed.
    """
    # Of a free shaft the first two modes are rigid motions.
    exact = find_bending(replace(SHAFT, length=BEAM_LENGTH, journals=(0.0, BEAM_LENGTH)), 1).frequency[2]
    return {
        name: [_find_beam_frequency(n, connectors) / exact - 1.0 for n in SEGMENTS]
        for name, connectors in (("one", 1), ("two", 2))
    }


def _find_beam_frequency(segments: int, connectors: int) -> float:
    """Angular, of a free beam; so many equal connectors in series share the stiffness."""
    length = BEAM_LENGTH / segments
    joint = bending_matrices(SHAFT, np.array([0.0, length]))[0] / connectors
    mass = SHAFT.density * SHAFT.area * length
    inertia = SHAFT.density * SHAFT.second_moment * length + mass * length**2 / 12.0
    stiffness = np.zeros((2 * segments, 2 * segments))
    for i in range(segments - 1):
        stiffness[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += joint
    return float(np.sqrt(eigh(stiffness, np.diag([mass, inertia] * segments), eigvals_only=True)[2]))


def superpose_modes(runs: Runs) -> Values:
    """Twist of a shaft's free end under a torque there, of the lowest modes and of all, over T L/(G J)."""
    modes = find_torsion(replace(SHAFT, discs=(Disc(SHAFT.length, 0.0, 0.0, 0.0),)), 3)
    twist = SHAFT.length / (SHAFT.shear_modulus * 2.0 * SHAFT.second_moment)
    parts = modes.shape[:, 0] ** 2 / (modes.mass * modes.frequency**2) / twist
    sums = np.cumsum(parts)
    return {"lowest": sums[:3].tolist(), "all": float(sums[-1])}


def compare_gas(runs: Runs) -> Values:
    """Largest load of a cam, of an exhaust and an intake valve, and without gas on the valve's head; and the
    largest force of the gas on an exhaust valve off its seat (N)."""
    cases = {
        "exhaust": (EXHAUST, HEAD_AREA),
        "intake": (INTAKE, HEAD_AREA),
        "without_gas": (EXHAUST, NO_AREA),
    }
    loads = {name: float(runs.gas(*case)["contact.load"].max()) for name, case in cases.items()}
    exhaust = runs.gas(EXHAUST, HEAD_AREA)
    opened = exhaust["valve_spring.seat_dip"] < 0.0
    return loads | {"gas": float(exhaust["gas.valve_force[1]"][opened].max())}
