"""The phase at which a valve opens against its gas: doubted before a run where engines do not have it."""

import pytest

from orchestrator.assessment.gas_phase import list_doubtful_gas
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

FIRING, BLOWDOWN = "components.gas.parameters.firing_angle", "components.gas.parameters.exhaust_opening"
# The nose is at 360 deg of the crank; 0.2 mm of lash are taken up on the ramp of 0.3 mm, whose velocity is
# constant over 20 + 5 deg up to the foot of the flank: (0.3 - 0.2) mm from its end, in (25/3 - 2.5/2) deg.
OPENS = 360.0 - 2.0 * (60.0 + 25.0 / 3.0 - 2.5)


@pytest.mark.parametrize(
    ("firing", "blowdown", "doubt"),
    [
        (OPENS - 126.0, 126.0, None),  # exhaust
        (OPENS - 336.0, 126.0, None),  # intake
        (OPENS - 67.0, 126.0, "opens 67 deg after firing, against"),
        (OPENS - 67.0, 126.0, "e.g. '98 deg' for an exhaust valve"),
        (OPENS - 230.0, 126.0, "opens 230 deg after firing"),
        (OPENS - 100.0, 150.0, "set exhaust_opening = '100 deg'"),
    ],
)
def test_a_valve_opens_where_engines_open_it_or_is_doubted(firing, blowdown, doubt):
    system = build_system(load("exhaust-valve", [f"{FIRING}='{firing} deg'", f"{BLOWDOWN}='{blowdown} deg'"]))
    found = list_doubtful_gas(system)
    assert len(found) == (doubt is not None)
    assert doubt is None or (found[0].startswith("components.gas: valve_spring ") and doubt in found[0])


def test_a_valve_without_gas_is_not_judged():
    assert list_doubtful_gas(build_system(load("seat-and-lash"))) == []
