"""States that are evolving data but no variables: not in the FMU's description, and yet saved with it."""

import pytest

from fmus.build import build
from fmus.documentation import variables_table
from fmus.fmi.validate import info, validate
from fmus.variable_layout import Memory
from tests.fmus.instance import Instance
from tests.models.fluid_layer import fluid_layer

SHEETS = 40
LAYER = fluid_layer(sheets=SHEETS)
STEP = 1e-6


@pytest.fixture(scope="module")
def layer_file(tmp_path_factory):
    return build("tests.models.fluid_layer:fluid_layer", tmp_path_factory.mktemp("layer"), {"sheets": SHEETS})


@pytest.fixture
def slave(layer_file):
    made = Instance(layer_file)
    yield made
    made.free()


def test_internal_states_are_no_variables(layer_file):
    """The other states keep their start values, also behind internal ones."""
    assert validate(layer_file) == []
    names = [variable.name for variable in info(layer_file).variables]
    assert "impulse_start" in names
    assert not [name for name in names if "sheet_velocity" in name]
    assert "sheet_velocity" not in variables_table(LAYER)


def test_references_number_the_variables_without_a_gap():
    """A dependency in the description is a place in its list, which is the value reference more one."""
    variables = Memory(LAYER).variables()
    assert [variable.reference for variable in variables] == list(range(len(variables)))


def test_a_start_value_behind_internal_states_is_that_of_its_state(slave):
    slave.initialize(impulse_start=0.25, velocity=1.0)
    assert slave.get(["impulse"]) == [0.25]
    slave.step(0.0, STEP)
    assert slave.get(["impulse"])[0] == pytest.approx(0.25, abs=1e-3)
    assert slave.get(["impulse"])[0] != 0.25


def test_start_values_of_other_states_are_still_checked(slave):
    with pytest.raises(Exception, match="fatal"):
        slave.initialize(impulse_start=float("nan"))
    assert any("impulse_start = nan" in text for _, _, text in slave.messages)
