"""A mistake in a scenario is one message that names the key, the value and the remedy."""

import math
import re

import pytest

import tribocosim
from models.core.system import ModelError
from orchestrator.errors import Option, ParticipantError, in_command_line
from orchestrator.scenario import ScenarioError, build_scenario
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start
from orchestrator.scenario.values import list_layouts
from tribocosim.scenario import read_tables

from .coupled import run_coupled

BAD = {
    "step_control=1": ("step_control = 1: must be a table",),
    "components.camshaft.substeps=2.5": ("components.camshaft.substeps = 2.5: must be an integer",),
    "macro_stp=1": ("macro_stp", "did you mean macro_step?"),
    "macro_step=0": ("macro_step", "> 0"),
    "stop_time=0": ("stop_time", "> 0"),
    "macro_step=3 kg": ("macro_step", "kg does not fit a time", "write s or ms"),
    "macro_step=3 microsecnd": ("macro_step", "did you mean microsecond?"),
    "components.camshaft.parameters.lift=3 qwx": ("lift", "write m or mm"),
    "macro_step=1 s": ("macro_step", "stop_time"),
    "macro_step=1e-30": (
        "--set macro_step = 1e-30 s: must be at least 1.4e-14 s with stop_time = 0.12 s",
        "'5 us'",
    ),
    "output_step=1": ("--set output_step = 1 s: must not be longer than stop_time = 0.12 s", "leave it out"),
    "stop_time=[1]": ("stop_time", "number of seconds"),
    "start=equilibrum": ("start", "did you mean equilibrium?"),
    "name=a/b": ("name", "a/b"),
    "tolerance=3": ("tolerance", "table"),
    "tolerance.contact.load=-1": ("tolerance.contact.load", "-1", "> 0"),
    "connections=['a b']": ("connections", "a b", "instance.output -> instance.input"),
    "reference.toleranc=2": ("reference.toleranc", "did you mean tolerance?"),
    "master.name=gauss": (
        "--set master.name: 'gauss': did you mean gauss_seidel? It must be one of jacobi, gauss_seidel, "
        "iterated, newton",
    ),
    "step_control.estimator=doubl": ("did you mean step_doubling?",),
    "master.tolerance=3": ("master.tolerance", "gauss_seidel"),
    "master.extrapolation=cubic": ("extrapolation", "cubic", "quadratic"),
    "reference.enabled=maybe": ("reference.enabled", "maybe", "true or false"),
    "components.camshaft.participant=in_process": ("participant", "did you mean in-process?"),
    "components.camshft.parameters.flexible=true": ("camshft", "did you mean camshaft?"),
    "components.camshaft.component=camshft": ("camshft", "did you mean camshaft?"),
    "components.camshaft.parameters.flexibl=true": ("flexibl", "did you mean flexible?"),
    "components.camshaft.parameters.flexible=2": ("flexible", "true or false"),
    "components.camshaft.parameters.lift=[1]": ("lift", "must be a number"),
    "components.camshaft.start.twst=1": ("start.twst", "did you mean twist?"),
    "components.camshaft.paramters.lift=5": (
        "--set components.camshaft.paramters: unknown key; did you mean parameters?",
    ),
    "components.contact.parameters.film_model=kushwa": (
        "film_model",
        "kushwa",
        "dowson_higginson",
        "did you mean kushwaha?",
    ),
    "components.contact.parameters.film_model=3": ("film_model", "3", "one of"),
    "components.valve_spring.spring_rate=3e4": (
        "components.valve_spring.spring_rate: unknown key; did you mean "
        "components.valve_spring.parameters.spring_rate?",
    ),
    "valve_spring.spring_rat=3e4": ("did you mean components.valve_spring.parameters.spring_rate?",),
    "preload=300": ("did you mean components.valve_spring.parameters.preload?",),
    "components.valve_spring.parameters.rate=3e4": ("no such parameter; did you mean spring_rate?",),
    "contact.film_thickness=3e-7": ("did you mean components.contact.start.film_thickness?",),
    "speed=3500 rpm": ("unknown key 'speed'; did you mean components.flywheel.parameters.initial_speed?",),
    "components.flywheel.parameters.speed=3500 rpm": ("it belongs in parameters, as initial_speed",),
    "components.flywheel.start.speed=3500 rpm": (
        "--set components.flywheel.start.speed: has no effect, as motion is not 'free'",
        "set parameters.initial_speed, or parameters.motion = 'free'",
    ),
    "components.camshaft.parameters.lift_tabel=a.csv": (
        "no such parameter; did you mean lift_table, in the component's own table, one level up?",
    ),
    "components.camshaft.parameters.retries=3": ("it belongs in the component's own table, one level up",),
    "components.valve_spring.structure.coils=3": ("coils", "did you mean coil_masses?"),
    "components.valve_spring.structure.coil_masses=0": ("coil_masses", "0", "from 1 to 500"),
    "components.valve_spring.structure.coil_masses=2.5": ("coil_masses", "2.5", "integer"),
    "components.contact.structure.cams=2": ("cams", "no structural sizes"),
    "macro_step": ("macro_step", "path=value"),
    "master.order=[1]": ("--set master.order[1] = 1: must be a string",),
    "tolerance.contact.load=nan": ("--set tolerance.contact.load = nan: must be a finite number > 0",),
    "step_control.relative=nan": ("--set step_control.relative = nan: must be a finite number > 0",),
    "step_control.relative=0,01": ("'0,01': a decimal comma; write '0.01', with a point",),
    "tolerance.contact.load=1,5e-3": ("write '1.5e-3', with a point",),
    "components.camshaft.parameters.lift=8,5 mm": ("write '8.5 mm', with a point",),
    "step_control.relative=1": ("--set step_control.relative = 1: must be < 1",),
    "step_control={minimum_step='1 us', maximum_step='1 ns'}": (
        "--set step_control.minimum_step = 1e-06 s: must not be longer than maximum_step = 1e-09 s",
    ),
    "components.camshaft.retries=-1": ("--set components.camshaft.retries = -1: must be >= 0",),
    "event_tolerance=1 s": ("--set event_tolerance = 1 s: must be shorter than macro_step = 5e-06 s",),
    "event_tolerance=true": ("--set event_tolerance = true: must be a time", "'2 us'"),
    "step_control.relative=1 %": ("--set step_control.relative = '1 %': must be a number, without a unit",),
    "ledger=true": ("--set ledger: unknown key 'ledger'; did you mean energy.ledger?",),
    "energy=true": ("--set energy = true: must be a table",),
    "components.contact.lift_table=a.csv": ("ehl_contact has none; leave it out, or take camshaft, ",),
    "components.camshaft.wire={}": ("wire: camshaft has none; leave it out, or take",),
    "components.camshaft.oil=SAE 30": ("oil: camshaft has none", "take journal_bearing,", " or "),
}


@pytest.mark.parametrize("override", BAD)
def test_a_mistake_is_one_message_that_names_it(override):
    with pytest.raises(ScenarioError) as error:
        load("valve-train", [override])
    message = in_command_line(error.value)
    assert all(word in message for word in BAD[override]), message
    assert "\n" not in message


BAD_SYSTEMS = {
    "master={name='iterated', iterate=['camshaft', 'contct']}": ("master.iterate: ", "did you mean contact?"),
    "master={name='newton', iterate=['camshaft', 'contct']}": ("master.iterate: ", "did you mean contact?"),
    "master.order=['contct']": ("master.order = contct: ", "; contct: did you mean contact?"),
    "master={name='newton', iterate=['contact', 'contact']}": ("master.iterate", "'contact' is named twice"),
    "components.valve_spring.parameters.valve_mass=-0.2": ("parameters.valve_mass = -0.2 kg", "> 0"),
    "components.camshaft.parameters.base_radius=2 mm": ("curvature", "undercut"),
    "tolerance.contact.lod=1e-3": ("contact.lod", "contact.load"),
    "tolerance.contct.load=1e-3": ("tolerance.contct.load", "no component 'contct'", "did you mean contact?"),
    "components.contact.inputs.approach=1": ("contact.approach", "constant value", "keep one"),
    "master={name='iterated', iterate=['contact']}": ("master.iterate = contact", "nothing to iterate one"),
    "master.order=['camshaft']": ("master.order = camshaft", "each of flywheel"),
    "components.contact.participant=nowhere.fmu": ("contact", "nowhere.fmu", "no such file"),
}


@pytest.mark.parametrize("override", BAD_SYSTEMS)
def test_an_impossible_system_is_one_message(override):
    with pytest.raises((ScenarioError, ModelError)) as error:
        build_system(load("valve-train", [override]))
    assert all(word in str(error.value) for word in BAD_SYSTEMS[override]), error.value


@pytest.mark.parametrize("table", ["step_control", "reference", "energy", "components.camshaft"])
def test_an_unknown_key_of_any_table_is_one_message(table):
    with pytest.raises(ScenarioError, match=rf"^set {table}\.colour: unknown key; known: \w+"):
        load("valve-train", [f"{table}.colour=1"])


@pytest.mark.parametrize("start", ["given", "equilibrium"])
def test_a_start_outside_the_walls_is_one_message(start):
    """At the flywheel's start angle, before anything is stepped; in-process participants say the same."""
    changes = ["components.slider_crank.start.psi=0.02", "components.flywheel.start.angle=90 deg"]
    scenario = load("slider-crank", [*changes, f"start={start}"])
    said = r"slider_crank(\.start\.|: )psi = 0\.02 rad .* at crank_angle = 1\.5708 rad"
    with pytest.raises(ModelError, match=said):
        resolve_start(scenario, build_system(scenario))
    system = build_system(load("slider-crank", [*changes, "start=equilibrium"]))
    with pytest.raises(ParticipantError, match=said):
        run_coupled(system, scenario.master.build(), 1e-4, 1e-3)


BAD_CONNECTIONS = {
    "camshaft.surface_position -> contact.retreat": ("contact.retreat", "two sources", "valve_spring"),
    "camshaft.lift_off -> flywheel.drive_torque": ("camshaft.lift_off", "no output"),
    "camshaft.cam_lift -> flywheel.drive_torqe": ("no input", "did you mean drive_torque?"),
    "camshaft.cam_lift -> flywheel.drive_torque": ("unit m", "N.m"),
    "cam.lift -> flywheel.drive_torque": ("no component 'cam'", "camshaft"),
}


@pytest.mark.parametrize("line", BAD_CONNECTIONS)
def test_a_bad_connection_is_one_message(line, tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(f'extends = "valve-train"\nconnections = ["{line}"]\n')
    with pytest.raises(ModelError) as error:
        build_system(load(file))
    assert all(word in str(error.value) for word in ("mine.toml:2: ", *BAD_CONNECTIONS[line])), error.value


def test_a_mistake_is_marked_by_where_it_was_made(tmp_path):
    """A file's own fault stays the file's; what --set does to other keys is --set's."""
    file = tmp_path / "mine.toml"
    file.write_text('extends = "valve-train"\nstart = "rest"\n')
    with pytest.raises(ScenarioError) as error:
        load(file, ["stop_time=1 us", "master.extrapolation=cubic"])
    assert [(fault.source, fault.place) for fault in error.value.faults] == [
        (Option("set"), "macro_step"),
        (Option("set"), "output_step"),
        ("mine.toml:2", "start"),
        (Option("set"), "master.extrapolation"),
    ]
    lines = in_command_line(error.value).split("\n")
    assert lines == [in_command_line(fault.words) for fault in error.value.faults]
    assert [line.split(" = ")[0] for line in lines[:3]] == [
        "--set macro_step",
        "--set output_step",
        "mine.toml:2: start",
    ]
    file.write_text('extends = "valve-train"\n[tolerance]\n"contact.lod" = 1e-3\n')
    for changes in ([], ["stop_time=2 ms"]):
        with pytest.raises(ScenarioError, match=r"^mine.toml:3: tolerance.contact.lod: no such output"):
            build_system(load(file, changes))
    file.write_text('extends = "valve-train"\n[components.valve_spring.parameters]\nvalve_mass = -1\n')
    with pytest.raises(ModelError, match=r"^mine.toml:3: components.valve_spring.parameters.valve_mass = "):
        build_system(load(file))
    with pytest.raises(ScenarioError) as error:
        build_system(load("valve-train", ["tolerance.contact.lod=1e-3"]))
    assert in_command_line(error.value).startswith("--set tolerance.contact.lod: no such output")
    with pytest.raises(ModelError, match=r"^set a.b: no component 'a'"):
        build_system(load("quarter-car", ["connections=['a.b -> wheel.force']"]))
    file.write_text('extends = "quarter-car"\n[tolerance]\n"wheel.lod" = 1e-3\n')
    said = r"^mine.toml:3: tolerance.wheel.lod: no such output"
    with pytest.raises(ScenarioError, match=said):  # as a study reads it
        read_tables(file, ["stop_time=2 ms"])
    with pytest.raises(ScenarioError, match=said):
        build_system(tribocosim.load(file).native().check())
    with pytest.raises(ScenarioError, match=said):
        build_system(load(file).with_native_fmus())


def test_faults_of_keys_values_and_connections_are_told_at_once(tmp_path):
    """Also what later checks would find: a value out of range, one without its unit, an unknown end."""
    file = tmp_path / "mine.toml"
    file.write_text(
        'extends = "valve-train"\nstoptime = 1\nconnections = ["camshft.cam_lift -> flywheel.drive_torque"]\n'
        '[components.camshaft]\nlifttable = "cam.csv"\n[components.camshaft.parameters]\n'
        'law = "cycloid"\nbase_radius = "17"\nramp_height = "-0.2 mm"\n'
    )
    with pytest.raises(ScenarioError) as error:
        load(file)
    found = {in_command_line(fault.words).split(": ")[1].partition(" = ")[0] for fault in error.value.faults}
    values = {f"components.camshaft.parameters.{name}" for name in ("law", "base_radius", "ramp_height")}
    assert found == {"stoptime", "connections", "components.camshaft.lifttable", *values}
    assert "no component 'camshft'; did you mean camshaft?" in in_command_line(error.value)


@pytest.mark.parametrize(
    ("content", "place", "remedy"),
    [
        ("[components.contact]\nmacro_step = 1", "components.contact.macro_step", "put macro_step"),
        ("[components.contact]\nparameters.stop_time = 1", "components.contact.parameters.stop_time", "put"),
        ("[master]\nname = 'iterated'\nstop_time = 1", "master.stop_time", "put stop_time"),
        ("ledger = true", "ledger", "did you mean energy.ledger?"),
    ],
)
def test_a_key_in_a_wrong_table_is_sent_to_its_own(content, place, remedy, tmp_path):
    """In TOML a key belongs to the table above it, also where it was meant for the whole file."""
    file = tmp_path / "mine.toml"
    file.write_text(f'extends = "valve-train"\n{content}\n')
    with pytest.raises(ScenarioError) as error:
        load(file)
    (fault,) = error.value.faults
    assert fault.place == place
    assert fault.remedy.startswith(remedy)


def test_without_an_equilibrium_the_odd_parameter_and_the_cure_are_named():
    """A tappet that a load presses away from its cam has none."""
    content = {
        "name": "pressed",
        "stop_time": 1.0,
        "macro_step": 0.1,
        "connections": [],
        "reference": {"enabled": False},
        "components": {
            "tappet": {
                "component": "tappet",
                "parameters": {"mass": 80.0, "guide_damping": 5.0},
                "inputs": {"load": 100.0},
            }
        },
    }
    scenario = build_scenario(content)
    with pytest.raises(ModelError) as error:
        resolve_start(scenario, build_system(scenario))
    assert "tappet.velocity still changes at" in str(error.value)
    assert "tappet.mass = 80 kg" in str(error.value)
    assert 'start = "given"' in str(error.value)


def test_a_bad_file_in_place_of_a_component_is_the_participants_fault(tmp_path):
    (tmp_path / "text.fmu").write_text("no archive")
    table = "stop_time = 1\nmacro_step = 0.1\nreference.enabled = false\n[components.cam]\n"
    for name, words in {"none.fmu": "no such file", "text.fmu": "not an FMU"}.items():
        file = tmp_path / "mine.toml"
        file.write_text(f"{table}participant = '{name}'\nparameters = {{ lift = 1 }}\n")
        with pytest.raises(ScenarioError) as error:
            load(file)
        assert str(error.value).startswith(f"mine.toml:5: components.cam.participant: {tmp_path / name}: ")
        assert words in str(error.value)
        assert "\n" not in str(error.value)


def test_files_that_cannot_be_read(tmp_path):
    broken = tmp_path / "broken.toml"
    broken.write_text("macro_step = \n")
    loop = tmp_path / "loop.toml"
    loop.write_text('extends = "loop.toml"\n')
    bare = tmp_path / "bare.toml"
    bare.write_text("macro_step = 1e-5\n")
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    for name, words in {
        broken: ("broken.toml", "not a valid TOML file", "line 1"),
        loop: ("loop.toml", "extends itself"),
        bare: ("components: missing", "stop_time: missing", "tolerance: missing"),
        binary: ("binary.toml", "not a valid TOML file"),
        tmp_path / "none.toml": ("none.toml", "no such scenario file"),
        tmp_path: (str(tmp_path), "is a folder; give a file in it", "bare.toml"),
        "valve-trian": ("valve-trian", "did you mean valve-train?"),
    }.items():
        with pytest.raises(ScenarioError) as error:
            load(name)
        assert all(word in str(error.value) for word in words), error.value


def test_a_name_that_may_mean_two_files_is_refused(tmp_path, monkeypatch):
    """A file of a shipped scenario's name may extend that scenario; on the command line it is named."""
    (tmp_path / "my-cam.toml").write_text('extends = "my-cam"\ndescription = "mine"\n')
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ScenarioError, match=r"my-cam: is a shipped scenario, but my-cam\.toml lies here"):
        load("my-cam")
    assert load("my-cam.toml").description == "mine"


@pytest.mark.parametrize("setting", ["motion=free", "final_speed=2000 rpm", "initial_speed=0"])
def test_without_a_constant_speed_revolutions_are_refused(setting):
    with pytest.raises(ScenarioError) as error:
        load("valve-train", ["stop_time=2 revolutions", f"components.flywheel.parameters.{setting}"])
    assert "stop_time = '2 revolutions'" in str(error.value)
    assert "constant speed" in str(error.value)
    with pytest.raises(ScenarioError, match="stop_time"):  # there is no drive
        load("two-masses", ["stop_time=2 revolutions"])


@pytest.mark.parametrize(
    "wrong", ["parameters=3", "parameters.initial_speed=[1]", "parameters.initial_speed=3 kg"]
)
def test_a_wrong_type_is_the_fault_and_not_the_duration(wrong):
    with pytest.raises(ScenarioError) as error:
        load("valve-train", ["stop_time=2 revolutions", f"components.flywheel.{wrong}"])
    assert f"components.flywheel.{wrong.partition('=')[0]}" in str(error.value)
    assert "stop_time" not in str(error.value)


@pytest.mark.parametrize("name", ["valve-train", "finger-follower-hla", "shaft-in-bearings", "engine"])
def test_a_value_out_of_its_range_is_named_by_the_path_that_set_takes(name):
    """Each of every component; also numbers that its requirements compare, and start values."""
    tried = 0
    for part, table in load(name).components.items():
        for section, layout in list_layouts(table.resolve()).items():
            for variable in layout.variables:
                quantity = layout.field(variable).quantity
                least = quantity.limits()[0]
                driven = section == "inputs" or "[" in variable or quantity.internal
                if not math.isfinite(least) or quantity.discrete or driven:
                    continue
                path = f"components.{part}.{section}.{variable}"
                with pytest.raises((ModelError, ScenarioError)) as error:
                    build_system(load(name, [f"{path}={least - 1.0!r}"]))
                assert re.search(rf"--set {re.escape(path)}[ :]", in_command_line(error.value)), path
                tried += 1
    assert tried > 10
