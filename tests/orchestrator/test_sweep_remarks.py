"""What a sweep over speed says of its cycles."""

import numpy as np
import xarray

from orchestrator.study.speeds.remarks import describe_lift_loss, describe_unsteady, list_doubts
from orchestrator.study.speeds.separation import RPM


def test_motions_without_a_cycle_are_said_with_their_distance():
    speeds = np.array([100.0, 200.0, 300.0]) / RPM
    numbers = {"change": ("speed", [1e-6, 2e-3, 4e-2]), "periods": ("speed", [4.0, 20.0, 25.0])}
    (sentence,) = describe_unsteady(xarray.Dataset(numbers, {"speed": speeds}))
    assert sentence.startswith("no steady cycle at 2 speeds from 200 to 300 r/min; the worst at 300 r/min")
    assert "4 % after 25 periods" in sentence
    assert not list(describe_unsteady(xarray.Dataset(numbers, {"speed": speeds}).isel(speed=[0])))


def test_lift_is_compared_at_speeds_with_contact():
    """A valve that flies has more area than the cam gives it."""
    values = {"valve.lift_area": [2e-3, 1.9e-3, 5e-3], "contact.lost": [0.0, 0.0, 0.1]}
    table = xarray.Dataset(
        {name: ("speed", column) for name, column in values.items()},
        {"speed": np.array([100.0, 200.0, 300.0])},
    )
    (sentence,) = describe_lift_loss(table)
    assert sentence == "valve: the area under its lift is 5 % less at 1910 than at 955 r/min"
    assert not list(describe_lift_loss(table.isel(speed=[2])))
    table["valve.lift_area"][1] = 2.0001e-3
    assert list(describe_lift_loss(table)) == [
        "valve: the area under its lift is unchanged from 955 to 1910 r/min"
    ]


def test_a_sweep_says_where_bodies_yield():
    speeds = np.array([1000.0, 2000.0, 3000.0]) / RPM
    found = {"stress_ratio": [0.5, 1.2, 2.1], "peak_pressure": [1e9, 2.4e9, 4.2e9], "change": np.zeros(3)}
    table = xarray.Dataset({f"cam.{n}": ("speed", v) for n, v in found.items()}, {"speed": speeds})
    table = table.rename({"cam.change": "change"})
    (said,) = list_doubts(None, None, table)
    assert "cam is above the elastic limit at 2 speeds from 2000 to 3000 r/min, 4200 MPa at 3000" in said
    assert not list_doubts(None, None, table.isel(speed=[0]))
    table["cam.stress_ratio"][:] = [1.5, 0.9, 2.1]
    (said,) = list_doubts(None, None, table)
    assert "at 2 of 3 speeds from 1000 to 3000 r/min, 4200 MPa" in said
