"""FMUs in C as they come from elsewhere, of FMI 2.0 and 3.0, in the spirit of the Modelica Association's
Reference-FMUs, and their vices. Compiled with whatever C compiler is there."""

from __future__ import annotations

import functools
import importlib.util
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.sax.saxutils import quoteattr

import fmpy
import pytest
from fmpy.fmi3 import _FMU3, FMU3Slave

SHELL = Path(__file__).with_name("shell.c")
HEADERS = Path(fmpy.__file__).parent / "c-code"
TOKEN = "{1e0f7c2a-0000-4b6e-9d50-5d1c0fa3c0de}"
# FMI 2.0's types by those of FMI 3.0.
OF_FMI2 = {"Float64": "Real", "Float32": "Real", "Int32": "Integer", "Int64": "Integer", "Boolean": "Boolean"}


@dataclass(frozen=True)
class V:
    """A variable; `size` > 1 makes it an array, of FMI 3.0 only."""

    name: str
    causality: str = "local"
    start: object = 0.0
    type: str = "Float64"
    unit: str = ""
    initial: str = ""
    size: int = 1
    derivative: str = ""
    more: str = ""

    @property
    def starts(self) -> list[float]:
        values = self.start if isinstance(self.start, list) else [self.start] * self.size
        return [float(value) for value in values]


@dataclass(frozen=True)
class Model:
    """`step` is C that moves v from t to t + h (`h`), `output` C that computes outputs of v and inputs.

    Variables are named in C by macros: `$name`. `depends`: the inputs of every output; `rates`: the variables
    that are derivatives of outputs, for the standard's call.
    """

    variables: tuple[V, ...]
    step: str = ""
    output: str = ""
    depends: dict[str, tuple[str, ...]] = field(default_factory=dict)
    abilities: str = 'canGetAndSetFMUstate="true" canSerializeFMUstate="true" '
    variable_step: bool = True
    rates: dict[str, str] = field(default_factory=dict)


UNITS = {
    "m": 'm="1"',
    "mm": 'm="1" factor="1e-3"',
    "m/s": 'm="1" s="-1"',
    "rad/s": 'rad="1" s="-1"',
    "r/min": 'rad="1" s="-1" factor="0.10471975511965977"',
    "K": 'K="1"',
    "degC": 'K="1" offset="273.15"',
}

EXPONENTIAL = "$x = $x * exp(-$k * h);"
MODELS = {
    # dx/dt = -k x, exactly.
    "dahlquist": Model((V("x", "output", 1.0, initial="exact"), V("k", "parameter", 1.0)), EXPONENTIAL),
    # dx/dt = v, dv/dt = -g, v <- -e v where x falls through 0; by Euler's steps of 1 ms.
    "ball": Model(
        (
            V("body.h", "output", 1.0, unit="m", initial="exact"),
            V("body.v", "output", 0.0, unit="m/s", initial="exact"),
            V("g", "parameter", 9.81),
            V("e", "parameter", 0.7),
            V("der(body.h)", "local", unit="m/s", derivative="body.h"),
        ),
        """
        int n = (int)round(h / 1e-3);
        for (int i = 0; i < n; i++) {
            ${body.h} += 1e-3 * ${body.v};
            ${body.v} -= 1e-3 * $g;
            if (${body.h} < 0.0 && ${body.v} < 0.0) { ${body.h} = 0.0; ${body.v} = -$e * ${body.v}; }
        }""",
        "${der(body.h)} = ${body.v};",
    ),
    # Van der Pol's oscillator, driven; by Heun's steps of 1 ms at most.
    "vanderpol": Model(
        (
            V("x", "output", 2.0, initial="exact"),
            V("v", "output", 0.0, initial="exact"),
            V("mu", "parameter", 1.0),
            V("force", "input"),
        ),
        """
        int n = (int)ceil(h / 1e-3 - 1e-9);
        for (int i = 0; i < n; i++) {
            double d = h / n, a = $mu * (1 - $x * $x) * $v - $x + $force;
            double p = $x + d * $v, q = $v + d * a;
            double b = $mu * (1 - p * p) * q - p + $force;
            $x += 0.5 * d * ($v + q); $v += 0.5 * d * (a + b);
        }""",
        depends={"x": (), "v": ()},
    ),
    "feedthrough": Model(
        (
            V("real in", "input", unit="m"),
            V("real out", "output", unit="m"),
            V("whole_in", "input", 0, "Int32"),
            V("whole_out", "output", 0, "Int32"),
            V("truth_in", "input", False, "Boolean"),
            V("truth_out", "output", False, "Boolean"),
            V("offset", "parameter", 0.0),
            V("count", "parameter", 0, "Int32"),
            V("negate", "parameter", False, "Boolean"),
        ),
        output="${real out} = ${real in} + $offset; $whole_out = $whole_in + $count; "
        "$truth_out = ($truth_in != 0) != ($negate != 0);",
        depends={"real out": ("real in",), "whole_out": ("whole_in",), "truth_out": ("truth_in",)},
    ),
    # Counts the seconds.
    "stair": Model((V("counter", "output", 0, "Int32"),), "$counter = floor(t + h + 1e-9);"),
    # y = A x, dx/dt = u, exactly for held inputs; arrays.
    "vector": Model(
        (
            V("x0", "parameter", [1.0, 2.0], size=2),
            V("A", "parameter", [1.0, 0.0, 0.0, 1.0], size=4),
            V("u", "input", [0.0, 0.0], size=2),
            V("y", "output", [0.0, 0.0], size=2),
            V("slope", "output", [0.0, 0.0], size=2, derivative="y"),
            V("started", "local"),
        ),
        "for (int i = 0; i < 2; i++) (&$x0)[i] += h * (&$u)[i];",
        """for (int i = 0; i < 2; i++) {
            (&$y)[i] = (&$A)[2 * i] * (&$x0)[0] + (&$A)[2 * i + 1] * (&$x0)[1];
            (&$slope)[i] = (&$A)[2 * i] * (&$u)[0] + (&$A)[2 * i + 1] * (&$u)[1];
        }""",
        depends={"y": (), "slope": ("u",)},
    ),
    # dy/dt = u, exactly for inputs that are cubics.
    "integral": Model(
        (V("y", "output"), V("u", "input"), V("u1"), V("u2"), V("u3")),
        "$y += h * ($u + h / 2 * ($u1 + h / 3 * ($u2 + h / 4 * $u3)));",
        abilities='canGetAndSetFMUstate="true" canInterpolateInputs="true" ',
    ),
    # A mass on a spring and a damper: m a = f - k x - d v, by Heun's steps of 0.1 ms at most.
    "sprung": Model(
        (
            V("position", "output", unit="m", initial="exact"),
            V("velocity", "output", unit="m/s", initial="exact"),
            V("force", "input"),
            V("mass", "parameter", 1.0),
            V("stiffness", "parameter", 10.0),
            V("damping", "parameter", 0.5),
            V("der(position)", unit="m/s", derivative="position"),
            V("der(velocity)", derivative="velocity"),
        ),
        """
        int n = (int)ceil(h / 1e-4 - 1e-9);
        for (int i = 0; i < n; i++) {
            double d = h / n, a = ($force - $stiffness * $position - $damping * $velocity) / $mass;
            double p = $position + d * $velocity, q = $velocity + d * a;
            double b = ($force - $stiffness * p - $damping * q) / $mass;
            $position += 0.5 * d * ($velocity + q); $velocity += 0.5 * d * (a + b);
        }""",
        "${der(position)} = $velocity; "
        "${der(velocity)} = ($force - $stiffness * $position - $damping * $velocity) / $mass;",
        depends={"position": (), "velocity": ()},
        abilities='providesDirectionalDerivative="true" ',
    ),
    # What names may be.
    "named": Model((V('a/b "c", [µ] <->', "output", 1.0, initial="exact"), V("der(x)", "output", 2.0)), ""),
    "shaft": Model(
        (V("speed", "output", 0.0, unit="r/min"), V("height", "input", unit="mm"),
         V("reached", "output", unit="mm"),
         V("air", "output", 20.0, unit="degC"), V("wall", "input", unit="K"), V("bare", "input"),
         V("felt", "output", unit="K"), V("given", "output")),
        "$speed = 60.0 * (t + h);",
        "$reached = $height; $felt = $wall; $given = $bare;",
        depends={"speed": (), "air": (), "reached": ("height",), "felt": ("wall",), "given": ("bare",)},
    ),
}  # fmt: skip

LIMITED = "if (t > 0.495) "
VICES = {
    "crashing": "raise(SIGSEGV);",
    "leaving": "_exit(7);",
    "quitting": "exit(0);",
    "aborting": "abort();",
    "hanging": "for (;;) pause();",
    "discarding": '{ say(m, DISCARD, "no way on"); return DISCARD; }',
    "erring": '{ say(m, ERROR, "out of range"); return ERROR; }',
    "fatal": '{ say(m, FATAL, "memory is gone"); return FATAL; }',
    "ending": '{ m->reached = 0.5; say(m, OK, "has landed"); return ENDED; }',
}
for _name, _code in VICES.items():
    _decay = MODELS["dahlquist"]
    MODELS[_name] = Model(_decay.variables, f"{LIMITED}{_code} {EXPONENTIAL}")
# Comes back halfway through every step that is longer than 6 ms.
MODELS["early"] = Model(
    MODELS["dahlquist"].variables,
    "if (h > 6e-3) { $x *= exp(-$k * h / 2); m->reached = t + h / 2; return EARLY; } " + EXPONENTIAL,
    abilities='mightReturnEarlyFromDoStep="true" ',
)
# Come back early without having got anywhere, from before the step, and from no time at all.
for _name, _reached in {"stuck": "t", "backwards": "t - 1", "timeless": "0.0 / 0.0"}.items():
    MODELS[_name] = replace(
        MODELS["early"], step=f"if (t > 0.495) {{ m->reached = {_reached}; return EARLY; }} " + EXPONENTIAL
    )
# Is a number until half of the run.
MODELS["vanishing"] = replace(MODELS["dahlquist"], step=EXPONENTIAL + " if (t > 0.495) $x = 0.0 / 0.0;")
# These give their rates by the standard's call only.
MODELS["called"] = replace(
    MODELS["sprung"],
    variables=tuple(replace(v, derivative="") for v in MODELS["sprung"].variables),
    abilities='maxOutputDerivativeOrder="1" ',
    rates={"position": "der(position)", "velocity": "der(velocity)"},
)
MODELS["called_vector"] = replace(
    MODELS["vector"],
    variables=tuple(replace(v, derivative="") for v in MODELS["vector"].variables),
    abilities='maxOutputDerivativeOrder="1" ',
    rates={"y": "slope"},
)
# Its output is right only when initialisation is over.
MODELS["late"] = Model(
    (V("x", "output"), V("x0", "parameter", 0.5)), output="if (m->initialised) $x = $x0;", depends={"x": ()}
)
# Says why in a message with arguments, as FMI 2.0 has them.
MODELS["formatting"] = Model(
    MODELS["dahlquist"].variables,
    LIMITED
    + '{ m->log->logger(m->environment, m->name, ERROR, "logStatus", "the %s of %s burst at %g s, 100 %%", '
    f'"boiler", m->name, t); return ERROR; }} {EXPONENTIAL}',
)
# Warn of every step after half a second, with a message and without.
for _name, _said in (("warning", 'say(m, WARNING, "getting hot"); '), ("muttering", "")):
    MODELS[_name] = Model(
        MODELS["dahlquist"].variables,
        f"{EXPONENTIAL} {LIMITED}{{ {_said}m->reached = t + h; return WARNING; }}",
    )
# Goes on when its step has returned.
MODELS["pending"] = Model(MODELS["dahlquist"].variables, f"{LIMITED}return 5; {EXPONENTIAL}")
# Cannot be looked at.
MODELS["blind"] = Model(MODELS["dahlquist"].variables, EXPONENTIAL, "raise(SIGSEGV);")
MODELS["rigid"] = Model(MODELS["dahlquist"].variables, EXPONENTIAL, abilities="", variable_step=False)
MODELS["single"] = Model(
    MODELS["dahlquist"].variables, EXPONENTIAL, abilities='canBeInstantiatedOnlyOncePerProcess="true" '
)


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
    with tempfile.TemporaryDirectory(prefix="c_fmus_") as scratch:
        folder = Path(scratch)
        model, stubs, library = folder / "model.c", folder / "stubs.c", folder / "model.so"
        model.write_text(_c_of(MODELS[name]))
        stubs.write_text(_stubs() if version == 3 else "")
        defined = [f"-DFMI={version}", f'-DMODEL="{model}"', f'-DTOKEN="{TOKEN}"', f"-I{HEADERS}"]
        command = [*compiler(), "-shared", "-fPIC", "-O1", "-w", *defined, str(SHELL), str(stubs)]
        subprocess.run([*command, "-o", str(library), "-lm"], check=True, capture_output=True)
        return library.read_bytes()


def _stubs() -> str:
    """What FMI 3.0 has besides: every function has to be there."""
    functions = [name for name in vars(FMU3Slave) | vars(_FMU3) if name.startswith("fmi3")]
    others = ("fmi3InstantiateModelExchange", "fmi3InstantiateScheduledExecution")
    written = SHELL.read_text()
    made = ("Get", "Set"), ("Float64", "Float32", "Int32", "Int64", "Boolean")
    own = {f"fmi3{access}{kind}" for access in made[0] for kind in made[1]}
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
    sizes = " ".join(f"(r) == {places[v.name]} ? {v.size} :" for v in model.variables if v.size > 1)
    rates = " ".join(f"(r) == {places[of]} ? {places[rate]} :" for of, rate in model.rates.items())
    return (
        f"#define COUNT {count}\n#define START {{ {starts} }}\n#define SIZE(r) ({sizes} 1)\n"
        f"#define RATE(r) ({rates} -1)\n"
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
        f'<DefaultExperiment startTime="0" stopTime="1" stepSize="0.01"/>'
        f"<ModelVariables>{written}</ModelVariables><ModelStructure>{structure}</ModelStructure>"
        "</fmiModelDescription>"
    )


def _attributes(v: V) -> str:
    varying = {"parameter": "fixed"}.get(
        v.causality, "continuous" if v.type.startswith("Float") else "discrete"
    )
    initial = f'initial="{v.initial}" ' if v.initial else ""
    return f'causality="{v.causality}" variability="{varying}" {initial}'


def _start(v: V) -> str:
    if v.causality not in ("parameter", "input") and not v.initial:
        return ""
    if v.type == "Boolean":
        return f'start="{str(bool(v.start)).lower()}" '
    values = v.starts if v.type.startswith("Float") else map(int, v.starts)
    return f'start="{" ".join(map(str, values))}" '


def _variable2(v: V, reference: int, index: dict[str, int]) -> str:
    assert v.size == 1
    unit = f'unit="{v.unit}" ' if v.unit else ""
    derivative = f'derivative="{index[v.derivative]}" ' if v.derivative else ""
    return (
        f'<ScalarVariable name={quoteattr(v.name)} valueReference="{reference}" {_attributes(v)}>'
        f"<{OF_FMI2[v.type]} {unit}{_start(v)}{derivative}{v.more}/></ScalarVariable>"
    )


def _variable3(v: V, reference: int, index: dict[str, int]) -> str:
    unit = f'unit="{v.unit}" ' if v.unit else ""
    derivative = f'derivative="{index[v.derivative]}" ' if v.derivative else ""
    shape = [2, 2] if v.size == 4 else [v.size]
    inside = "".join(f'<Dimension start="{n}"/>' for n in shape) if v.size > 1 else ""
    return (
        f'<{v.type} name={quoteattr(v.name)} valueReference="{reference}" {_attributes(v)}{unit}{_start(v)}'
        f"{derivative}{v.more}>{inside}</{v.type}>"
    )
