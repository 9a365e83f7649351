"""Reads modelDescription.xml of FMI 1.0, 2.0 and 3.0, with all scalars by their names."""

import functools
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from ..errors import MistakeError
from . import description1, description3
from .description3 import STRUCTURAL, EventMode, resize
from .description_faults import REALS as REALS
from .description_faults import read_file, read_root

VERSIONS = ("1.0", "2.0", "3.0")
# The interfaces by which an FMU can take part.
CO_SIMULATION, MODEL_EXCHANGE = "co_simulation", "model_exchange"
OWN_TOOL = "tribocosim "
BOOLEANS = ("Boolean",)
STRING, BINARY, CLOCK = "String", "Binary", "Clock"
INTEGERS = (
    *("Integer", "Enumeration"),
    *("Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"),
)

EXACT = 2**53  # whole numbers up to here are doubles


def find_range(kind: str) -> tuple[int, int]:
    """Least and largest number of a type of INTEGERS that is given as a double."""
    bits = {"Integer": 32, "Enumeration": 64}.get(kind) or int(kind.removeprefix("U").removeprefix("Int"))
    low, high = (0, 2**bits - 1) if kind.startswith("U") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return max(low, -EXACT), min(high, EXACT)


@dataclass(frozen=True)
class Variable:
    """A scalar: a variable, or an element of an array of `size`, its `place` counted row by row and its
    `index` as its name ends: [1,2]."""

    name: str
    type: str
    reference: int
    causality: str
    variability: str
    initial: str
    description: str
    unit: str  # empty: none is stated
    minimum: float
    maximum: float
    nominal: float
    start: float | None
    derivative: str  # the name of the variable whose time derivative this is, or empty
    place: int = 0
    size: int = 1
    items: tuple[tuple[str, int], ...] = ()  # of an enumeration, with their numbers
    relative: bool = False  # a difference: its unit's offset is ignored
    index: str = ""

    @property
    def whole(self) -> str:
        """The name of the array of which this is an element; its own if it is none."""
        return self.name.removesuffix(self.index)

    @property
    def memory(self) -> tuple[str, int, int]:
        """What it stands for in the FMU; names of which it is equal are aliases."""
        return "Integer" if self.type in INTEGERS else self.type, self.reference, self.place

    @property
    def numeric(self) -> bool:
        """Whether its values are numbers or booleans."""
        return self.type in REALS or self.discrete

    @property
    def settable(self) -> bool:
        """Whether it is a parameter that can be given a value."""
        return self.causality == "parameter" and self.variability != "constant"

    @property
    def stepwise(self) -> bool:
        """Whether it changes at events only: it has no slope, and no values in between."""
        return self.discrete or self.variability not in ("", "continuous")

    @property
    def discrete(self) -> bool:
        """Whether its values are integers or booleans."""
        return self.type in INTEGERS or self.type in BOOLEANS


@dataclass(frozen=True)
class Unit:
    """Value in SI base units = factor * value + offset; the base units' exponents."""

    exponents: tuple[int, ...]
    factor: float
    offset: float


@dataclass(frozen=True)
class Exchange:
    """What an FMU offers for model exchange: its library, and how many states and event indicators it has."""

    identifier: str
    states: int
    indicators: int


@dataclass(frozen=True)
class Description:
    """Of an FMU, by the interface that it takes part by: co-simulation, or model exchange if it is
    `integrated` here.

    `variables` by name; `depends` gives, for each output, the inputs it depends on at the same instant, where
    the file says it. `states` are the continuous states and their derivatives by time, if it gives
    directional derivatives by and of them; else None. `fixed_step` (s) is that of an FMU that moves by equal
    steps, else 0; one that `returns_early` may of itself come back from a step before its end, one that
    `interpolates` takes derivatives of inputs by the standard's call, one that `gives_rates` gives those of
    outputs so. `start`, `stop` and `step` (s) are those of its default experiment; `tool` is what made it.
    `exchange`: its model exchange; None if it has none. `sizes` are the values of structural parameters that
    differ from their starts. `events`: its event mode in co-simulation; None if it has none.
    """

    version: str
    model: str
    text: str
    token: str
    tool: str
    identifier: str
    variables: Mapping[str, Variable]
    depends: Mapping[str, tuple[str, ...]]
    states: Mapping[str, str] | None
    units: Mapping[str, Unit]
    restorable: bool
    serialisable: bool
    variable_step: bool
    fixed_step: float
    returns_early: bool
    interpolates: bool
    gives_rates: bool
    once_per_process: bool
    start: float | None
    stop: float | None
    step: float | None
    exchange: Exchange | None
    integrated: bool
    sizes: Mapping[str, int]
    events: EventMode | None

    @property
    def divisible(self) -> bool:
        """Whether shorter steps get it to the same place: it does not move by steps of its own."""
        return self.variable_step and not self.fixed_step

    @property
    def unserialisable(self) -> str:
        """Why its state cannot be given to another process; empty if it can."""
        if not self.restorable:
            return "the FMU cannot save its state (canGetAndSetFMUstate = false)"
        return (
            "" if self.serialisable else "the FMU cannot serialise its state (canSerializeFMUstate = false)"
        )

    @property
    def is_own(self) -> bool:
        """Whether the file names this program as its generator."""
        return self.tool.startswith(OWN_TOOL)

    def list_texts(self, *causalities: str) -> list[str]:
        """The scalars of types String and Binary that have one of these causalities and are no constants."""
        return [
            v.name
            for v in self.variables.values()
            if v.type in (STRING, BINARY) and v.causality in causalities and v.size == 1
            if v.variability != "constant"
        ]

    @property
    def strings(self) -> list[str]:
        """The strings and binary values that a scenario can give: of parameters and of inputs."""
        return self.list_texts("parameter", "input")

    @property
    def structural(self) -> dict[str, Variable]:
        """The structural parameters that can be given a value."""
        known = self.variables.values()
        return {v.name: v for v in known if v.causality == STRUCTURAL and v.variability != "constant"}

    def list_variables(self, causality: str) -> Iterator[Variable]:
        """The numeric variables of this causality."""
        return (v for v in self.variables.values() if v.causality == causality and v.numeric)


class DescriptionError(MistakeError):
    """The file is no usable FMU; the message lacks the file's name."""


NO_SIZES: Mapping[str, int] = {}


def read_description(
    path: Path, interface: str = CO_SIMULATION, sizes: Mapping[str, int] = NO_SIZES
) -> Description:
    """Read the description without running the FMU; DescriptionError if it cannot be used.

    An FMU that has only one interface is described by that. `sizes` are values of structural parameters.
    """
    try:
        status = path.stat()
    except OSError as error:
        raise DescriptionError(f"cannot be read as an FMU: {error}") from None
    return _describe(path, interface, tuple(sizes.items()), status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=64)
def _describe(
    path: Path, interface: str, sizes: tuple[tuple[str, int], ...], changed: int, size: int
) -> Description:
    """The same, read once for a file: those of thousands of variables take half a second."""
    try:
        root = read_root(path)
        found = read_file(path, root)
    except Exception as error:
        raise DescriptionError(f"cannot be read as an FMU: {' '.join(str(error).split())}") from None
    if found.fmiVersion == "1.0":
        description1.complete(found, root)
    events = description3.complete(found, root) if found.fmiVersion == "3.0" else None
    _complete_relative(found, root)
    resize(found, dict(sizes))
    about, exchange = found.coSimulation, found.modelExchange
    integrated = exchange is not None and (about is None or interface == MODEL_EXCHANGE)
    if integrated:
        about = exchange
    if about is None and getattr(found, "scheduledExecution", None) is not None:
        raise DescriptionError(
            "is an FMU for scheduled execution only, whose clocks a real-time scheduler has to run: runs "
            "take FMUs for co-simulation or model exchange"
        )
    if about is None or found.fmiVersion not in VERSIONS:
        said = "" if found.fmiVersion in VERSIONS else f" (it says fmiVersion = {found.fmiVersion!r})"
        raise DescriptionError(
            f"is not an FMU for co-simulation, or for model exchange of FMI 2.0 or 3.0{said}"
        )
    if interface == MODEL_EXCHANGE and not integrated:
        raise DescriptionError("has no model exchange; leave `interface` out")
    variables = [v for variable in found.modelVariables for v in _list_scalars(variable)]
    names = Counter(v.name for v in variables)
    if len(names) < len(variables):
        raise DescriptionError(
            f"has two variables of the name {names.most_common(1)[0][0]!r} in its modelDescription.xml, so "
            "that nobody knows which is meant; have the tool that made it give each a name of its own"
        )
    experiment = found.defaultExperiment
    return Description(
        version=found.fmiVersion,
        model=found.modelName,
        text=found.description or "",
        token=found.guid,
        tool=found.generationTool or "",
        identifier=about.modelIdentifier,
        variables={v.name: v for v in variables},
        depends=_read_dependencies(found),
        states=_read_states(found) if _differentiates(root, about, integrated, found.fmiVersion) else None,
        units={unit.name: _read_unit(unit.baseUnit) for unit in found.unitDefinitions if unit.baseUnit},
        restorable=bool(about.canGetAndSetFMUstate),
        serialisable=bool(about.canSerializeFMUstate),
        variable_step=integrated or bool(about.canHandleVariableCommunicationStepSize),
        fixed_step=0.0 if integrated else float(about.fixedInternalStepSize or 0.0),
        returns_early=not integrated and bool(about.mightReturnEarlyFromDoStep),
        interpolates=not integrated and bool(about.canInterpolateInputs) and found.fmiVersion != "3.0",
        gives_rates=not integrated and int(about.maxOutputDerivativeOrder or 0) > 0,
        once_per_process=bool(about.canBeInstantiatedOnlyOncePerProcess),
        exchange=exchange
        and Exchange(
            exchange.modelIdentifier,
            int(found.numberOfContinuousStates or 0),
            int(found.numberOfEventIndicators or 0),
        ),
        integrated=integrated,
        sizes=dict(sizes),
        events=None if integrated else events,
        **{
            short: _parse_number(getattr(experiment, name, None))
            for short, name in {"start": "startTime", "stop": "stopTime", "step": "stepSize"}.items()
        },
    )


def _complete_relative(found: Any, root: ElementTree.Element) -> None:
    """Complete fmpy's description by which variables are differences, of themselves or by their type."""
    stated = {one.get("name"): one for one in root.iterfind("ModelVariables/*")}
    for variable in found.modelVariables:
        original = getattr(variable, "alias", None) or variable
        element, declared = stated[original.name], variable.declaredType
        said = [
            one.attrib["relativeQuantity"] for one in (element, *element) if "relativeQuantity" in one.attrib
        ]
        by_type = declared is not None and bool(declared.relativeQuantity)
        variable.relativeQuantity = said[0] in ("true", "1") if said else by_type


def _list_scalars(variable: Any) -> Iterator[Variable]:
    """The variable, or the elements of an array: x[1], x[2], or x[1,1], x[1,2]."""
    shape = tuple(variable.shape or ())
    size = math.prod(shape)
    starts = _read_starts(variable, size)
    declared = variable.declaredType
    items = tuple((item.name, int(item.value)) for item in getattr(declared, "items", None) or ())
    unit = variable.unit or (declared.unit if declared else None) or ""
    limits = {key: _read_limit(variable, declared, key) for key in ("min", "max", "nominal")}
    derived = variable.derivative
    rate_of = derived.name if derived is not None and tuple(derived.shape or ()) == shape else ""
    for place, index in enumerate(product(*(range(1, n + 1) for n in shape))):
        element = f"[{','.join(map(str, index))}]" if shape else ""
        yield Variable(
            name=variable.name + element,
            type=variable.type,
            reference=int(variable.valueReference),
            causality=variable.causality or "local",
            variability=variable.variability or "",
            initial=variable.initial or "",
            description=variable.description or "",
            unit=unit,
            minimum=-math.inf if limits["min"] is None else limits["min"],
            maximum=math.inf if limits["max"] is None else limits["max"],
            nominal=abs(limits["nominal"] or 1.0),
            start=starts[place],
            derivative=rate_of and rate_of + element,
            place=place,
            size=size,
            items=items if variable.type == "Enumeration" else (),
            relative=bool(variable.relativeQuantity),
            index=element,
        )


def _read_limit(variable: Any, declared: Any, key: str) -> float | None:
    found = _parse_number(getattr(variable, key))
    return _parse_number(getattr(declared, key, None)) if found is None else found


def _read_starts(variable: Any, size: int) -> list[float | None]:
    """The start values of all elements; None without a number."""
    if variable.start is None or variable.type not in (*REALS, *INTEGERS, *BOOLEANS):
        return [None] * size
    words = str(variable.start).split()
    if len(words) == 1:
        words *= size
    return [_parse_number(word) for word in words] if len(words) == size else [None] * size


def _parse_number(text: Any) -> float | None:
    if text is None:
        return None
    try:
        return float({"true": "1", "false": "0"}.get(str(text), str(text)))
    except ValueError:
        return None


def _read_dependencies(found: Any) -> dict[str, tuple[str, ...]]:
    """The inputs that each output depends on, where the file states them."""
    depends: dict[str, tuple[str, ...]] = {}
    for unknown in found.outputs:
        if unknown.variable is None or unknown.dependencies is None:
            continue
        inputs = [v for v in unknown.dependencies if v is not None and v.causality == "input"]
        names = tuple(v.name for one in inputs for v in _list_scalars(one))
        depends |= {v.name: names for v in _list_scalars(unknown.variable)}
    return depends


def _differentiates(root: ElementTree.Element, about: Any, integrated: bool, version: str) -> bool:
    """Whether it gives directional derivatives; fmpy does not read this for FMI 3.0."""
    if version == "2.0":
        return bool(about.providesDirectionalDerivative)
    kind = root.find("ModelExchange" if integrated else "CoSimulation")
    return kind is not None and kind.get("providesDirectionalDerivatives") in ("true", "1")


def _read_states(found: Any) -> dict[str, str] | None:
    """The states and their derivatives; None if the file may not list all."""
    if not found.derivatives and found.modelExchange is None:
        return None
    if any(unknown.variable is None for unknown in found.derivatives):
        return None
    derivatives = [v for unknown in found.derivatives for v in _list_scalars(unknown.variable)]
    return {v.derivative: v.name for v in derivatives} if all(v.derivative for v in derivatives) else None


def _read_unit(unit: Any) -> Unit:
    exponents = tuple(int(getattr(unit, name)) for name in ("kg", "m", "s", "A", "K", "mol", "cd", "rad"))
    return Unit(exponents, float(unit.factor), float(unit.offset))
