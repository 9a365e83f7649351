"""Mechanisms that tests share."""

from models.core.quantities import Layout
from models.multibody.pushrod_train import PushrodTrain
from models.valve_train.rocker import RockerParameters
from models.valve_train.rod import RodParameters
from models.valve_train.tappet import TappetParameters
from models.valve_train.valve_spring import ValveSpringParameters


def pushrod_parts(preload: float = 330.0, **options: object) -> PushrodTrain:
    """The train P1: bonded pushrod, constant lever ratio, set `kushwaha2000` with a valve of 0.1 kg."""
    tappet, rod, rocker, valve = (
        Layout(kind).defaults()
        for kind in (TappetParameters, RodParameters, RockerParameters, ValveSpringParameters)
    )
    rod.bonded, rocker.small_motion, valve.valve_mass, valve.preload = 1.0, 1.0, 0.1, preload
    return PushrodTrain(tappet, rod, rocker, valve, **options)
