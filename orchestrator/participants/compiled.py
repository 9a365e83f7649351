"""The calls of FMUs that run in every step, made by compiled code.

Compiled code calls an FMU's functions by their addresses. Between two calls there is no Python, which would
take longer than the call of a small FMU. `compiled_calls` has the record that it needs of each FMU.
"""

from typing import Any

import numba
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from models.compile.compiled import compiled

from .compiled_calls import FINE, GET, SET, STEP
from .fmi_instance import DISCARD, WARNING


@intrinsic
def _call(typing: Any, function: Any, arguments: Any) -> Any:
    """The status of the C function at that address, of the arguments in a tuple: addresses and sizes are
    int64. It is taken without a sign, so that a negative one is no success."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        given = cgutils.unpack_tuple(builder, values[1])
        kind = ir.FunctionType(ir.IntType(32), [value.type for value in given])
        return builder.call(builder.inttoptr(values[0], kind.as_pointer()), given)

    return types.uint32(types.int64, arguments), generate


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
def _let_go(fmu: Any) -> Any:
    """Release the interpreter, unless the FMU is in Python."""
    return 0 if fmu.in_python else _release_interpreter()


@compiled
def _take_back(fmu: Any, thread: int) -> None:
    if not fmu.in_python:
        _acquire_interpreter(thread)


@compiled
def _transfer(fmu: Any, function: int, references: int, count: int, memory: int) -> Any:
    """fmi2SetReal, fmi2GetReal, and those of FMI 3, which get as many values as references."""
    if count == 0:
        return numba.uint32(0)
    thread = _let_go(fmu)
    if fmu.fmi3:
        status = _call(function, (fmu.component, references, count, memory, count))
    else:
        status = _call(function, (fmu.component, references, count, memory))
    _take_back(fmu, thread)
    return status


@compiled
def _step(fmu: Any, time: float, step: float) -> int:
    yes, at = numba.int32(1), fmu.outcome
    thread = _let_go(fmu)
    if fmu.fmi3:
        status = _call(fmu.do_step, (fmu.component, time, step, yes, at, at + 1, at + 2, at + 8))
        # To ask for the end, or to come back early, is not to have made the step.
        if status <= WARNING and (_byte(at + 1) != 0 or _byte(at + 2) != 0):
            status = numba.uint32(DISCARD)
    else:
        status = _call(fmu.do_step, (fmu.component, time, step, yes))
    _take_back(fmu, thread)
    return status


@compiled
def _judge(fmu: Any, call: int, status: int) -> tuple[int, int]:
    """The call that did not succeed, or FINE, and its status; a warning is counted."""
    if status > WARNING:
        return call, status
    if status == WARNING:
        fmu.warned += 1
    return FINE, status


@compiled
def give(fmu: Any) -> tuple[int, int]:
    """Set the inputs; the call that did not succeed, or FINE, and its status."""
    return _judge(fmu, SET, _transfer(fmu, fmu.set_real, fmu.given_references, fmu.given_count, fmu.given))


@compiled
def advance(fmu: Any, time: float, step: float) -> tuple[int, int]:
    """Set the inputs and make the step; as `give`."""
    call, status = give(fmu)
    return _judge(fmu, STEP, _step(fmu, time, step)) if call == FINE else (call, status)


@compiled
def take(fmu: Any) -> tuple[int, int]:
    """Get outputs and rates; as `give`."""
    return _judge(fmu, GET, _transfer(fmu, fmu.get_real, fmu.taken_references, fmu.taken_count, fmu.taken))
