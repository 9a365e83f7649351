"""Q's whole train: eight single trains on a shaft of Timoshenko segments, against independent numbers."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from models.core.quantities import Vector
from models.core.system import ModelError
from models.multibody.ida import solve_ida
from models.multibody.linear import find_frequencies, find_rest
from models.multibody.mechanism import Mechanism
from models.multibody.pushrod_engine import pushrod_engine
from models.multibody.pushrod_train import CAM, TIP
from models.multibody.shaft import DRIVE, Disc, SegmentedShaft

from .trains import pushrod_parts

EVALUATION = "independent evaluation"
PLACES = (0.03, 0.06, 0.12, 0.15, 0.21, 0.24, 0.30, 0.33)
PHASES = [math.radians(degrees) for degrees in (305, 305, 35, 35, 215, 215, 125, 125)]
DISC = Disc(0.1, 0.7e-4, 1.2e-4)
SPEED_RPM, OMEGA = 1000.0, 1000.0 * math.pi / 30.0
REVOLUTIONS = 5


def segmented_shaft(segment: float) -> SegmentedShaft:
    """Stations every `segment` (m) up to the last cam, and at the free end."""
    count = round(0.33 / segment)
    stations = [*(round(segment * i, 9) for i in range(count + 1)), 0.35]
    discs = dict.fromkeys(PLACES, DISC)
    return SegmentedShaft(stations, 0.02, discs, damping_time=1.370291042e-5)


def engine(speed: float, preload: float = 330.0, segment: float = 0.03) -> Mechanism:
    """All parts where their cams have them, the pushrods unloaded."""
    trains = []
    for k, (place, phase) in enumerate(zip(PLACES, PHASES, strict=True), 1):
        parts = pushrod_parts(preload, phase, place=place, mark=f" {k}")
        trains.append(pushrod_parts(preload, phase, place=place, mark=f" {k}", start=parts.follow_cam()))
    return pushrod_engine(segmented_shaft(segment), trains, speed)


def compare_segments(record: Callable[..., None], found: list[Vector], expected: Vector, *case: str) -> None:
    """Errors of two lengths of segments, one half of the other."""
    coarse, fine = (np.abs(values / expected - 1.0) for values in found)
    np.testing.assert_allclose(coarse / fine, 4.0, rtol=0.05)
    for i, (value, wanted) in enumerate(zip(found[1], expected, strict=True)):
        quantity = f"shaft of segments of {case[0]}: natural frequency {i + 1} of {case[1]} (Hz)"
        record("Multibody", quantity, value, wanted, EVALUATION, tolerance=4e-4 * wanted)


def test_torsion_of_the_shaft_converges_with_the_square_of_its_segments(record: Callable[..., None]) -> None:
    """The shaft alone, turning in bearings."""
    expected = np.array([464.58727, 1370.85610, 2198.60528])
    found = []
    for segment in (0.03, 0.015):
        shaft = segmented_shaft(segment)
        joints = [*shaft.list_bearings(), shaft.drive(0.0)]
        alone = Mechanism(shaft.list_bodies(), joints, shaft.list_beams())
        found.append(find_frequencies(alone, alone.start())[:3])
    compare_segments(record, found, expected, "15 mm", "torsion")


@pytest.mark.long
def test_bending_of_the_shaft_converges_with_the_square_of_its_segments(record: Callable[..., None]) -> None:
    """Pinned at both ends, with eight cams as discs; its modes come in pairs, one for each plane."""
    expected = np.array([234.810913, 896.319914, 1882.38922])
    found = []
    for count in (35, 70):
        stations = [round(0.35 * i / count, 9) for i in range(count + 1)]
        shaft = SegmentedShaft(stations, 0.02, dict.fromkeys(PLACES, DISC))
        joints = [*shaft.list_pins(), shaft.drive(0.0)]
        pinned = Mechanism(shaft.list_bodies(), joints, shaft.list_beams())
        every = find_frequencies(pinned, pinned.start())
        found.append(np.array([every[np.argsort(np.abs(every - wanted))[:2]].mean() for wanted in expected]))
    compare_segments(record, found, expected, "5 mm", "bending")


@pytest.mark.long
def test_frequencies_of_eight_trains_on_the_shaft(record: Callable[..., None]) -> None:
    """At the shaft angle 0, without the stiffness W s''. The segments leave 6e-5 of the shaft's torsion."""
    mechanism = engine(0.0)
    counts = 6 * len(mechanism.bodies), len(mechanism.constraint_names), mechanism.freedoms
    assert counts == (510, 442, 68)
    found = find_frequencies(mechanism, mechanism.start(), loaded=False)
    for expected in (418.82924, 504.02461, 507.02364, 1008.64867):
        value = found[np.argmin(np.abs(found - expected))]
        quantity = f"8 pushrod trains on a shaft: natural frequency {expected:.0f} Hz"
        record("Multibody", quantity, value, expected, EVALUATION, tolerance=6e-5 * expected)


@pytest.mark.long
def test_the_cycle_of_eight_trains_on_the_shaft(record: Callable[..., None]) -> None:
    """Torque, twists and loads over a turn, with 330 N at a resting valve. Segments of 15 mm."""
    resting = engine(OMEGA)
    first = find_rest(resting).multipliers[resting.find_rows(f"{TIP} 1")][0]
    mechanism = engine(OMEGA, 660.0 - first, segment=0.015)
    turn = 60.0 / SPEED_RPM
    times = np.append(0.0, np.linspace(REVOLUTIONS - 1, REVOLUTIONS, 2881) * turn)
    motion = solve_ida(mechanism, times, 1e-7, find_rest(mechanism))
    driven = OMEGA * motion.times
    twists = [1e3 * np.degrees(motion.angles(f"shaft at {place} mm")[:, 2] - driven) for place in (30, 330)]
    found = {
        "drive torque (N m)": (motion.multiplier(DRIVE)[:, 0], (-1.40747, 1.39591)),
        "twist of the first cam (mdeg)": (twists[0], (-1.918, 1.934)),
        "twist of the last cam (mdeg)": (twists[1], (-110.073, 112.000)),
        "load of the first cam (N)": (motion.load(f"{CAM} 1"), (410.582, 851.342)),
        "load of the last cam (N)": (motion.load(f"{CAM} 8"), (410.622, 851.348)),
    }
    for name, (values, expected) in found.items():
        for which, value, wanted in zip(
            ("least", "largest"), (values[1:].min(), values[1:].max()), expected, strict=True
        ):
            quantity = f"8 pushrod trains: {which} {name}"
            record("Multibody", quantity, value, wanted, EVALUATION, tolerance=5e-4 * abs(wanted))


def test_a_disc_without_a_station_is_refused() -> None:
    with pytest.raises(ModelError, match=r"disc at 0\.1 m: no station is there; there are 0, 0\.2 m"):
        SegmentedShaft([0.0, 0.2], 0.02, {0.1: DISC})
    with pytest.raises(ModelError, match="must be two or more, ascending"):
        SegmentedShaft([0.2, 0.0], 0.02, {})
