"""The calls of FMUs that run in every step, made by compiled code.

Compiled code calls an FMU's functions by their addresses. Between two calls there is no Python, which would
take longer than the call of a small FMU. `compiled_calls` has the record that it needs of each FMU.
"""

from __future__ import annotations

from typing import Any

import numba
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from models.compile.compiled import compiled

from .compiled_calls import FINE, GET, RELEASE, SAVE, SET, STEP
from .fmi_instance import DISCARD, WARNING


def _build_function(builder: Any, address: Any, *arguments: str) -> Any:
    """The C function at that address, of these types of arguments, that returns a status.

    It is taken without a sign, so that a negative one is no success.
    """
    kinds = {"address": ir.IntType(64), "double": ir.DoubleType(), "int": ir.IntType(32)}
    kind = ir.FunctionType(ir.IntType(32), [kinds[argument] for argument in arguments])
    return builder.inttoptr(address, kind.as_pointer())


@intrinsic
def _call_reals(typing: Any, function: Any, component: Any, references: Any, count: Any, memory: Any) -> Any:
    """fmi2SetReal or fmi2GetReal."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = _build_function(builder, arguments[0], "address", "address", "address", "address")
        return builder.call(called, arguments[1:])

    return types.uint32(*[types.int64] * 5), generate


@intrinsic
def _call_reals3(typing: Any, function: Any, component: Any, references: Any, count: Any, memory: Any) -> Any:
    """fmi3SetFloat64 or fmi3GetFloat64, of scalars: as many values as references."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = _build_function(builder, arguments[0], *["address"] * 5)
        return builder.call(called, [*arguments[1:], arguments[3]])

    return types.uint32(*[types.int64] * 5), generate


@intrinsic
def _call_step(typing: Any, function: Any, component: Any, time: Any, step: Any, no_rollback: Any) -> Any:
    """fmi2DoStep."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = _build_function(builder, arguments[0], "address", "double", "double", "int")
        return builder.call(called, arguments[1:])

    return types.uint32(types.int64, types.int64, types.float64, types.float64, types.int32), generate


@intrinsic
def _call_step3(
    typing: Any, function: Any, component: Any, time: Any, step: Any, yes: Any, outcome: Any
) -> Any:
    """fmi3DoStep."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = _build_function(
            builder, arguments[0], "address", "double", "double", "int", *["address"] * 4
        )
        places = [builder.add(arguments[5], ir.IntType(64)(offset)) for offset in (0, 1, 2, 8)]
        return builder.call(called, [*arguments[1:5], *places])

    return types.uint32(
        types.int64, types.int64, types.float64, types.float64, types.int32, types.int64
    ), generate


@intrinsic
def _call_state(typing: Any, function: Any, component: Any, state: Any) -> Any:
    """fmi2GetFMUstate, fmi2FreeFMUstate and those of FMI 3."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.call(_build_function(builder, arguments[0], "address", "address"), arguments[1:])

    return types.uint32(types.int64, types.int64, types.int64), generate


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


@compiled
def _transfer(fmu: Any, function: int, references: int, count: int, memory: int) -> int:
    if fmu.fmi3:
        return _call_reals3(function, fmu.component, references, count, memory)
    return _call_reals(function, fmu.component, references, count, memory)


@compiled
def _call_transfer(fmu: Any, function: int, references: int, count: int, memory: int) -> int:
    if count == 0:
        return 0
    if fmu.in_python:
        return _transfer(fmu, function, references, count, memory)
    thread = _release_interpreter()
    status = _transfer(fmu, function, references, count, memory)
    _acquire_interpreter(thread)
    return status


@compiled
def _call_do_step(fmu: Any, time: float, step: float) -> int:
    yes = numba.int32(1)
    if fmu.fmi3:
        status = _call_step3(fmu.do_step, fmu.component, time, step, yes, fmu.outcome)
        # To ask for the end, or to come back early, is not to have made the step.
        if status <= WARNING and (_byte(fmu.outcome + 1) != 0 or _byte(fmu.outcome + 2) != 0):
            return numba.uint32(DISCARD)
        return status
    return _call_step(fmu.do_step, fmu.component, time, step, yes)


@compiled
def _step(fmu: Any, time: float, step: float) -> int:
    if fmu.in_python:
        return _call_do_step(fmu, time, step)
    thread = _release_interpreter()
    status = _call_do_step(fmu, time, step)
    _acquire_interpreter(thread)
    return status


@compiled
def _transfer_state(fmu: Any, function: int) -> int:
    if fmu.in_python:
        return _call_state(function, fmu.component, fmu.saved)
    thread = _release_interpreter()
    status = _call_state(function, fmu.component, fmu.saved)
    _acquire_interpreter(thread)
    return status


@compiled
def give(fmu: Any) -> tuple[int, int]:
    """Set the inputs; the call that did not succeed, or FINE, and its status."""
    status = _call_transfer(fmu, fmu.set_real, fmu.given_references, fmu.given_count, fmu.given)
    if status > WARNING:
        return SET, status
    if status == WARNING:
        fmu.warned += 1
    return FINE, status


@compiled
def advance(fmu: Any, time: float, step: float) -> tuple[int, int]:
    """Set the inputs and make the step; as `give`."""
    call, status = give(fmu)
    if call != FINE:
        return call, status
    if fmu.saved:
        status = _transfer_state(fmu, fmu.save)
        if status > WARNING:
            return SAVE, status
    status = _step(fmu, time, step)
    if status > WARNING:
        return STEP, status
    if status == WARNING:
        fmu.warned += 1
    if fmu.saved:
        status = _transfer_state(fmu, fmu.release)
        if status > WARNING:
            return RELEASE, status
    return FINE, status


@compiled
def take(fmu: Any) -> tuple[int, int]:
    """Get outputs and rates; as `give`."""
    status = _call_transfer(fmu, fmu.get_real, fmu.taken_references, fmu.taken_count, fmu.taken)
    if status > WARNING:
        return GET, status
    if status == WARNING:
        fmu.warned += 1
    return FINE, status
