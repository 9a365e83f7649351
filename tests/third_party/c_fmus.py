"""FMUs in C as they come from elsewhere, compiled with whatever compiler is there; descriptions alone."""

import functools
import importlib.util
import platform
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from xml.sax.saxutils import quoteattr

import fmpy
import pytest
from fmpy.fmi3 import _FMU3, FMU3Slave

from tests.shared import made_once

from .models import MODELS, Model, V

SHELL = Path(__file__).with_name("shell.c")
HEADERS = Path(fmpy.__file__).parent / "c-code"
TOKEN = "{1e0f7c2a-0000-4b6e-9d50-5d1c0fa3c0de}"
# FMI 2.0's types by those of FMI 3.0.
OF_FMI2 = {"Float64": "Real", "Float32": "Real", "Int32": "Integer", "Int64": "Integer", "Boolean": "Boolean"}
OF_FMI2 |= {"String": "String", "Binary": "String", "Enumeration": "Enumeration"}
# What FMI 3.0 has as an element, not as an attribute.
STARTING = {"String": "", "Binary": "00"}

UNITS = {
    "m": 'm="1"',
    "mm": 'm="1" factor="1e-3"',
    "m/s": 'm="1" s="-1"',
    "rad/s": 'rad="1" s="-1"',
    "r/min": 'rad="1" s="-1" factor="0.10471975511965977"',
    "K": 'K="1"',
    "degC": 'K="1" offset="273.15"',
}


def fmu(name: str, version: int, folder: Path) -> Path:
    """The FMU of that name of `MODELS`, in the folder; the test is skipped where none can be compiled."""
    path = folder / f"{name}{version}.fmu"
    model = MODELS[name]
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", _description(name, model, version))
        archive.writestr(_place(name, version), _library(name, version))
    return path


@functools.cache
def _library(name: str, version: int) -> bytes:
    """The compiled model."""

    def write(folder: Path) -> list[str]:
        model, stubs = folder / "model.c", folder / "stubs.c"
        model.write_text(_c_of(MODELS[name]))
        stubs.write_text(_stubs() if version == 3 else "")
        return [f"-DFMI={version}", f'-DMODEL="{model}"', f'-DTOKEN="{TOKEN}"', str(SHELL), str(stubs)]

    return library(f"{name}{version}", write)


def library(name: str, write: Callable[[Path], list[str]]) -> bytes:
    """A shared library of the sources that `write(folder)` makes; it returns them with further options."""
    command = [*compiler(), "-shared", "-fPIC", "-O1", "-w", f"-I{HEADERS}"]

    def build(folder: Path) -> None:
        subprocess.run(
            [*command, *write(folder), "-o", str(folder / "library.so"), "-lm"],
            check=True,
            capture_output=True,
        )

    return (made_once(f"c_fmus-{name}", build) / "library.so").read_bytes()


def _stubs() -> str:
    made = ("Get", "Set"), ("Float64", "Float32", "Int32", "Int64", "UInt64", "Boolean")
    own = {f"fmi3{access}{kind}" for access in made[0] for kind in made[1]}
    return build_stubs(SHELL.read_text(), own)


def build_stubs(written: str, own: set[str]) -> str:
    """C of what FMI 3.0 has besides: every function has to be there."""
    functions = [name for name in vars(FMU3Slave) | vars(_FMU3) if name.startswith("fmi3")]
    others = ("fmi3InstantiateModelExchange", "fmi3InstantiateScheduledExecution")
    missing = [name for name in functions if name not in own and f"{name}(" not in written]
    return "".join(
        f"void *{name}(void) {{ return 0; }}\n" if name in others else f"int {name}(void) {{ return 3; }}\n"
        for name in missing
    )


@functools.cache
def compiler() -> list[str]:
    """The command of a C compiler; the test is skipped if there is none."""
    if sys.platform.startswith("win"):
        pytest.skip("the C of these FMUs is POSIX's")
    if found := shutil.which("cc") or shutil.which("gcc") or shutil.which("clang"):
        return [found]
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc"]
    pytest.skip("needs a C compiler: cc, gcc, clang or the package ziglang")


def _c_of(model: Model) -> str:
    places, count = {}, 0
    for v in model.variables:
        places[v.name] = count
        count += v.size

    def named(code: str) -> str:
        for name in sorted(places, key=len, reverse=True):
            for written in (f"${{{name}}}", f"${name}"):
                code = code.replace(written, f"v[{places[name]}]")
        return code

    starts = ", ".join(repr(value) for v in model.variables for value in v.starts)
    counts = {v.name: f"(size_t)m->v[{places[v.counted]}]" if v.counted else v.size for v in model.variables}
    sizes = " ".join(f"(r) == {places[v.name]} ? {counts[v.name]} :" for v in model.variables if v.size > 1)
    rates = " ".join(f"(r) == {places[of]} ? {places[rate]} :" for of, rate in model.rates.items())
    return (
        f"#define COUNT {count}\n#define START {{ {starts} }}\n#define SIZE(r) ({sizes} 1)\n"
        f"#define RATE(r) ({rates} -1)\n#define HIGHEST {model.highest}\n"
        f"#define READING {model.reading}\n#define LEAVING {model.leaving}\n"
        f"static void output(Instance *m, double *v) {{ {named(model.output)} }}\n"
        f"static int step(Instance *m, double *v, double t, double h) {{ {named(model.step)} return OK; }}\n"
    )


def _place(name: str, version: int) -> str:
    machine = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    system, suffix = ("darwin", ".dylib") if sys.platform == "darwin" else ("linux", ".so")
    if version == 3:
        return f"binaries/{machine}-{system}/{name}{suffix}"
    return f"binaries/{'darwin64' if system == 'darwin' else 'linux64'}/{name}{suffix}"


def _description(name: str, model: Model, version: int) -> str:
    kind = "guid" if version == 2 else "instantiationToken"
    abilities = model.abilities
    if version == 3:
        abilities = abilities.replace("FMUstate", "FMUState").replace("Derivative=", "Derivatives=")
    variables, index, reference = [], {}, 0
    for number, v in enumerate(model.variables, 1):
        index[v.name] = number if version == 2 else reference
        variables.append((v, reference))
        reference += v.size
    written = "\n".join(
        (_variable2 if version == 2 else _variable3)(v, reference, index) for v, reference in variables
    )
    if version == 3:
        written += (
            f'<Float64 name="time" valueReference="{reference}" causality="independent" '
            'variability="continuous"/>'
        )
    used = dict.fromkeys(v.unit for v in model.variables if v.unit)
    units = "".join(f'<Unit name="{unit}"><BaseUnit {UNITS[unit]}/></Unit>' for unit in used)
    types = "".join(_enumeration(v, version) for v in model.variables if v.items)
    outputs = [v.name for v in model.variables if v.causality == "output"]

    def unknown(tag: str) -> str:
        attribute = "index" if version == 2 else "valueReference"
        found = []
        for one in outputs:
            depends = model.depends.get(one, ())
            inputs = " ".join(str(index[d]) for d in depends)
            found.append(f'<{tag} {attribute}="{index[one]}" dependencies="{inputs}"/>')
        return "".join(found)

    states = [v.name for v in model.variables if v.derivative and "Directional" in abilities]
    if version == 2:
        derivatives = "".join(f'<Unknown index="{index[name]}"/>' for name in states)
        structure = f"<Outputs>{unknown('Unknown')}</Outputs>"
        structure += f"<Derivatives>{derivatives}</Derivatives>" if states else ""
    else:
        structure = unknown("Output")
        structure += "".join(
            f'<ContinuousStateDerivative valueReference="{index[name]}"/>' for name in states
        )
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<fmiModelDescription fmiVersion="{version}.0" '
        f'modelName="{name}" {kind}="{TOKEN}">'
        f'<CoSimulation modelIdentifier="{name}" {abilities}'
        f'canHandleVariableCommunicationStepSize="{str(model.variable_step).lower()}"/>'
        f"{f'<UnitDefinitions>{units}</UnitDefinitions>' if units else ''}"
        f"{f'<TypeDefinitions>{types}</TypeDefinitions>' if types else ''}"
        f'<DefaultExperiment startTime="0" stopTime="1" stepSize="0.01"/>'
        f"<ModelVariables>{written}</ModelVariables><ModelStructure>{structure}</ModelStructure>"
        "</fmiModelDescription>"
    )


def _enumeration(v: V, version: int) -> str:
    """The type of the variable's name."""
    items = "".join(f'<Item name="{name}" value="{number}"/>' for name, number in v.items)
    if version == 3:
        return f'<EnumerationType name="{v.name}">{items}</EnumerationType>'
    return f'<SimpleType name="{v.name}"><Enumeration>{items}</Enumeration></SimpleType>'


def _attributes(v: V) -> str:
    varying = v.varying or {"parameter": "fixed", "structuralParameter": "fixed"}.get(
        v.causality, "continuous" if v.type.startswith("Float") else "discrete"
    )
    initial = f'initial="{v.initial}" ' if v.initial else ""
    return f'causality="{v.causality}" variability="{varying}" {initial}'


def _start(v: V) -> str:
    if v.causality not in ("parameter", "structuralParameter", "input") and not v.initial:
        return ""
    if v.type in STARTING:
        return 'start=""'
    if v.type == "Boolean":
        return f'start="{str(bool(v.start)).lower()}" '
    values = v.starts if v.type.startswith("Float") else map(int, v.starts)
    shown = list(values)[: len(v.start) if isinstance(v.start, list) else v.size]
    return f'start="{" ".join(map(str, shown))}" '


def _variable2(v: V, reference: int, index: dict[str, int]) -> str:
    assert v.size == 1
    unit = f'unit="{v.unit}" ' if v.unit else ""
    derivative = f'derivative="{index[v.derivative]}" ' if v.derivative else ""
    declared = f'declaredType="{v.name}" ' if v.items else ""
    return (
        f'<ScalarVariable name={quoteattr(v.name)} valueReference="{reference}" {_attributes(v)}>'
        f"<{OF_FMI2[v.type]} {declared}{unit}{_start(v)}{derivative}{v.more}/></ScalarVariable>"
    )


def _variable3(v: V, reference: int, index: dict[str, int]) -> str:
    unit = f'unit="{v.unit}" ' if v.unit else ""
    derivative = f'derivative="{index[v.derivative]}" ' if v.derivative else ""
    declared = f'declaredType="{v.name}" ' if v.items else ""
    shape = [2, 2] if v.size == 4 else [v.size]
    inside = "".join(f'<Dimension start="{n}"/>' for n in shape) if v.size > 1 else ""
    if v.counted:
        inside = f'<Dimension valueReference="{index[v.counted]}"/>'
    if v.type in STARTING:
        return (
            f'<{v.type} name={quoteattr(v.name)} valueReference="{reference}" {_attributes(v)}>'
            f'<Start value="{STARTING[v.type]}"/></{v.type}>'
        )
    return (
        f'<{v.type} name={quoteattr(v.name)} valueReference="{reference}" {_attributes(v)}{unit}{_start(v)}'
        f"{declared}{derivative}{v.more}>{inside}{v.inside}</{v.type}>"
    )


ABLE = 'canGetAndSetFMUstate="true" canHandleVariableCommunicationStepSize="true"'
DEFINED = (
    '<UnitDefinitions><Unit name="K"><BaseUnit K="1"/></Unit>'
    '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>'
    '<Unit name="degF"><BaseUnit K="1" factor="0.5555555555555556"/></Unit>'  # no offset
    '<Unit name="celsius"><BaseUnit K="1" offset="273.1500001"/></Unit></UnitDefinitions>'
)


def describe2(
    path: Path,
    variables: str,
    *,
    head: str = "",
    types: str = "",
    structure: str = "",
) -> Path:
    """An FMU of FMI 2.0 with these elements."""
    return _write(
        path,
        f'<fmiModelDescription fmiVersion="2.0" modelName="{path.stem}" guid="g">'
        f'<CoSimulation modelIdentifier="m" {ABLE}/>{DEFINED}<TypeDefinitions>{types}</TypeDefinitions>{head}'
        f"<ModelVariables>{variables}</ModelVariables><ModelStructure>{structure}</ModelStructure>",
    )


def describe3(path: Path, variables: str, *, types: str = "") -> Path:
    """The same of FMI 3.0."""
    time = '<Float64 name="time" valueReference="999" causality="independent" variability="continuous"/>'
    return _write(
        path,
        f'<fmiModelDescription fmiVersion="3.0" modelName="{path.stem}" instantiationToken="t">'
        f'<CoSimulation modelIdentifier="m" {ABLE.replace("FMUstate", "FMUState")}/>{DEFINED}'
        f"<TypeDefinitions>{types}</TypeDefinitions><ModelVariables>{variables}{time}</ModelVariables>"
        "<ModelStructure/>",
    )


def real2(
    name: str, reference: int, causality: str, attributes: str = "", varying: str = "continuous"
) -> str:
    """A Real of FMI 2.0."""
    return (
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="{varying}"><Real {attributes}/></ScalarVariable>'
    )


def _write(path: Path, text: str) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text + "</fmiModelDescription>")
        for folder in (fmpy.platform, fmpy.platform_tuple):
            archive.writestr(f"binaries/{folder}/m{fmpy.sharedLibraryExtension}", b"")
    return path
