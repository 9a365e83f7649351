"""Whether the kernels of a component compute what it declares: found before a run, named with file and line.

Otherwise the compiler speaks of what is misspelt, an output that is left out is zero, and one that follows
an input at once without saying so is computed before that input.
"""

from __future__ import annotations

import ast
import builtins
import difflib
import dis
import inspect
import re
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import numpy as np

from ..compile.kernel import COMPILED, kernel
from .component import Component
from .errors import ModelError, suggestion
from .quantities import Layout, Vector

# Points at which outputs are tried: the start, and others around it, in which other branches are taken.
POINTS = 16
# Numbers that stand in results before kernels set them; what differs afterwards was not set.
BEFORE = 0.0, 1.0
COLOUR = re.compile(r"\x1b\[\d*m")
# Lines of numba's messages that say where it was, not what is wrong.
FRAMES = "Failed in", "During:", "File ", "def ", "^"
# Numbers beyond each result, by which it is seen that a kernel writes there: nothing else guards memory.
ROOM = 64
# Names that a message lists.
MOST = 30
# How long (s) kernels may take for all points but the start: they take microseconds, as Python milliseconds.
PATIENCE_S = 30.0
# States, inputs and parameters.
Point = tuple[Vector, Vector, Vector]


def check_kernels(component: Component) -> None:
    """ModelError for names that there are not, for results that are not set, and for outputs that follow an
    input at once without being declared to."""
    kernels = list(_list_kernels(component))
    if faults := [fault for one in kernels for fault in one.list_faults()]:
        raise ModelError("\n".join(faults))
    try:
        evaluate, points = _make_probe(component), list(enumerate(_choose_points(component)))
        _check_points(component, evaluate, points[:1])  # it compiles, which takes long
        _check_in_time(component, evaluate, points[1:])
    except ModelError:
        raise
    except Exception as error:  # whatever the compiler raises
        raise ModelError(_explain(error, component, kernels)) from None


def _check_points(component: Component, evaluate: Any, points: Iterable[tuple[int, Point]]) -> None:
    for number, point in points:
        try:
            with np.errstate(all="ignore"):  # as compiled code
                _check_results(component, evaluate, number, *point)
        except (ArithmeticError, ValueError) as error:
            # Python raises where compiled code has NaN.
            if COMPILED or isinstance(error, ModelError):
                raise


def _check_in_time(component: Component, evaluate: Any, points: Sequence[tuple[int, Point]]) -> None:
    """In a thread, which nothing but the end of the process ends if a kernel does not return."""
    begun, failed = list[Point](), list[Exception]()

    def note() -> Iterator[tuple[int, Point]]:
        for number, point in points:
            begun.append(point)
            yield number, point

    def check() -> None:
        try:
            _check_points(component, evaluate, note())
        except Exception as error:
            failed.append(error)

    thread = threading.Thread(target=check, daemon=True)
    thread.start()
    thread.join(PATIENCE_S)
    if thread.is_alive():
        raise ModelError(
            f"a kernel does not return within {PATIENCE_S:g} s {_describe(component, *begun[-1])}; limit the "
            "turns of its loops, for example by `while ... and turns < 100`: solvers try such values too"
        )
    if failed:
        raise failed[0]


@dataclass(frozen=True)
class _Kernel:
    """A kernel of a component: what it is, the names of its arguments, and the records that these are."""

    role: str
    function: Any
    arguments: tuple[str, ...]
    records: Mapping[str, Layout]

    @property
    def plain(self) -> Any:
        """The function of Python."""
        return inspect.unwrap(getattr(self.function, "py_func", self.function))

    @property
    def file(self) -> Path:
        return Path(self.plain.__code__.co_filename)

    def list_faults(self) -> Iterator[str]:
        """That it is no kernel of such arguments, or misspells fields or names."""
        if not (callable(self.function) and (hasattr(self.function, "py_func") or not COMPILED)):
            yield f"{self.role}: must be a function ({', '.join(self.arguments)}) with @kernel before it"
            return
        code, place = self.plain.__code__, self.file.name
        given = code.co_varnames[: code.co_argcount]
        if len(given) != len(self.arguments):
            yield (
                f"{place}, line {code.co_firstlineno}: {self.role}({', '.join(given)}): must take "
                f"({', '.join(self.arguments)})"
            )
            return
        scope = self.plain.__globals__
        named = dict(zip(given, self.arguments, strict=True))
        for line, name, field in _list_attributes(self.file, code):
            owner = self.records.get(named.get(name, ""), scope.get(name))
            known = (owner.dtype.names or ()) if isinstance(owner, Layout) else dir(owner)
            if isinstance(owner, Layout | ModuleType) and field not in known:
                called = (owner.record if isinstance(owner, Layout) else owner).__name__
                said = f"{name}.{field}: {called} has no {field!r}; {_suggest(field, known)}"
                yield f"{place}, line {line}: {said}"
        scope = {**scope, **vars(builtins), **dict.fromkeys(code.co_varnames)}
        for step in dis.get_instructions(code):
            if step.opname == "LOAD_GLOBAL" and step.argval not in scope:
                at = step.positions.lineno if step.positions else None
                yield f"{place}, line {at}: there is no {step.argval!r}; {_suggest(step.argval, scope)}"


def _suggest(name: str, known: Iterable[str]) -> str:
    names = list(known)
    return suggestion(name, names if len(names) <= MOST else difflib.get_close_matches(name, names, 1))


def _list_kernels(component: Component) -> Iterator[_Kernel]:
    x, u, p = component.kernel_state, component.inputs, component.parameters
    records = {"x": x, "u": u, "p": p, "dx": x, "y": component.outputs}

    def build(role: str, function: Any, arguments: str) -> _Kernel:
        return _Kernel(role, function, tuple(arguments.split()), records)

    yield build("derivative", component.derivative, "t x u p dx")
    yield build("output", component.output, "t x u p y")
    yield build("energy", component.energy, "t x u p e")
    for rule in component.requirements:
        yield build("requirement", rule.met, "p numbers")
    for rule in component.start_requirements:
        yield build("start requirement", rule.met, "x u p numbers")
    if component.events:
        yield build("guards", component.events.guards, "t x u p g")
        yield build("transition", component.events.transition, "k t x u p")


def _list_attributes(file: Path, code: CodeType | None = None) -> Iterator[tuple[int, str, str]]:
    """Line, owner and name of each attribute of a name in a file, or in a function of it."""
    try:
        tree = ast.parse(file.read_text("utf-8"))
    except (OSError, SyntaxError, UnicodeDecodeError):
        return
    lines = {line for _, _, line in code.co_lines() if line} if code else None
    for node in ast.walk(tree):
        match node:
            case ast.Attribute(value=ast.Name(id=owner), attr=name, lineno=line):
                if lines is None or line in lines:
                    yield line, owner, name


def _make_probe(component: Component) -> Any:
    """evaluate(k, x, u, p, dx, y, e, g) of all kernels at t = 0, of the output only where k is positive."""
    flat = component.flat
    derivative, output, energy = flat.derivative, flat.output, flat.energy

    @kernel
    def evaluate(k: int, x: Any, u: Any, p: Any, dx: Any, y: Any, e: Any, g: Any) -> None:
        output(0.0, x, u, p, y)
        if k <= 0:
            derivative(0.0, x, u, p, dx)
            energy(0.0, x, u, p, e)

    if not component.events:
        return evaluate
    guards, change = flat.guards, flat.transition

    @kernel
    def evaluate_with_events(k: int, x: Any, u: Any, p: Any, dx: Any, y: Any, e: Any, g: Any) -> None:
        evaluate(k, x, u, p, dx, y, e, g)
        if k <= 0:
            guards(0.0, x, u, p, g)
        if k < 0:  # never: it is compiled only
            change(0, 0.0, x, u, p)

    return evaluate_with_events


def _choose_points(component: Component) -> Iterator[Point]:
    """Those of the start, and others within their ranges."""
    random = np.random.default_rng(1)
    start = component.parameters.start
    for number in range(POINTS):
        x, u, p = component.state.start, component.inputs.start, start
        if number:
            x, u = (_vary(layout, random, 1.0) for layout in (component.state, component.inputs))
            p = _vary(component.parameters, random, 0.1)
        yield x.copy(), u.copy(), start.copy() if component.parameter_faults(p) else p.copy()


def _vary(layout: Layout, random: Any, share: float) -> Vector:
    """Start values changed by up to their nominal size, where they are not zero by this share of them."""
    found = layout.start.copy()
    for i, field in enumerate(layout.fields):
        quantity, (low, high) = field.quantity, field.quantity.limits()
        if quantity.boolean or quantity.choices:
            found[i] = random.integers(int(low), int(high) + 1)
        elif not quantity.count:
            size = share * abs(field.start) if share < 1.0 and field.start else quantity.nominal
            moved = float(np.clip(field.start + size * random.uniform(-1.0, 1.0), low, high))
            found[i] = field.start if quantity.positive and moved <= 0.0 else moved
    return found


def _check_results(component: Component, evaluate: Any, number: int, x: Vector, u: Vector, p: Vector) -> None:
    """Of point `number`: what is not set, and which outputs follow an input undeclared."""
    sizes = component.state.size, component.outputs.size, 3, component.motion.guard_count
    names = [f"the rate dx.{name}" for name in component.state.names]
    names += [f"output {name}" for name in component.outputs.names]
    names += ["the stored energy e[0]", "the dissipated power e[1]", "the source power e[2]"]
    names += [f"guard g[{i}]" for i in range(sizes[3])]

    def compute(before: float, k: int, inputs: Vector) -> Sequence[Vector]:
        given = x.copy(), inputs.copy(), p.copy()
        every = [np.full(size + ROOM, before) for size in sizes]
        results = [one[:size] for one, size in zip(every, sizes, strict=True)]
        evaluate(k, *given, *results)
        _check_arguments(component, given, (x, inputs, p))
        for name, one, size in zip(("dx", "y", "e", "g"), every, sizes, strict=True):
            if beyond := np.flatnonzero(one[size:] != before).tolist():
                last = f"its last is {name}[{size - 1}]" if size else "it has none"
                raise ModelError(f"a kernel writes {name}[{size + beyond[0]}]: {last}")
        return results

    found = compute(BEFORE[0], 0, u)
    once, again = (np.concatenate(every) for every in (found, compute(BEFORE[1], 0, u)))
    unset = np.flatnonzero((once != again) & ~(np.isnan(once) & np.isnan(again)))
    if unset.size:
        when = "" if number == 0 else f" in every case, as {_describe(component, x, u, p)}"
        raise ModelError(
            f"{', '.join(names[i] for i in unset)}: not set{when}; assign a value at every call of the kernel"
        )
    outputs = found[1]
    for i, field in enumerate(component.inputs.fields):
        changed = u.copy()
        changed[i] = field.quantity.displace(u[i])
        differs = compute(BEFORE[0], 1, changed)[1] != outputs
        for name in np.array(component.outputs.names)[differs & ~np.isnan(outputs)]:
            declared = component.feedthrough.get(str(name), ())
            if field.name not in declared:
                every = ", ".join(map(repr, (*declared, field.name)))
                raise ModelError(
                    f"output {name} depends on input {field.name} at the same instant, but feedthrough does "
                    f"not say so; give feedthrough={{{str(name)!r}: [{every}], ...}}"
                )


def _check_arguments(component: Component, after: Point, before: Point) -> None:
    """ModelError for what a kernel changed that it may only read."""
    layouts = component.state, component.inputs, component.parameters
    for record, layout, now, given in zip("xup", layouts, after, before, strict=True):
        names = np.array(layout.names)[(now != given) & ~(np.isnan(now) & np.isnan(given))]
        if names.size:
            said = "only a transition may; derivative writes to dx, output to y"
            raise ModelError(f"a kernel sets {record}.{names[0]}: {said}")


def _describe(component: Component, x: Vector, u: Vector, p: Vector) -> str:
    """The values of a point, few of them."""
    layouts = (component.state, x), (component.inputs, u), (component.parameters, p)
    every = [f"{n} = {v:.6g}" for layout, vector in layouts for n, v in layout.named(vector).items()]
    return f"with {', '.join(every[:8])}{', ...' if len(every) > 8 else ''}"


def _explain(error: Exception, component: Component, kernels: Sequence[_Kernel]) -> str:
    """What numba, or Python, says of a kernel, with the line that it means."""
    text = COLOUR.sub("", str(error))
    files = {one.file.name: one.file for one in kernels}
    if isinstance(error, KeyError | AttributeError):  # a field of a record that a kernel passed on
        name = (re.findall(r"(\w+)'?$", text) or [text])[-1]
        layouts = component.kernel_state, component.inputs, component.parameters, component.outputs
        known = [known for layout in layouts for known in layout.dtype.names or ()]
        found = ((file, *one) for file in files.values() for one in _list_attributes(file))
        places = (f"{file.name}, line {line}" for file, line, _, field in found if field == name)
        return f"{next(places, 'a kernel')}: no record has {name!r}; {suggestion(name, known)}"
    at = [(Path(file).name, line) for file, line in re.findall(r'File "([^"]+)", line (\d+)', text)]
    place = next((f"{name}, line {line}: " for name, line in at if name in files), "")
    said = [line.strip() for line in text.partition("<source")[0].splitlines() if line.strip()]
    reasons = [line for line in said if not line.startswith(FRAMES)]
    return f"{place}a kernel cannot be compiled: {' '.join(reasons[:3]) or text}"
