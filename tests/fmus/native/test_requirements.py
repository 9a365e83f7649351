"""What ranges cannot say is refused with the same words in-process, by the Python and by the native FMU."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from fmpy.fmi1 import FMICallException
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fmus.build import build
from fmus.native.fmu import NAMES
from fmus.variable_layout import name_as_start_value
from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.quantities import Field, Layout

from ..instance import Instance, Instance3
from ..kinds import FAST

COMPONENTS = {name: CATALOGUE[name]() for name in NAMES}
REQUIRING = [name for name, c in COMPONENTS.items() if c.requirements or c.start_requirements]

PISTON = (
    {"crank_radius": 0.15},
    {"half_length": 1e-3},
    {"crank_radius": 0.15, "half_length": 1e-3},
    {"offset": 50e-6},
    {"offset": -1.0 / 1.5e4},
    {"tilt": -2e-3},
    {"closed[1]": 1.0, "closed[3]": 1.0},
    {"closed[1]": 1.0, "closed[2]": 1.0, "closed[4]": 1.0},
    {"half_length": 0.0, "closed[2]": 1.0},
)
# Parameters, start states and inputs that break a requirement, by name.
WRONG: Mapping[str, tuple[Mapping[str, float], ...]] = {
    "camshaft": (
        {"dwell_half_width": 2.0},
        {"base_radius": 10e-3},
        {"lift": 0.03, "rise_angle": 1.0},
        {"power_p": 15.0},
        {"flank_share": 0.9},
        {"rise_angle": 5e-324, "dwell_half_width": 0.0},
    ),
    "valve_spring": ({"lash": 2e-4}, {"lash": -1e-3}),
    "tappet": (
        {"base_radius": 10e-3},
        {"follower": 1.0, "offset": 0.05},
        {"dwell_half_width": 2.0},
        {"power_p": 15.0},
        {"flank_share": 0.9},
        {"rise_angle": 5e-324, "dwell_half_width": 0.0},
    ),
    "journal_bearing": (
        {"width": 30e-3},
        {"roughness": 5e-6},
        {"groove_width": 2.0, "film_model": 2.0},
        {"groove_width": 1e-3, "film_model": 2.0},
        {"width": 2e-3, "film_model": 2.0},
        {"eccentricity_x": 21e-6, "eccentricity_y": -21e-6},
    ),
    "pin_bearing": (
        {"width": 30e-3},
        {"roughness": 5e-6},
        {"groove_width": 2.0, "film_model": 2.0},
        {"width": 0.7e-3, "film_model": 2.0},
        {"face_gap": 1e-4, "face_radius": 3e-3},
        {"eccentricity_x": 15e-6, "eccentricity_y": -15e-6},
    ),
    "finger": (
        {"inertia": 1e-6},
        {"cam_arm": -28e-3},
        {"valve_arm": 5e-3},
        {"base_radius": 1e-3, "follower_radius": 60e-3},
        {"dwell_half_width": 2.0},
        {"power_p": 15.0},
        {"flank_share": 0.9},
        {"rise_angle": 5e-324, "dwell_half_width": 0.0},
    ),
    "ehl_contact": ({"film_model": 8.0},),
    "slider_crank": (
        {"crank_radius": 0.2},
        {"crank_radius": 0.2, "form": 2.0},
        {"clearance": 0.02},
        {"clearance": 0.1, "form": 2.0},
        {"upper_wall_film": 2e-3, "lower_wall_film": 3e-3},
        {"mode": 1.0, "psi": -0.001},
        {"mode": -1.0, "psi": 0.001, "crank_angle": 2.0},
        {"psi": -0.02, "crank_angle": 0.5 * math.pi},
        {"psi": 0.02, "crank_angle": 1.0 / 3.0, "form": 2.0},
    ),
    "piston_crank": PISTON,
    "free_piston_crank": PISTON,
    "cylinder_gas": (
        {"crank_radius": 0.2},
        {"burn_start": 4.0},
        {"exhaust_opening": 5.0},
        {"crank_radius": 0.2, "burn_start": 4.0, "exhaust_opening": 5.0},
    ),
    "piston_clearance": ({"crank_radius": 0.2}, {"pin_offset": -0.11}),
}


def tried(name: str, *values: Any) -> Any:
    """Those of components whose FMUs take long are among the long tests."""
    return pytest.param(name, *values, marks=() if name in FAST else pytest.mark.long)


CASES = [tried(name, values) for name in REQUIRING for values in WRONG[name]]


def refusal(component: Component, values: Mapping[str, float]) -> str:
    """What the component says against these parameters, start states and inputs; empty if nothing."""

    def vector(layout: Layout) -> Any:
        return layout.vector({name: value for name, value in values.items() if name in layout})

    p, x, u = vector(component.parameters), vector(component.state), vector(component.inputs)
    starts = component.start_faults(p, x, u)
    return "; ".join(component.parameter_faults(p) or map(name_as_start_value, starts))


def as_variables(component: Component, values: Mapping[str, float]) -> dict[str, float]:
    """The same by the names of an FMU's variables."""
    state = component.state
    return {
        state.field(name).add_suffix("_start") if name in state else name: value
        for name, value in values.items()
    }


def refusal_by(fmu: Instance, values: Mapping[str, float]) -> str:
    """What an FMU says, as an instance that then may be used again."""
    fmu.fmu.reset()
    fmu.messages.clear()
    try:
        fmu.initialize(**values)
    except FMICallException:
        return fmu.messages[0][2]
    return ""


class Instances(dict[str, Instance]):
    """One of each FMU, made when it is first asked for."""

    def __init__(self, file_of: Callable[[str], Path]) -> None:
        super().__init__()
        self.file_of = file_of

    def __missing__(self, name: str) -> Instance:
        self[name] = Instance(self.file_of(name))
        return self[name]

    def free(self) -> None:
        for instance in self.values():
            instance.free()


@pytest.fixture(scope="module")
def natives(native_files):
    instances = Instances(native_files.__getitem__)
    yield instances
    instances.free()


@pytest.fixture(scope="module")
def pythons(tmp_path_factory):
    """With the native FMUs' sizes."""
    folder = tmp_path_factory.mktemp("pythons")
    instances = Instances(lambda name: build(name, folder))
    yield instances
    instances.free()


@pytest.mark.parametrize(("name", "values"), CASES)
def test_all_say_the_same(name, values, natives, pythons):
    component = COMPONENTS[name]
    said, variables = refusal(component, values), as_variables(component, values)
    assert said
    assert refusal_by(natives[name], variables) == said
    assert refusal_by(pythons[name], variables) == said


@pytest.mark.long
def test_fmi3_says_it_too(fmi3_files):
    """Its functions stand over the same runtime: one component for all."""
    component, fmu = COMPONENTS["slider_crank"], Instance3(fmi3_files["slider_crank"])
    for values in WRONG["slider_crank"]:
        assert refusal_by(fmu, as_variables(component, values)) == refusal(component, values)
    fmu.free()


@pytest.mark.parametrize("name", REQUIRING)
def test_every_requirement_is_tried(name):
    """And refused by its component: the words before the first number tell them apart."""
    component = COMPONENTS[name]
    texts = [rule.says for rule in component.requirements]
    texts += [name_as_start_value(rule.says) for rule in component.start_requirements]
    said = [refusal(component, values) for values in WRONG[name]]
    for text in texts:
        plain = max(text.replace("}", "{").split("{"), key=len)
        assert any(plain in message for message in said), text


def test_a_corner_is_in_lasting_contact_or_not():
    """The component says so; an FMU has it as a truth value, of which there is no half."""
    assert "must be true or false" in refusal(COMPONENTS["piston_crank"], {"closed[1]": 0.5})


def allowed(field: Field) -> st.SearchStrategy[float]:
    """Numbers inside the field's range, from its start value outwards to some ten times that."""
    low, high = field.quantity.limits()
    if field.quantity.discrete:
        return st.integers(int(max(low, -3.0)), int(min(high, 9.0))).map(float)
    reach = 10.0 * (abs(field.start) or field.quantity.nominal)
    low, high = max(low, 0.0 if field.quantity.positive else -reach), min(high, reach)
    return st.floats(low, high, exclude_min=field.quantity.positive)


def changes(component: Component) -> st.SearchStrategy[dict[str, float]]:
    """A few values of parameters, start states and inputs."""
    layouts = component.parameters, component.state, component.inputs
    fields = [f for layout in layouts for f in layout.fields if not f.quantity.internal]
    return st.lists(st.sampled_from(fields), max_size=4, unique=True).flatmap(
        lambda some: st.fixed_dictionaries({field.name: allowed(field) for field in some})
    )


@pytest.mark.parametrize("name", [tried(name) for name in REQUIRING])
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_native_fmu_refuses_exactly_what_the_component_refuses(name, data, natives):
    component = COMPONENTS[name]
    values = data.draw(changes(component))
    assert refusal_by(natives[name], as_variables(component, values)) == refusal(component, values)


def test_a_tuned_parameter_that_does_not_fit_discards_the_step(natives, pythons):
    for spring in (natives["valve_spring"], pythons["valve_spring"]):
        assert refusal_by(spring, {"load": 500.0}) == ""
        spring.set({"lash": 2e-4})
        with pytest.raises(FMICallException, match="discard"):
            spring.step(0.0, 1e-5)
        assert spring.messages[0][2] == refusal(COMPONENTS["valve_spring"], {"lash": 2e-4})
        spring.set({"lash": 0.0})
        spring.step(0.0, 1e-5)


def test_a_host_that_integrates_hears_of_a_tuned_parameter_at_the_event(natives):
    spring = natives["valve_spring"]
    spring.messages.clear()
    lash = [spring.variables["lash"].valueReference]
    with spring.exchanging() as model:
        model.newDiscreteStates()
        model.setReal(lash, [2e-4])
        with pytest.raises(FMICallException, match="error"):
            model.newDiscreteStates()
        assert spring.messages[0][2] == refusal(COMPONENTS["valve_spring"], {"lash": 2e-4})
        model.setReal(lash, [0.0])
        model.newDiscreteStates()
