"""The calls of FMUs that run in every step, made by compiled code.

An FMU's functions are called by their addresses: between two calls there is no Python, which would take
longer than the call of a small FMU. `CALLS` is all that this takes, one record for each FMU.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from .fmi_instance import DISCARD, WARNING

# Addresses of the functions, of the component, and of the references and numbers that are given to it and
# taken from it; how many these are. Where the FMU is in Python, the interpreter is not let go for its calls.
# One of FMI 3 tells of its step in the memory `told`: event, end, early return (a byte each), at 8 the time.
# Steps that return a warning are counted in `warned`.
CALLS = np.dtype(
    [
        (name, np.int64)
        for name in (
            "component", "in_python", "fmi3", "told", "set_real", "do_step", "get_real",
            "given", "given_references", "given_count",
            "taken", "taken_references", "taken_count", "warned",
        )
    ]
)  # fmt: skip

# Which call of an FMU did not succeed.
FINE, SET, STEP, GET, NOT_FINITE = range(5)


def _build_function(builder: Any, address: Any, *arguments: str) -> Any:
    """The C function at that address, of these types of arguments, that returns a status."""
    kinds = {"address": ir.IntType(64), "double": ir.DoubleType(), "int": ir.IntType(32)}
    kind = ir.FunctionType(ir.IntType(32), [kinds[argument] for argument in arguments])
    return builder.inttoptr(address, kind.as_pointer())


@intrinsic
def _call_reals(typing: Any, function: Any, component: Any, references: Any, count: Any, memory: Any) -> Any:
    """fmi2SetReal or fmi2GetReal."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = _build_function(builder, arguments[0], "address", "address", "address", "address")
        return builder.call(called, arguments[1:])

    return types.int32(*[types.int64] * 5), generate


@intrinsic
def _call_reals3(typing: Any, function: Any, component: Any, references: Any, count: Any, memory: Any) -> Any:
    """fmi3SetFloat64 or fmi3GetFloat64, of scalars: as many values as references."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = _build_function(builder, arguments[0], *["address"] * 5)
        return builder.call(called, [*arguments[1:], arguments[3]])

    return types.int32(*[types.int64] * 5), generate


@intrinsic
def _call_step(typing: Any, function: Any, component: Any, time: Any, step: Any, no_rollback: Any) -> Any:
    """fmi2DoStep."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = _build_function(builder, arguments[0], "address", "double", "double", "int")
        return builder.call(called, arguments[1:])

    return types.int32(types.int64, types.int64, types.float64, types.float64, types.int32), generate


@intrinsic
def _call_step3(typing: Any, function: Any, component: Any, time: Any, step: Any, yes: Any, told: Any) -> Any:
    """fmi3DoStep."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = _build_function(
            builder, arguments[0], "address", "double", "double", "int", *["address"] * 4
        )
        places = [builder.add(arguments[5], ir.IntType(64)(offset)) for offset in (0, 1, 2, 8)]
        return builder.call(called, [*arguments[1:5], *places])

    return types.int32(
        types.int64, types.int64, types.float64, types.float64, types.int32, types.int64
    ), generate


@intrinsic
def _byte(typing: Any, address: Any) -> Any:
    """What is at this address."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place = builder.inttoptr(arguments[0], ir.IntType(8).as_pointer())
        return builder.load(place)

    return types.uint8(types.int64), generate


# Other threads, an FMU's own too, may need the interpreter meanwhile.
_release_interpreter = types.ExternalFunction("PyEval_SaveThread", types.intp())
_acquire_interpreter = types.ExternalFunction("PyEval_RestoreThread", types.void(types.intp))


@numba.njit(cache=True)
def _transfer(fmu: Any, function: int, references: int, count: int, memory: int) -> int:
    if fmu.fmi3:
        return _call_reals3(function, fmu.component, references, count, memory)
    return _call_reals(function, fmu.component, references, count, memory)


@numba.njit(cache=True)
def _call_transfer(fmu: Any, function: int, references: int, count: int, memory: int) -> int:
    if count == 0:
        return 0
    if fmu.in_python:
        return _transfer(fmu, function, references, count, memory)
    thread = _release_interpreter()
    status = _transfer(fmu, function, references, count, memory)
    _acquire_interpreter(thread)
    return status


@numba.njit(cache=True)
def _call_do_step(fmu: Any, time: float, step: float) -> int:
    yes = numba.int32(1)
    if fmu.fmi3:
        status = _call_step3(fmu.do_step, fmu.component, time, step, yes, fmu.told)
        # To ask for the end, or to come back early, is not to have made the step.
        if status <= WARNING and (_byte(fmu.told + 1) != 0 or _byte(fmu.told + 2) != 0):
            return numba.int32(DISCARD)
        return status
    return _call_step(fmu.do_step, fmu.component, time, step, yes)


@numba.njit(cache=True)
def _step(fmu: Any, time: float, step: float) -> int:
    if fmu.in_python:
        return _call_do_step(fmu, time, step)
    thread = _release_interpreter()
    status = _call_do_step(fmu, time, step)
    _acquire_interpreter(thread)
    return status


@numba.njit(cache=True)
def give(fmu: Any) -> tuple[int, int]:
    """Set the inputs; the call that did not succeed, or FINE, and its status."""
    status = _call_transfer(fmu, fmu.set_real, fmu.given_references, fmu.given_count, fmu.given)
    if status > WARNING:
        return SET, status
    return FINE, status


@numba.njit(cache=True)
def advance(fmu: Any, time: float, step: float) -> tuple[int, int]:
    """Set the inputs and make the step; as `give`."""
    call, status = give(fmu)
    if call != FINE:
        return call, status
    status = _step(fmu, time, step)
    if status > WARNING:
        return STEP, status
    if status == WARNING:
        fmu.warned += 1
    return FINE, status


@numba.njit(cache=True)
def take(fmu: Any) -> tuple[int, int]:
    """Get outputs and rates; as `give`."""
    status = _call_transfer(fmu, fmu.get_real, fmu.taken_references, fmu.taken_count, fmu.taken)
    if status > WARNING:
        return GET, status
    return FINE, status
