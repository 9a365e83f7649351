"""K's valve train as K writes it, with 21 constraints, against minimal models."""

import math

from models.core.quantities import Layout
from models.multibody.direct_train import direct_train
from models.multibody.mechanism import Mechanism
from models.valve_train.camshaft import CamshaftParameters
from models.valve_train.valve_spring import ValveSpringParameters


def train(speed_rpm: float, flexible: bool = True, **parameters: float) -> Mechanism:
    camshaft, valve = Layout(CamshaftParameters).defaults(), Layout(ValveSpringParameters).defaults()
    camshaft.flexible = float(flexible)
    for name, value in parameters.items():
        setattr(camshaft if name in camshaft.dtype.names else valve, name, value)
    return direct_train(camshaft, valve, speed_rpm * math.pi / 30.0)


def test_parts_joints_and_freedoms_are_those_of_ks_tables_1_and_2():
    mechanism = train(1000.0)
    assert [len(joint.constraints) for joint in mechanism.joints] == [4, 1, 1, 5, 5, 5]
    # The shaft slides in its bearing, the cam has six but the contact, follower and coils share three.
    assert (len(mechanism.bodies), mechanism.freedoms) == (5, 9)
