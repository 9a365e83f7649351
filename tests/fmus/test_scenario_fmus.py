"""FMUs of a scenario: its values as defaults, and the whole train as one, beside the coupled run."""

import fmpy
import numpy as np
import pytest

import tribocosim
from fmus.native.machine_code import this_platform
from models.core.composite import compose, with_values
from models.core.errors import ModelError
from models.core.evaluation import Interpreted
from models.core.system import Instance
from models.monolithic.reference import solve
from orchestrator.scenario.system import assemble, resolve_start
from tribocosim.scenario_fmus import plan_experiment

TRAIN = "finger-follower-hla"

STEPPED = """
import sys
slave = Instance({fmu!r}).initialize(0.0)
for k in range({steps}):
    slave.step(k * {size!r}, {size!r})
ours = sorted({{name.partition(".")[0] for name in sys.modules}} & {{"models", "fmus", "orchestrator"}})
report([slave.get({outputs!r}), ours])
"""


def system_of(scenario):
    checked = scenario.check()
    return resolve_start(checked, assemble(checked).system)


def compose_shipped(name: str, outside: tuple[str, ...] = ()):
    system = system_of(tribocosim.load(name))
    lines = [(str(c.source), str(c.target)) for c in system.connections]
    kept = {part: instance for part, instance in system.instances.items() if part not in outside}
    return system, compose("train", "", kept, lines)


def test_the_default_experiment_shows_the_peaks_at_the_scenarios_speed():
    """Its step is a macro step of 5 us, or 0.1 deg of the drive: 2.78 us at 6000 r/min."""
    for speed, step in (("2000 rpm", 5e-6), ("6000 rpm", 0.1 / 360.0 / 100.0)):
        changed = tribocosim.load("valve-train").with_(
            {"components.flywheel.parameters.initial_speed": speed}
        )
        assert plan_experiment(changed.check()).step_size == pytest.approx(step, rel=1e-11)
    free = tribocosim.load("two-masses").check()
    assert plan_experiment(free).step_size == free.macro_step


@pytest.mark.plain
@pytest.mark.parametrize("name", ["valve-train", TRAIN, "two-masses", "bouncing-mass"])
def test_a_composite_is_its_system(name):
    """Outputs, derivatives and energies are those of its parts, at the start and away from it.

    An algebraic loop (the flywheel's) is closed by the secant here, by Newton's method there: 1e-12 of the
    variables' sizes.
    """
    system, train = compose_shipped(name)
    evaluation = Interpreted(system)
    for share in (0.0, 1e-3):
        x = train.state.start + share * train.state.nominal
        u, p = train.inputs.start, train.parameters.start
        y, dx, e = np.zeros(train.outputs.size), np.zeros(train.state.size), np.zeros(3)
        train.flat_output(0.01, x, u, p, y)
        train.flat_derivative(0.01, x, u, p, dx)
        train.flat_energy(0.01, x, u, p, e)
        rates = evaluation.derivative(0.01, x)
        scale = system.outputs.nominal + abs(evaluation.y)
        np.testing.assert_allclose((y - evaluation.y) / scale, 0.0, atol=1e-12)
        np.testing.assert_allclose(dx, rates, rtol=1e-9, atol=1e-9)
        parts = np.zeros(3)
        for part, instance in system.instances.items():
            each = np.zeros(3)
            own = (
                x[system.state.of(part)],
                evaluation.u[system.inputs.of(part)],
                system.p[system.parameters.of(part)],
            )
            instance.component.flat_energy(0.01, *own, each)
            parts += each
        np.testing.assert_allclose(e, parts, rtol=1e-9, atol=1e-12)


@pytest.mark.plain
def test_what_is_left_outside_becomes_inputs():
    """The cam's angle and speed; each once, however many parts they drive. No loop is left."""
    system, train = compose_shipped("valve-train", ("flywheel",))
    driven = {c.source for c in system.connections if c.source.instance == "flywheel"}
    assert {str(port) for port in driven} <= set(train.inputs.names)
    assert not any(name.startswith("flywheel.") for name in train.outputs.names)
    assert train.feedthrough["camshaft.surface_position"] == ["flywheel.angle"]
    with pytest.raises(ModelError, match="take a film formula"):
        compose_shipped("valve-train-ehl")


@pytest.mark.plain
def test_an_open_input_names_the_starts_that_it_replaces():
    """It starts as the first of the parts that it drives; of parts that start alike it says nothing."""
    from models.oscillators.two_masses import sprung_mass

    def describe(*starts: float) -> tuple[float, str]:
        parts = {f"mass_{i}": Instance(sprung_mass(), {}, {}, {"force": s}) for i, s in enumerate(starts)}
        train = compose("masses", "", parts, [("hand.force", f"{part}.force") for part in parts])
        field = train.inputs.field("hand.force")
        return field.start, field.quantity.description.partition("; ")[2]

    assert describe(2.0, 2.0) == (2.0, "")
    assert describe(2.0, 3.0, 2.0) == (2.0, "replaces the start mass_1.force = 3")


@pytest.mark.plain
def test_the_instance_s_values_are_defaults():
    from models.oscillators.bouncing_mass import falling_mass

    made = with_values(Instance(falling_mass(), {"mass": 3.0}, {"position": 0.25}))
    assert made.parameters.start[made.parameters.index("mass")] == 3.0
    assert made.state.start[made.state.index("position")] == 0.25
    assert falling_mass().parameters.start[made.parameters.index("mass")] != 3.0


@pytest.mark.parametrize(
    ("train", "contact", "stop", "native"),
    [
        ("valve-train", "contact", 0.03, False),
        *(
            pytest.param(TRAIN, "cam_contact", 4e-3, native, marks=pytest.mark.long)
            for native in (False, True)
        ),
    ],
)
def test_a_whole_train_moves_as_the_reference(train, contact, stop, native, tmp_path, isolated):
    """In a process without this repository: as the monolithic reference, to 1e-6, on the flank of the cam.

    Its integrator has a relative tolerance of 1e-9 per step, over some hundred steps."""
    scenario = tribocosim.load(train).with_(stop_time=stop)
    (path,) = tribocosim.build_scenario_fmus(scenario, tmp_path, whole=True, native=native)
    assert path.name == f"{train.replace('-', '_')}{'-native' if native else ''}.fmu"
    outputs = ["valve_spring.position", f"{contact}.load", f"{contact}.film_thickness"]
    values, ours = isolated(STEPPED.format(fmu=str(path), steps=200, size=stop / 200, outputs=outputs))
    assert ours == []
    reference = solve(system_of(scenario), np.linspace(0.0, stop, 201))
    for name, value in zip(outputs, values, strict=True):
        assert value == pytest.approx(float(reference[name][-1]), rel=1e-6, abs=1e-12)


@pytest.mark.long
def test_a_whole_train_is_integrated_at_any_tolerance(tmp_path, capfd):
    """By fmpy's CVODE, whose trial steps leave the range of the film. No call is refused; errors of the load
    are those of docs/how-to/use-the-fmus.md."""
    (path,) = tribocosim.build_scenario_fmus(
        "valve-train", tmp_path, whole=True, native=True, platforms=[this_platform()]
    )

    def simulate(tolerance, interval):
        return fmpy.simulate_fmu(
            str(path), fmi_type="ModelExchange", stop_time=0.06, output_interval=interval,
            relative_tolerance=tolerance, output=["contact.load"],
        )["contact.load"]  # fmt: skip

    sharp = simulate(1e-11, 1e-4)
    for tolerance, bound in {1e-3: 2.0, 1e-5: 7e-2, 1e-6: 1.3e-2, 1e-7: 8e-4, 1e-8: 1e-4, 1e-9: 2e-5}.items():
        for interval in (1e-3, 5e-5, 1.7e-5):
            assert np.isfinite(simulate(tolerance, interval)).all()
        assert np.sqrt(np.mean((simulate(tolerance, 1e-4) - sharp) ** 2)) < bound * np.std(sharp), tolerance
    assert capfd.readouterr() == ("", "")


def test_a_system_without_inputs_moves(tmp_path, isolated):
    """In free fall s = g t^2 / 2, which the integrator has exactly but for rounding."""
    (path,) = tribocosim.build_scenario_fmus("bouncing-mass", tmp_path, whole=True)
    (position,), _ = isolated(STEPPED.format(fmu=str(path), steps=5, size=0.01, outputs=["mass.position"]))
    assert position == pytest.approx(0.1 - 9.81 * 0.05**2 / 2.0, abs=1e-12)


@pytest.mark.parametrize(
    "names", [("compose", "make_stop"), ("sys", "print"), ("é", "ü"), ("int", "__init__")]
)
def test_components_have_any_name(names, tmp_path, isolated):
    """Those of the code of an FMU, of Python, and with letters that the naming convention does not have."""
    mass, stop = names
    tables = {
        "name": mass,
        "reference": {"enabled": False},
        "stop_time": "1 s",
        "macro_step": "1 ms",
        "connections": [f"{stop}.force -> {mass}.force", f"{mass}.position -> {stop}.position"],
        "components": {mass: {"component": "falling_mass"}, stop: {"component": "spring_stop"}},
    }
    scenario = tribocosim.load(tables)
    whole = tribocosim.build_scenario_fmus(scenario, tmp_path / "whole", whole=True)
    parts = tribocosim.build_scenario_fmus(scenario, tmp_path)
    assert len({path.name for path in parts}) == len(names)
    made = (*whole, *parts)
    for path in made:
        assert not tribocosim.validate_fmu(path), tribocosim.validate_fmu(path)
    isolated("".join(STEPPED.format(fmu=str(path), steps=2, size=1e-3, outputs=[]) for path in made))


def test_a_component_has_the_scenario_s_values_as_defaults(tmp_path):
    scenario = tribocosim.load("valve-train").with_(
        {"components.valve_spring.parameters.valve_mass": "0.2 kg"}
    )
    (path,) = tribocosim.build_scenario_fmus(scenario, tmp_path, components=["valve_spring"])
    described = fmpy.read_model_description(str(path))
    start = {
        v.name: float(v.start) for v in described.modelVariables if v.start is not None and v.type == "Real"
    }
    assert described.modelName == "valve_spring"
    assert float(start["valve_mass"]) == 0.2
    assert described.defaultExperiment.stopTime == "0.12"


@pytest.mark.parametrize("native", [False, True])
def test_another_stop_time_is_the_default_of_the_next_build(native, tmp_path):
    """The code is the same, and so is the file in which it stands."""
    for stop in (1.0, 2.0):
        scenario, options = tribocosim.load("two-masses").with_(stop_time=stop), {"native": native}
        options |= {"platforms": [this_platform()]} if native else {}
        folder = tmp_path / str(stop)
        (path,) = tribocosim.build_scenario_fmus(scenario, folder, components=["second"], **options)
        assert float(fmpy.read_model_description(str(path)).defaultExperiment.stopTime) == stop


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"components": ["cam"]}, "no component 'cam' in valve-train"),
        ({"outside": ["flywheel"]}, "outside"),
        ({"components": ["camshaft"], "whole": True}, "has all components"),
        ({"whole": True, "outside": ["wheel"]}, "no component 'wheel'"),
        ({"whole": True, "outside": ["flywheel", "camshaft", "contact", "valve_spring"]}, "no component"),
        ({"whole": True, "fmi": 3}, "fmi"),
    ],
)
def test_what_cannot_be_built_is_named(options, said, tmp_path):
    with pytest.raises(tribocosim.MistakeError, match=said):
        tribocosim.build_scenario_fmus("valve-train", tmp_path, **options)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("of_another_tool", [True, False])
def test_what_is_left_outside_needs_no_equations(of_another_tool, tmp_path):
    """An FMU of another tool, and a component in one's own file: their outputs become inputs."""
    own = tmp_path / "parts.py"
    own.write_text("from models.oscillators.two_masses import sprung_mass as own\n")
    second = (
        {"participant": str(tribocosim.build_fmu("sprung_mass", tmp_path))}
        if of_another_tool
        else {"component": f"{own}:own"}
    )
    tables = dict(tribocosim.load("two-masses").content)
    tables["components"] = {"first": tables["components"]["first"], "second": second}
    tables |= {"reference": {"enabled": False}, "name": "half"}
    scenario = tribocosim.load(tables)
    (path,) = tribocosim.build_scenario_fmus(scenario, tmp_path, whole=True, outside=["second"])
    assert not tribocosim.validate_fmu(path)
    inputs = {v.name for v in fmpy.read_model_description(str(path)).modelVariables if v.causality == "input"}
    assert {"second.position", "second.velocity"} <= inputs
    if of_another_tool:
        with pytest.raises(tribocosim.MistakeError, match="second"):
            tribocosim.build_scenario_fmus(scenario, tmp_path, whole=True)


OWN = """
from dataclasses import replace

from models.compile.kernel import kernel
from models.core.component import Component
from models.oscillators.two_masses import sprung_mass


def braked() -> Component:
    plain = sprung_mass()
    move = plain.derivative

    @kernel
    def derivative(t, x, u, p, dx):
        move(t, x, u, p, dx)
        dx.velocity -= 40.0 * x.velocity

    return replace(plain, derivative=derivative)
"""


@pytest.mark.parametrize("native", [False, True])
def test_own_components_and_factors_are_inside_of_the_whole_train(native, tmp_path, isolated):
    """Two files with one factory's name, in a process without them and without this repository: at 0.1 s as
    the monolithic reference, to 1e-6 as any train."""
    files = [tmp_path / f"parts{n}.py" for n in range(2)]
    for file, plain in zip(files, ("coupled_mass", "sprung_mass"), strict=True):
        file.write_text(OWN.replace("sprung_mass", plain))
    tables = dict(tribocosim.load("two-masses").content) | {"stop_time": "0.1 s"}
    parts = tables["components"].items()
    tables["components"] = {
        name: dict(table) | {"component": f"{file}:braked", "participant": "in-process"}
        for (name, table), file in zip(parts, files, strict=True)
    }
    tables["connections"] = [
        "first.force * 0.5 + 1.0 -> second.force",
        "second.position -> first.other_position",
        "second.velocity * 2.0 -> first.other_velocity",
    ]
    tables["components"]["first"]["parameters"] |= {"coupling_damping": 3.0}
    scenario = tribocosim.load(tables)
    reference = tribocosim.run(scenario).reference
    (whole,) = tribocosim.build_scenario_fmus(scenario, tmp_path / "whole", whole=True, native=native)
    (part,) = tribocosim.build_scenario_fmus(scenario, tmp_path / "part", components=["first"])
    for file in files:
        file.unlink()
    outputs = ["first.position", "second.velocity"]
    code = STEPPED.format(fmu=str(part), steps=1, size=1e-3, outputs=["position"])
    values, ours = isolated(code + STEPPED.format(fmu=str(whole), steps=100, size=1e-3, outputs=outputs))
    assert ours == []
    assert reference is not None
    for name, value in zip(outputs, values, strict=True):
        assert value == pytest.approx(float(reference[name][-1]), rel=1e-6)


def test_an_open_input_behind_a_factor_is_described_as_its_source(tmp_path):
    """A speed that makes an angle of the cam has the speed's unit, and no degrees to be shown in."""
    tables = dict(tribocosim.load("valve-train").content) | {"start": "given", "name": "geared"}
    lines = [line for line in tables["connections"] if "camshaft.drive_angle" not in line]
    tables["connections"] = [*lines, "flywheel.speed * 0.01 -> camshaft.drive_angle"]
    tables |= {"reference": {"enabled": False}}
    (path,) = tribocosim.build_scenario_fmus(tables, tmp_path, whole=True, outside=["flywheel"])
    assert not tribocosim.validate_fmu(path)
    variables = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
    assert variables["flywheel.speed"].unit == "rad/s"


def test_many_fmus_are_not_written_in_one_file(tmp_path):
    with pytest.raises(tribocosim.MistakeError, match="is one file, but 4 FMUs"):
        tribocosim.build_scenario_fmus("valve-train", tmp_path / "all.fmu")
    assert not list(tmp_path.iterdir())


def test_equations_that_are_no_odes_are_named_with_the_scenario(tmp_path):
    with pytest.raises(tribocosim.MistakeError, match=r"^valve_train_ehl: contact: ehl_line_contact is no"):
        tribocosim.build_scenario_fmus("valve-train-ehl", tmp_path, whole=True)
