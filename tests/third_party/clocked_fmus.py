"""FMUs in C with event mode and clocks (`sampler.c`, `intervals.c`)."""

import platform
import sys
import zipfile
from pathlib import Path

from .c_fmus import build_stubs, library

HERE = Path(__file__).parent
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="sampler" instantiationToken="sampler">
<CoSimulation modelIdentifier="sampler" hasEventMode="true" canGetAndSetFMUState="true"
 canSerializeFMUState="true" canHandleVariableCommunicationStepSize="true"/>
<DefaultExperiment startTime="0" stopTime="1" stepSize="0.01"/>
<ModelVariables>
<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
<Float64 name="u" valueReference="1" causality="input" variability="discrete" clocks="100" start="0"/>
<Float64 name="y" valueReference="2" causality="output" variability="discrete"/>
<Float64 name="ticks" valueReference="3" causality="output" variability="discrete"/>
<Float64 name="alarms" valueReference="4" causality="output" variability="discrete"/>
<Float64 name="pokes" valueReference="5" causality="output" variability="discrete"/>
<Float64 name="level" valueReference="6" causality="output" variability="discrete"/>
<Float64 name="gain" valueReference="7" causality="input" variability="discrete" start="1"/>
<Float64 name="scaled" valueReference="8" causality="output" variability="discrete"/>
<Float64 name="last" valueReference="9" causality="output" variability="discrete"/>
<Clock name="tick" valueReference="100" causality="input" intervalVariability="constant"
 intervalDecimal="0.1"/>
<Clock name="alarm" valueReference="101" causality="input" intervalVariability="countdown"/>
<Clock name="poke" valueReference="102" causality="input" intervalVariability="triggered"/>
<Clock name="fired" valueReference="103" causality="output" intervalVariability="triggered"/>
</ModelVariables><ModelStructure>
<Output valueReference="2" dependencies=""/><Output valueReference="3" dependencies=""/>
<Output valueReference="4" dependencies=""/><Output valueReference="5" dependencies=""/>
<Output valueReference="6" dependencies=""/><Output valueReference="8" dependencies="7"/>
<Output valueReference="9" dependencies=""/><Output valueReference="103" dependencies=""/>
</ModelStructure></fmiModelDescription>
"""


def sampler(folder: Path, description: str = DESCRIPTION) -> Path:
    """The FMU, in the folder; the test is skipped where none can be compiled."""
    return _pack("sampler", folder, description)


# By name: intervalVariability, and what more is stated.
CLOCKS = {
    "fixed": ("fixed", 'intervalDecimal="0.1" shiftDecimal="0.02"'),
    "tunable": ("tunable", 'intervalDecimal="0.2"'),
    "asked": ("fixed", ""),
    "tuned": ("tunable", ""),
    "changing": ("changing", ""),
}


def intervals(folder: Path) -> Path:
    """The FMU with these clocks; outputs are the number of ticks of each, and the sum of their times."""
    clocks = "".join(
        f'<Clock name="{name}" valueReference="{100 + i}" causality="input" '
        f'intervalVariability="{kind}" {more}/>'
        for i, (name, (kind, more)) in enumerate(CLOCKS.items())
    )
    names = [*(f"{name}_ticks" for name in CLOCKS), *(f"{name}_sum" for name in CLOCKS)]
    outputs = "".join(
        f'<Float64 name="{name}" valueReference="{i}" causality="output" variability="discrete"/>'
        for i, name in enumerate(names, 1)
    )
    structure = "".join(f'<Output valueReference="{i}" dependencies=""/>' for i in range(1, len(names) + 1))
    description = (
        '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="3.0" modelName="intervals" '
        'instantiationToken="intervals"><CoSimulation modelIdentifier="intervals" hasEventMode="true" '
        'canHandleVariableCommunicationStepSize="true"/><ModelVariables><Float64 name="time" '
        'valueReference="0" causality="independent" variability="continuous"/>'
        f"{outputs}{clocks}</ModelVariables><ModelStructure>{structure}</ModelStructure></fmiModelDescription>"
    )
    return _pack("intervals", folder, description)


def _pack(name: str, folder: Path, description: str) -> Path:
    path = folder / f"{name}.fmu"
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    place = f"darwin/{name}.dylib" if sys.platform == "darwin" else f"linux/{name}.so"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.writestr(f"binaries/{machine}-{place}", _build(HERE / f"{name}.c"))
    return path


def _build(source: Path) -> bytes:
    def write(folder: Path) -> list[str]:
        (folder / "stubs.c").write_text(build_stubs(source.read_text(), set()))
        return [str(source), str(folder / "stubs.c")]

    return library(source.stem, write)
