"""The slave: an FMU (FMI 2.0 co-simulation) of any component.

Every FMU contains this file beside the component's code. The slave uses a component's attributes only.

Inputs. An input keeps the value that the master set. During a step it follows the polynomial with the
coefficients `<input>`, `<input>_der1`, `_der2`, `_der3`; with zero derivatives it is constant. After a step
the outputs belong to the end of the step and of the polynomials. When the master sets an input or a
parameter, the outputs and their rates are computed from the new values at the same time. Initialisation,
iterations and events need this.

State. The evolving data is one vector and some flags. A saved state is a copy as bytes, with a digest of the
code that wrote it. An instance that restores it computes the same bits.

Errors. A step that fails is discarded: nothing changes, and the host's logger gets a message. Misuse, and
parameters or start values out of range, give fmi2Fatal, since pythonfmu's C layer has nothing milder. Errors
reach the host's logger even if logging is off (see `host`).
"""

import hashlib
import math
import sys
from threading import get_ident
from typing import Any, NoReturn

import numpy as np

from .host import Host, LastMessage, attached_threads
from .variable_layout import COEFFICIENTS, Memory, name_as_start_value

try:  # inside an FMU: the copy that belongs to its binary
    from .pythonfmu.enums import Fmi2Status
    from .pythonfmu.fmi2slave import Fmi2Slave
except ImportError:
    from pythonfmu.enums import Fmi2Status
    from pythonfmu.fmi2slave import Fmi2Slave

INSTANTIATED, INITIALIZING, STEPPING = 0, 1, 2

# A step must begin where the last one ended. Masters add up time in different ways, and a million
# additions lose about 1e-10 of it; what is left over is far below any step that makes sense.
_TIME_SLACK = 1e-9
_STEP_SLACK = 1e-6

_STATE_FORMAT = b"tribocosim state 1 "


class FmuError(Exception):
    """Misuse, or values out of range; the message is for the user."""


def slave_class(component: Any, model_name: str, digest: str, failures: dict[int, str]) -> type[Fmi2Slave]:
    """The slave of `component`. `digest` identifies the code in saved states; `failures` has a message for
    each non-zero status of the component's step."""
    memory = Memory(component)
    started = np.array(memory.started, dtype=np.int64)
    identity = hashlib.sha256(f"{digest} {model_name} {sorted(component.structure.items())}".encode())
    fixed = frozenset(v.reference for v in memory.variables() if v.variability == "fixed")
    names = tuple(v.name for v in memory.variables())
    attributes = {
        "component": component,
        "memory": memory,
        "template": memory.beginning(),
        "names": names,
        "fixed": fixed,
        "driven": frozenset(range(memory.inputs, memory.outputs)),
        "accounts": frozenset(range(memory.energies, memory.rates)),
        "started": started,
        "rated": np.array(memory.rated, dtype=np.int64),
        "failures": failures,
        "header": _STATE_FORMAT + identity.hexdigest()[:16].encode() + b"\n",
        "__doc__": component.description,
        "__module__": __name__,
    }
    return type(model_name, (ComponentSlave,), attributes)


class ComponentSlave(Fmi2Slave):  # type: ignore[misc]
    """An instance of the FMU; `slave_class` sets the class attributes."""

    component: Any
    memory: Memory
    template: Any
    names: tuple[str, ...]
    fixed: frozenset[int]
    driven: frozenset[int]  # inputs and their derivatives
    accounts: frozenset[int]  # energies
    started: Any  # which states have start values
    rated: Any  # which outputs have rates
    failures: dict[int, str]
    header: bytes

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._host = Host(self, kwargs.get("logger", 0))
        component, at = self.component, self.memory
        n, m = component.state.size, component.inputs.size
        self._data = data = self.template.copy()
        self._cells: Any = memoryview(data)  # of doubles
        self._variables = self._cells[: at.end_of_variables]
        self._p = data[: at.starts]
        self._x_start = data[at.starts : at.inputs]
        self._U = data[at.inputs : at.outputs].reshape(COEFFICIENTS, m)
        self._y = data[at.outputs : at.energies]
        self._energies = data[at.energies : at.rates]
        self._rates = data[at.rates : at.end_of_variables]
        self._x = data[at.x : at.x + n]
        self._u = data[at.u : at.u + m]
        self._scale = component.state.nominal
        self._work = np.zeros(component.work_size)
        self._slopes, self._all_rates = np.zeros(m), np.zeros(component.outputs.size)
        self._rates_work = np.zeros(component.rates_work_size)
        self._phase = INSTANTIATED
        self._outputs_stale = self._energies_stale = self._rates_stale = True
        # Values that were set since the last check, and may be out of range.
        self._parameters_unchecked = self._inputs_unchecked = True
        if self._host.present:
            # The C layer prepends it at every instantiation. Its modules are imported by now.
            sys.path[:] = [entry for entry in sys.path if entry != self.resources]

    # Initialisation

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: Any = None
    ) -> None:
        self._cells[self.memory.t] = start_time
        self._outputs_stale = True

    def enter_initialization_mode(self) -> None:
        self._phase = INITIALIZING

    def exit_initialization_mode(self) -> None:
        component = self.component
        faults = component.parameter_faults(self._p)
        if not faults:
            self._x[self.started] = self._x_start
            starts = component.start_faults(self._p, self._x, self._U[0])
            faults = [name_as_start_value(fault) for fault in starts]
        if faults:
            self._fatal("; ".join(faults))
        self._refresh()
        self._phase = STEPPING
        self._parameters_unchecked = False
        # Compile now what these parameters need, not in the first step.
        u, y = self._u.copy(), self._y.copy()
        t = self._cells[self.memory.t]
        component.step(t, 0.0, self._x.copy(), self._U, self._p, self._scale, self._work, u, y)

    # Stepping

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance by `step_size`. False, after a message, if the step fails; then nothing has changed."""
        if get_ident() not in attached_threads:
            self._host.keep_thread_state()
        cells, at = self._cells, self.memory
        t = cells[at.t]
        if not (
            step_size >= 0.0
            and abs(current_time - t) <= _TIME_SLACK * (1.0 + abs(t)) + _STEP_SLACK * step_size
        ):
            return self._discard(self._explain_step(current_time, step_size, t))
        if self._parameters_unchecked or self._inputs_unchecked:
            if faults := self._faults():
                return self._discard(faults)
            self._parameters_unchecked = self._inputs_unchecked = False
        status = self.component.step(
            current_time, step_size, self._x, self._U, self._p, self._scale, self._work, self._u, self._y
        )
        if status != 0:
            self._outputs_stale = self._energies_stale = self._rates_stale = True
            reasons = [self.failures.get(status, f"status {status}")]
            reasons += self.component.input_faults(self._U, step_size)
            return self._discard(f"step from t = {t:.9g} s by {step_size:g} s: {'; '.join(reasons)}")
        cells[at.t] = current_time + step_size
        cells[at.s] = step_size
        self._outputs_stale, self._energies_stale, self._rates_stale = False, True, True
        return True

    def _explain_step(self, current_time: float, step_size: float, t: float) -> str:
        if not step_size >= 0.0:
            return f"step size = {step_size:g} s: must not be negative"
        return f"step from t = {current_time:.12g} s: must begin at {t:.12g} s, where the state is"

    def _faults(self) -> str:
        faults = self.component.parameter_faults(self._p) if self._parameters_unchecked else []
        first = self.memory.inputs
        for i in np.flatnonzero(~np.isfinite(self._data[first : self.memory.outputs])):
            faults.append(f"{self.names[first + i]} = {self._data[first + i]}: must be finite")
        return "; ".join(faults)

    def _refresh(self) -> None:
        """Compute the outputs from the values that are set, at the present time."""
        if self._phase != STEPPING:
            self._x[self.started] = self._x_start
        self._u[:] = self._U[0]
        self._cells[self.memory.s] = 0.0
        self.component.flat_output(self._cells[self.memory.t], self._x, self._u, self._p, self._y)
        self._outputs_stale, self._energies_stale, self._rates_stale = False, True, True

    def _ready(self, vrs: list[int]) -> None:
        """Compute those of these variables that are out of date."""
        at, highest = self.memory, max(vrs, default=0)
        if highest < at.outputs:
            return
        if self._outputs_stale:
            self._refresh()
        if highest < at.energies:
            return
        if self._rates_stale and highest >= at.rates:
            self._refresh_rates()
        if self._energies_stale and not self.accounts.isdisjoint(vrs):
            self.component.flat_energy(self._cells[at.t], self._x, self._u, self._p, self._energies)
            self._energies_stale = False

    def _refresh_rates(self) -> None:
        component, cells, at = self.component, self._cells, self.memory
        component.input_rates(self._U, cells[at.s], self._slopes)
        component.flat_rates(
            cells[at.t], self._x, self._u, self._slopes, self._p, self._rates_work, self._all_rates
        )
        np.take(self._all_rates, self.rated, out=self._rates, mode="clip")  # unbuffered
        self._rates_stale = False

    # Variables

    def get_real(self, vrs: list[int]) -> list[float]:
        try:
            if self._outputs_stale or self._energies_stale or self._rates_stale:
                self._ready(vrs)
            if min(vrs, default=0) < 0:  # which the C layer makes of the highest ones
                raise IndexError
            cells = self._variables
            return [cells[i] for i in vrs]
        except Exception as error:
            self._fatal(self._explain_unreadable(vrs, error))

    def get_integer(self, vrs: list[int]) -> list[int]:
        return [int(value) for value in self.get_real(vrs)]

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        return [value != 0.0 for value in self.get_real(vrs)]

    def get_string(self, vrs: list[int]) -> list[str]:
        return self._no_strings(vrs)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        self._outputs_stale = True
        cells = self._cells
        if not self.driven.issuperset(vrs):
            self._check_settable(vrs)
        for i, value in zip(vrs, values, strict=True):
            cells[i] = value
        if not math.isfinite(sum(values)):
            self._inputs_unchecked = True

    def _check_settable(self, vrs: list[int]) -> None:
        """Refuse what there is not, outputs, and fixed variables after the initialisation."""
        if unknown := self._list_unknown(vrs):
            self._fatal(f"there is no {unknown}")
        if (highest := max(vrs)) >= self.memory.outputs:
            self._fatal(f"{self._name(highest)} is an output: it cannot be set")
        self._parameters_unchecked = True
        if self._phase == STEPPING:
            for i in vrs:
                if i in self.fixed:
                    self._fatal(f"{self._name(i)} is fixed: it cannot be set after initialisation")

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        self.set_real(vrs, [float(value) for value in values])

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        self.set_real(vrs, [1.0 if value else 0.0 for value in values])

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        self._no_strings(vrs)

    def _no_strings(self, vrs: list[int]) -> list[str]:
        if vrs:
            self._fatal(f"{self._name(vrs[0])} is not a String")
        return []

    def _name(self, reference: int) -> str:
        known = 0 <= reference < len(self.names)
        return self.names[reference] if known else f"value reference {reference % 2**32}"

    def _list_unknown(self, vrs: list[int]) -> str:
        return ", ".join(self._name(i) for i in vrs if not 0 <= i < self.memory.end_of_variables)

    def _explain_unreadable(self, vrs: list[int], error: Exception) -> str:
        unknown = self._list_unknown(vrs)
        return f"there is no {unknown}" if unknown else f"outputs cannot be computed: {error!r}"

    # State

    def _get_fmu_state(self) -> bytes:
        flags = (
            self._phase
            | self._outputs_stale << 2
            | self._energies_stale << 3
            | self._parameters_unchecked << 4
            | self._inputs_unchecked << 5
            | self._rates_stale << 6
        )
        return b"".join((self.header, flags.to_bytes(1, "little"), self._cells))

    def _set_fmu_state(self, state: bytes) -> None:
        header, at = self.header, len(self.header)
        if state[:at] != header or len(state) != at + 1 + self._data.nbytes:
            self._fatal(_mismatch(state, header))
        flags = state[at]
        self._data[:] = np.frombuffer(state, dtype=np.float64, offset=at + 1)
        self._phase = flags & 3
        self._outputs_stale, self._energies_stale = bool(flags & 4), bool(flags & 8)
        self._parameters_unchecked, self._inputs_unchecked = bool(flags & 16), bool(flags & 32)
        self._rates_stale = bool(flags & 64)

    # The C layer calls these two on the class, where no message can reach the host. `_set_fmu_state` checks
    # the bytes.

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> bytes:
        return state

    # Messages

    def _discard(self, message: str) -> bool:
        self.log(message, Fmi2Status.error, "logStatusError")
        self._host.let_messages_through()
        return False

    def _fatal(self, message: str) -> NoReturn:
        self.log_queue.append(LastMessage(message, Fmi2Status.error, "logStatusError"))
        self._host.let_messages_through()
        self._host.survive_exception()
        raise FmuError(message)


def _mismatch(state: bytes, header: bytes) -> str:
    if not state.startswith(_STATE_FORMAT):
        return "the saved state was not written by this FMU"
    theirs = state[len(_STATE_FORMAT) : len(header)].decode(errors="replace").strip()
    ours = header[len(_STATE_FORMAT) :].decode().strip()
    if theirs != ours:
        return f"the saved state belongs to another FMU or version ({theirs}, this is {ours})"
    return "the saved state is damaged: its length is wrong"
