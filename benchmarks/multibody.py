"""Constrained multibody models: processor time of a turn of Kushwaha's train, and of eight pushrod trains."""

import math
import time

import numpy as np

from models.core.quantities import Layout
from models.multibody.direct_train import direct_train
from models.multibody.ida import solve_ida
from models.multibody.linear import find_rest
from models.multibody.mechanism import Mechanism
from models.multibody.pushrod_engine import pushrod_engine
from models.multibody.pushrod_train import PushrodTrain
from models.multibody.shaft import Disc, SegmentedShaft
from models.valve_train.camshaft import CamshaftParameters
from models.valve_train.rocker import RockerParameters
from models.valve_train.rod import RodParameters
from models.valve_train.tappet import TappetParameters
from models.valve_train.valve_spring import ValveSpringParameters

SPEED_RPM, OMEGA = 1000.0, 1000.0 * math.pi / 30.0
PLACES = (0.03, 0.06, 0.12, 0.15, 0.21, 0.24, 0.30, 0.33)
PHASES = (305.0, 305.0, 35.0, 35.0, 215.0, 215.0, 125.0, 125.0)


def build_direct() -> Mechanism:
    """Kushwaha's train on its elastic shaft."""
    camshaft, valve = Layout(CamshaftParameters).defaults(), Layout(ValveSpringParameters).defaults()
    camshaft.flexible = 1.0
    return direct_train(camshaft, valve, OMEGA)


def build_engine() -> Mechanism:
    """Eight trains with pushrods of four segments on a shaft of segments of 30 mm."""
    trains = []
    for k, (place, degrees) in enumerate(zip(PLACES, PHASES, strict=True), 1):
        tappet, rod, rocker, valve = (
            Layout(kind).defaults()
            for kind in (TappetParameters, RodParameters, RockerParameters, ValveSpringParameters)
        )
        tappet.phase, rod.bonded, rocker.small_motion, valve.valve_mass = math.radians(degrees), 1.0, 1.0, 0.1
        parts = PushrodTrain(tappet, rod, rocker, valve, place=place, mark=f" {k}")
        start = parts.follow_cam()
        trains.append(PushrodTrain(tappet, rod, rocker, valve, place=place, mark=f" {k}", start=start))
    stations = [*(round(0.03 * i, 9) for i in range(12)), 0.35]
    discs = dict.fromkeys(PLACES, Disc(0.1, 0.7e-4, 1.2e-4))
    return pushrod_engine(SegmentedShaft(stations, 0.02, discs, damping_time=1.37e-5), trains, OMEGA)


def turn(mechanism: Mechanism, tolerance: float, resting: bool = False) -> float:
    """Processor time (s) of one turn, after one that compiles."""
    times, start = np.linspace(0.0, 60.0 / SPEED_RPM, 721), find_rest(mechanism) if resting else None
    solve_ida(mechanism, times[:3], tolerance, start)
    begun = time.process_time()
    solve_ida(mechanism, times, tolerance, start)
    return time.process_time() - begun


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    direct, engine = build_direct(), build_engine()
    return [
        ("multibody: a turn of Kushwaha's train at 1e-8, processor time", f"{turn(direct, 1e-8):.2f} s"),
        (
            f"multibody: a turn of 8 pushrod trains, {len(engine.bodies)} bodies, at 1e-7, processor time",
            f"{turn(engine, 1e-7, resting=True):.1f} s",
        ),
    ]
