"""A follower rests where its cam does not move it."""

import math
import re

import pytest

from models.core.system import ModelError
from models.monolithic.equilibrium import equilibrium, list_moving_cams

from ..independent_train import cam
from ..systems import valve_train


@pytest.mark.parametrize("phase", [80.0, 120.0, 180.0, 200.0])
def test_a_cam_that_moves_its_follower_is_told_with_its_velocity(phase: float) -> None:
    """s' w; none on the base circle and at the nose."""
    system = valve_train(1000.0, camshaft={"phase": math.radians(phase)})
    lift, slope, _ = cam(math.radians(phase))
    lines = list_moving_cams(system, 0.0, equilibrium(system, 0.0))
    if phase in (80.0, 180.0):
        assert lines == []
    else:
        numbers = re.search(r"lifts by (\S+) mm and moves the follower at (\S+) m/s", lines[0])
        assert numbers
        velocity = slope * 1000.0 * math.pi / 30.0
        assert [float(n) for n in numbers.groups()] == pytest.approx([1e3 * lift, velocity], rel=5e-3)


def test_where_it_leaves_no_equilibrium_the_cam_is_named() -> None:
    system = valve_train(3000.0, camshaft={"phase": math.radians(150.0), "flexible": 1.0})
    with pytest.raises(
        ModelError, match=r"camshaft: .* its cam lifts by 6\.55 mm .* begin on the base circle"
    ):
        equilibrium(system, 0.0)
