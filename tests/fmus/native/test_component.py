"""FMUs as WebAssembly components by the draft FMI-LS-WASM: what native code does, to the last bit."""

import platform
import subprocess
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

import tribocosim
from fmus.fmi.layered import COMPONENT_MANIFEST
from fmus.fmi.validate import validate
from fmus.native.fmu import NAMES, build
from fmus.native.machine_code import this_platform
from orchestrator.errors import MistakeError

from ..instance import Instance3
from ..kinds import Made
from ..reference import Reference, schedule
from .component import Component, Slave
from .programs import stepped_program
from .test_fmi3_events import REFUSED, STOP, check_refusal, cubic, refused

pytest.importorskip("ziglang", reason="needs the package ziglang")

BALL = "tests.fmus.native.bouncing_ball:wordy_ball"
STARTS = {"coil_position_start": [1e-4, -2e-4], "coil_velocity_start": [0.3, 0.1]}
HEADER = len("tribocosim native state 1 ") + 16 + 1  # of saved states, before the memory
LONGEST = 1023  # bytes of a message about values
IMPLIED = "2 values for 1 variables"  # what gets values says how many there are
PLATFORMS = (this_platform(), "wasm32-wasip2")
FILES = Made(lambda name: build(name, platforms=PLATFORMS, fmi=3))
STEPS, STEP = 30, 2e-5
LIVES = 400


@pytest.fixture
def spring() -> Iterator[Component]:
    slave = Component(FILES["valve_spring"])
    yield slave
    slave.free()


def test_steps_values_and_states_are_those_of_native_code() -> None:
    """A state that one has saved is the other's, byte for byte; so are derivatives, of arrays too."""
    component, library = pair = [kind(FILES["valve_spring"]) for kind in (Component, Instance3)]
    plan = schedule(Reference("valve_spring").component, STEPS, STEP)
    for slave in pair:
        slave.initialize(**STARTS)
        for row in plan:
            slave.set(row["inputs"])
            slave.step(row["t"], row["h"])
    assert component.outputs() == library.outputs()
    saved = library.saved_bytes()
    assert component.saved_bytes() == saved
    component.step(row["t"] + row["h"], STEP)
    assert component.saved_bytes() != saved
    component.restore_bytes(saved)
    of, by = (
        [library.variables[name].valueReference for name in names]
        for names in (["position", "der(state.coil_velocity)"], ["load", "state.coil_position"])
    )
    given = (of, by, [1.0, -2.0, 0.5], 3)
    for call in ("getDirectionalDerivative", "getAdjointDerivative"):
        assert getattr(component.fmu, call)(*given) == getattr(library.fmu, call)(*given)
    rate = library.fmu.getOutputDerivatives(of[:1], [1])
    assert component.fmu.getOutputDerivatives([(of[0], 1)]) == rate != [0.0]
    assert component.saved_bytes() == saved
    for slave in pair:
        slave.free()


@pytest.mark.long
@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="the program is for x86-64")
@pytest.mark.parametrize("name", NAMES)
def test_every_component_computes_the_bits_of_native_code(name: str, tmp_path: Path) -> None:
    """The same C and kernels for this machine, with the same mathematical library, musl's."""
    slave = Component(FILES[name]).initialize()
    plan = schedule(Reference(name).component, STEPS, STEP)
    given = sorted(plan[0]["inputs"], key=lambda one: slave.variables[one].valueReference)
    found = []
    for row in plan:
        slave.set(row["inputs"])
        slave.step(row["t"], row["h"])
        slave.outputs()
        found.append(np.frombuffer(slave.saved_bytes()[HEADER:], np.int64))
    slave.free()
    rows = np.array([[row["t"], row["h"], *map(row["inputs"].get, given)] for row in plan])
    program = stepped_program(name, tmp_path)
    made = subprocess.run([program], input=rows.tobytes(), capture_output=True, check=True).stdout
    right = np.frombuffer(made, np.int64).reshape(len(plan), -1)
    np.testing.assert_array_equal(np.array(found)[:, : right.shape[1]], right)


@pytest.mark.parametrize("row", [row for row in REFUSED if row[1] != IMPLIED], ids=lambda row: row[1])
def test_what_is_refused_has_the_reason_of_native_code(spring: Component, row: tuple[Any, ...]) -> None:
    check_refusal(spring, row)


def test_instances_are_refused_with_the_reason() -> None:
    told: list[str] = []
    folder = fmpy.extract(str(FILES["valve_spring"]))
    slave = Slave(
        guid="{0}", unzipDirectory=folder, modelIdentifier="valve_spring", instanceName="\N{DIAMETER SIGN} 5"
    )
    with pytest.raises(FMICallException):
        slave.instantiate(logMessage=lambda *message: told.append(message[3].decode()))
    assert "the instantiationToken must be {" in told[0]
    assert slave.find("get-version", "common")(slave.store) == "3.0"


def test_steps_end_at_events_and_where_the_host_wants() -> None:
    """As in native code."""

    def ask(time: float, setting: bool, finished: bool, possible: bool) -> float | None:
        return time + 0.3 if possible else None

    ends = []
    for kind in (Component, Instance3):
        slave = kind(FILES[BALL], update=ask, eventModeUsed=True, earlyReturnAllowed=True).initialize()
        t, path = 0.0, []
        while t < STOP - 1e-9:
            event, ended, early, t = slave.step(t, STOP - t)
            path.append((event, ended, early, t, *slave.get(["velocity", "bounces"])))
            if event:
                slave.fmu.enterEventMode()
                slave.handle_events()
        slave.free()
        ends.append(path)
    assert ends[0] == ends[1]
    assert {row[0] for row in path} == {True, False}


def test_hosts_set_inputs_and_read_outputs_within_steps() -> None:
    """As in native code; refused calls from there disturb nothing."""

    def give(time: float, setting: bool, finished: bool, possible: bool) -> None:
        seen.append((time, setting, finished, possible))
        if setting:
            slave.fmu.setFloat64(push, [cubic(time)])
        else:
            seen.append(slave.get(["velocity"]))
            with pytest.raises(FMICallException):
                slave.step(time, 1e-3)

    described = fmpy.read_model_description(str(FILES[BALL]))
    push = [v.valueReference for v in described.modelVariables if v.name == "push"]
    told = []
    for kind in (Component, Instance3):
        seen: list[Any] = []
        slave = kind(FILES[BALL], update=give, requiredIntermediateVariables=push).initialize()
        seen += [slave.step(i * 1e-2, 1e-2) for i in range(10)] + slave.outputs()
        slave.free()
        told.append(seen)
    assert told[0] == told[1]
    read = [one for one in seen if isinstance(one, list)]
    assert (len(read), read[0]) == (20, [0.0])
    assert read[-1] != [0.0]


def test_messages_are_whole_characters() -> None:
    """Where a long one is cut: what is no UTF-8 would end the host's call."""
    slave = Component(FILES[BALL])
    said = refused(slave, lambda: slave.initialize(restitution=-1.0))
    before = "restitution = -1 ("
    assert said == before + (LONGEST - len(before)) // 2 * "\N{GREEK SMALL LETTER EPSILON}"
    slave.free()


def test_calls_and_instances_leave_no_memory_behind(spring: Component) -> None:
    """In so little memory that a quarter of them would fill it."""
    spring.initialize()
    first = spring.saved_bytes()
    spring.fmu.store.set_limits(memory_size=2 << 20)
    name = "long " * 5000
    for _ in range(LIVES):
        spring.restore_bytes(spring.saved_bytes())
        spring.fmu.make(name).drop(spring.fmu.store)
    assert spring.saved_bytes() == first
    assert LIVES * len(name) > 4 * (2 << 20)


def test_the_platform_is_chosen_and_described(tmp_path: Path) -> None:
    file = FILES["valve_spring"]
    assert validate(file) == []
    with zipfile.ZipFile(file) as archive:
        manifest = ElementTree.fromstring(archive.read(COMPONENT_MANIFEST))
        licences = {
            one: archive.read(f"documentation/licenses/{one}.txt").decode() for one in ("musl", "cloudlibc")
        }
    assert "Rich Felker" in licences["musl"]
    assert "Redistributions in binary form must reproduce" in licences["cloudlibc"]
    assert "org.modelica.fmi-ls-wasm" in manifest.attrib.values()
    with pytest.raises(MistakeError, match=r"^platform='wasm32-wasip2': is none of FMI 2; add fmi=3$"):
        tribocosim.build_fmu("valve_spring", tmp_path, native=True, platforms=["wasm32-wasip2"])
