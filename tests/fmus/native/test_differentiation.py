"""What has a derivative in native code, and what must not be there."""

from collections.abc import Iterable
from types import FunctionType, ModuleType
from typing import Any, NamedTuple, get_args, get_type_hints

import pytest

from fmus.native.fmu import NAMES
from models.catalogue import find_factory
from models.compile.kernel import kernel
from models.native.differentiate import DifferentiationError, differentiate


def numbers_in(kind: Any) -> set[type]:
    """Of what a value of this type is made."""
    inner = [*get_type_hints(kind).values()] if hasattr(kind, "_fields") else get_args(kind)
    return set().union(*map(numbers_in, inner)) if inner else {kind}


def reached(kernels: Iterable[Any]) -> set[FunctionType]:
    """The functions of these kernels, and all that their code names, at any depth."""
    found: set[FunctionType] = set()
    waiting = [*kernels]
    while waiting:
        function = getattr(one := waiting.pop(), "py_func", one)
        mine = isinstance(function, FunctionType) and function.__module__.startswith(("models", "tests"))
        if mine and function not in found:
            found.add(function)
            names = function.__code__.co_names
            named = [function.__globals__.get(name) for name in names]
            waiting += [getattr(m, name, None) for m in named if isinstance(m, ModuleType) for name in names]
            waiting += [*named, *(cell.cell_contents for cell in function.__closure__ or ())]
    return found


def mixing(kernels: Iterable[Any]) -> list[str]:
    """Those that return whole numbers and floats in one record."""
    kinds = {f"{f.__module__}.{f.__name__}": get_type_hints(f).get("return") for f in reached(kernels)}
    return [name for name, kind in kinds.items() if float in (n := numbers_in(kind)) and n & {int, bool}]


class Found(NamedTuple):
    """A record of which no derivative is known."""

    place: int
    value: float


def test_no_kernel_returns_whole_numbers_and_floats_in_one_record():
    """Native derivatives know none of such a record: machine code copies it as bytes."""

    @kernel
    def find(x: float) -> Found:
        return Found(0, x)

    @kernel
    def call(x: float) -> float:
        return find(x).value

    assert mixing([call]) == [f"{__name__}.find"]
    for name in NAMES:
        sizes = find_factory(name)().structure
        for points in {0, 16 * any("points" in key for key in sizes)}:
            c = find_factory(name)(**{key: n or points * ("points" in key) for key, n in sizes.items()})
            smooth = [c.flat_output, c.flat_derivative, c.flat_energy, c.flat_rates, c.flat_guards]
            assert not mixing(smooth), name


def test_code_without_known_derivative_is_refused():
    code = """
    declare double @j0(double)
    define i32 @kernel_output(ptr %retptr, ptr %excinfo, double %arg.t, ptr %arg.y) {
      %v = call double @j0(double %arg.t)
      store double %v, ptr %arg.y
      ret i32 0
    }
    """
    with pytest.raises(DifferentiationError, match="@j0"):
        differentiate(code, ["output"])


def test_constants_that_a_loop_walks_through_have_no_tangent():
    """Nothing is read in the place of their tangents, which is none."""
    code = """
    @numbers = internal constant [4 x double] [double 1.0, double 2.0, double 4.0, double 8.0]
    define i32 @kernel_output(ptr %retptr, ptr %excinfo, double %arg.t, ptr %arg.y) {
    entry:
      br label %loop
    loop:
      %at = phi ptr [ @numbers, %entry ], [ %next, %loop ]
      %i = phi i64 [ 0, %entry ], [ %more, %loop ]
      %sum = phi double [ 0.0, %entry ], [ %added, %loop ]
      %number = load volatile double, ptr %at
      %scaled = fmul double %number, %arg.t
      %added = fadd double %sum, %scaled
      %next = getelementptr i8, ptr %at, i64 8
      %more = add i64 %i, 1
      %last = icmp eq i64 %more, 4
      br i1 %last, label %end, label %loop
    end:
      store double %added, ptr %arg.y
      ret i32 0
    }
    """
    assert differentiate(code, ["output"]).count("load") == 1
