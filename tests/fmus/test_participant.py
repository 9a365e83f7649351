"""An FMU as participant gives what the component in this process gives, rates of outputs as well."""

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from fmus.build import NAMES
from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.quantities import Vector
from models.core.system import Instance
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.participants.protocol import BoundVariables, Participant

from ..archives import replace_text
from .names import ALWAYS
from .reference import joined, wave

STEP = 1e-5


class Bound:
    """A participant with all inputs and Real outputs bound, started with the waves' values."""

    def __init__(self, participant: Participant, component: Component, rows: int, rated: bool = True) -> None:
        self.participant, self.component = participant, component
        self.names = [f.name for f in component.outputs.fields if not f.quantity.discrete]
        self.inputs = np.zeros((rows, component.inputs.size))
        self.outputs = np.zeros(len(self.names))
        self.rates = np.zeros(len(self.names) if rated else 0)
        bound = BoundVariables(component.inputs.names, self.inputs, self.names, self.outputs, self.rates)
        self.given = participant.connect(bound)
        participant.initialise(0.0, 1.0)
        self.write(0.0)
        participant.read()
        participant.finish_initialisation()

    def write(self, t: float) -> None:
        values = wave(self.component, t)
        for j, name in enumerate(self.component.inputs.names):
            self.inputs[:, j] = [values[joined(name, order)] for order in range(len(self.inputs))]
        self.participant.write()

    def advance(self, t: float) -> None:
        self.participant.advance(t, STEP)

    def read(self) -> list[float]:
        self.participant.read()
        return [*self.outputs.tolist(), *self.rates.tolist()]

    def run(self, begin: int, steps: int) -> list[list[float]]:
        """What is read after every step and every write."""
        found = []
        for i in range(begin, begin + steps):
            self.write(i * STEP)
            found.append(self.read())
            self.advance(i * STEP)
            found.append(self.read())
        return found


def both(name: str, path: Path, rows: int) -> tuple[Bound, Bound]:
    instance = Instance(CATALOGUE[name]())
    packaged, direct = open_fmu(name, path, instance), in_process(name, instance)
    return Bound(packaged, instance.component, rows), Bound(direct, instance.component, rows)


# Every component with all derivatives of its inputs, one with fewer.
ROWS = [
    *(pytest.param(name, 4, marks=() if name in ALWAYS else pytest.mark.long) for name in NAMES),
    *(("valve_spring", rows) for rows in (1, 2)),
]


@pytest.mark.parametrize(("name", "rows"), ROWS)
def test_values_and_rates_are_equal(name: str, rows: int, fmu_files: dict[str, Path]) -> None:
    """To the last bit, between steps and after a return to a saved state too."""
    packaged, direct = both(name, fmu_files[name], rows)
    assert all(packaged.given)
    assert all(direct.given)
    assert packaged.run(0, 20) == direct.run(0, 20)
    saved = [(unit, unit.participant.save(), unit.read()) for unit in (packaged, direct)]
    later = packaged.run(20, 10)
    assert later == direct.run(20, 10)
    for unit, state, there in saved:
        unit.participant.restore(state)
        assert unit.read() == there
        assert unit.run(20, 10) == later
        unit.participant.release(state)
        unit.participant.close()


@pytest.mark.parametrize("kind", ["fmu", "in_process"])
def test_rates_that_are_not_wanted(kind: str, fmu_files: dict[str, Path]) -> None:
    """Values are the same without them."""
    instance = Instance(CATALOGUE["valve_spring"]())
    found = []
    for rated in (True, False):
        made = (
            open_fmu("one", fmu_files["valve_spring"], instance)
            if kind == "fmu"
            else in_process("one", instance)
        )
        unit = Bound(made, instance.component, 2, rated)
        assert unit.given == [rated] * len(unit.names)
        unit.run(0, 5)
        found.append(unit.outputs.tolist())
        made.close()
    assert found[0] == found[1]


def test_only_declared_rates_are_given(fmu_files: dict[str, Path], tmp_path: Path) -> None:
    """Of a valve spring that does not declare the rate of its velocity: what is not given stays as it is;
    what is given does not move to another place."""
    described = zipfile.ZipFile(fmu_files["valve_spring"]).read("modelDescription.xml").decode()
    declared = re.search(r'name="der\(velocity\)".*?>.*?( derivative="\d+")', described, re.DOTALL)
    assert declared
    whole = declared[0]
    third_party = replace_text(
        fmu_files["valve_spring"], tmp_path / "other.fmu", whole, whole.replace(declared[1], "")
    )
    packaged, direct = both("valve_spring", third_party, 2)
    assert dict(zip(packaged.names, packaged.given, strict=True)) == {
        name: name != "velocity" for name in packaged.names
    }
    place = packaged.names.index("velocity")
    packaged.rates[place] = 7.0
    packaged.run(0, 5)
    direct.run(0, 5)
    assert packaged.rates[place] == 7.0
    direct.rates[place] = 7.0
    assert packaged.rates.tolist() == direct.rates.tolist()
    packaged.participant.close()


def test_discrete_outputs_have_rate_zero(fmu_files: dict[str, Path]) -> None:
    instance = Instance(CATALOGUE["slider_crank"]())
    names = ["psi", "sliding"]
    for unit in (open_fmu("one", fmu_files["slider_crank"], instance), in_process("one", instance)):
        rates: Vector = np.full(2, 7.0)
        given = unit.connect(BoundVariables([], np.zeros((1, 0)), names, np.zeros(2), rates))
        unit.initialise(0.0, 1.0)
        unit.read()
        unit.close()
        assert list(given) == [True, True]
        assert rates[1] == 0.0


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="reads Linux's table of what is loaded")
def test_a_library_stays_loaded_once(fmu_files: dict[str, Path]) -> None:
    """Python FMUs' libraries cannot be unloaded: a loop of runs would load copy after copy."""

    def open_and_list() -> set[str]:
        open_fmu("one", fmu_files["flywheel"], Instance(CATALOGUE["flywheel"]())).close()
        lines = Path("/proc/self/maps").read_text("utf-8").splitlines()
        return {line.split()[4] for line in lines if "/flywheel.so" in line}

    assert open_and_list() == open_and_list() != set()
