"""What native FMUs answer to misuse is what the table in docs/reference/native-fmus.md says, row by row."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from ctypes import CDLL, byref, c_char, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any

import pytest
from fmpy import calloc, fmi2, free

from .programs import library_in

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "native-fmus.md"
STATUSES = {0: "OK", 2: "discard", 3: "error", None: "no instance"}
CO_SIMULATION, MODEL_EXCHANGE = 1, 0
UNKNOWN = 100_000


def rows() -> dict[str, tuple[str, str]]:
    """Status and message by misuse, from the page."""
    _, _, section = PAGE.read_text(encoding="utf-8").partition("## Misuse\n")
    table, _, _ = section.partition("\n## ")
    cells = [
        [cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines() if line[:2] == "| "
    ]
    return {misuse: (status, message.strip("`")) for misuse, status, message in cells[1:]}


class Host:
    """Calls the library of valve_spring: host.DoStep(0.0, 1e-5, 1) is fmi2DoStep of its one instance."""

    def __init__(self, library: Path, description: Any, kind: int = CO_SIMULATION) -> None:
        self.library, self.guid = CDLL(str(library)), description.guid.encode()
        self.at = {v.name: v.valueReference for v in description.modelVariables}
        self.said: list[tuple[int, str]] = []
        self.callbacks = fmi2.fmi2CallbackFunctions(
            fmi2.fmi2CallbackLoggerTYPE(lambda *said: self.said.append((said[2], said[4].decode()))),
            fmi2.fmi2CallbackAllocateMemoryTYPE(calloc),
            fmi2.fmi2CallbackFreeMemoryTYPE(free),
        )
        self.instance = self.instantiate(b"misused", self.guid, kind)

    def instantiate(self, name: bytes, guid: bytes, kind: int) -> c_void_p | None:
        make = self.library.fmi2Instantiate
        make.restype = c_void_p
        made = make(name, kind, guid, b"", byref(self.callbacks), 0, 0)
        return c_void_p(made) if made else None

    def __getattr__(self, name: str) -> Callable[..., int]:
        function = getattr(self.library, f"fmi2{name}")

        def call(*arguments: Any) -> int:
            changed = (c_double(a) if isinstance(a, float) else a for a in arguments)
            status: int = function(self.instance, *changed)
            return status

        return call

    def initialized(self, stop: float = 0.0) -> Host:
        assert not self.SetupExperiment(0, 0.0, 0.0, int(stop > 0.0), stop)
        assert not self.EnterInitializationMode()
        assert not self.ExitInitializationMode()
        return self

    def set(self, name: str | int, value: float) -> int:
        reference = name if isinstance(name, int) else self.at[name]
        return self.SetReal(byref(c_uint(reference)), c_size_t(1), byref(c_double(value)))

    def get(self, name: str) -> float:
        value = c_double()
        assert not self.GetReal(byref(c_uint(self.at[name])), c_size_t(1), byref(value))
        return value.value

    def derivative(self, which: str, name: str, order: int) -> int:
        reference, value = c_uint(self.at[name]), c_double(1.0)
        return getattr(self, which)(byref(reference), c_size_t(1), byref(c_int(order)), byref(value))

    def directional(self, known: str, change: float = 1.0, of: str = "acceleration") -> int:
        one, result = c_size_t(1), c_double()
        unknown, by = c_uint(self.at[of]), c_uint(self.at[known])
        return self.GetDirectionalDerivative(
            byref(unknown), one, byref(by), one, byref(c_double(change)), byref(result)
        )

    def kept(self) -> c_void_p:
        state = c_void_p()
        assert not self.GetFMUstate(byref(state))
        return state

    def saved(self) -> Any:
        state, size = self.kept(), c_size_t()
        assert not self.SerializedFMUstateSize(state, byref(size))
        data = (c_char * size.value)()
        assert not self.SerializeFMUstate(state, data, size)
        assert not self.FreeFMUstate(byref(state))
        return data

    def read(self, data: Any, size: int) -> int:
        state = c_void_p()
        status = self.DeSerializeFMUstate(data, c_size_t(size), byref(state))
        assert bool(state) == (status == 0)
        return status

    def free(self) -> None:
        if self.instance:
            self.library.fmi2FreeInstance(self.instance)


@pytest.fixture
def place(native_files: dict[str, Path], tmp_path: Path) -> tuple[Path, Any]:
    return library_in(native_files["valve_spring"], tmp_path)


@pytest.fixture
def host(place: tuple[Path, Any]) -> Iterator[Host]:
    made = Host(*place)
    yield made
    made.free()


def without_instance(host: Host) -> int:
    host.free()
    host.instance = None
    return host.DoStep(0.0, 1e-5, 1)


def wrong_guid(host: Host) -> int | None:
    return host.instantiate(b"another", b"{0}", CO_SIMULATION) and 0


def without_name(host: Host) -> int | None:
    return host.instantiate(b"", host.guid, CO_SIMULATION) and 0


def wrong_type(host: Host) -> int:
    return host.SetInteger(byref(c_uint(host.at["load"])), c_size_t(1), byref(c_int(1)))


def out_of_range(host: Host) -> int:
    host.set("valve_mass", -1.0)
    host.EnterInitializationMode()
    return host.ExitInitializationMode()


def tuned_out_of_range(host: Host) -> int:
    assert not host.initialized().set("valve_mass", -1.0)
    return host.DoStep(0.0, 1e-5, 1)


def too_stiff(host: Host) -> int:
    assert not host.initialized().set("spring_rate", 1e15)
    assert not host.set("load", 450.0)
    return host.DoStep(0.0, 1e-3, 1)


def beyond_stop(host: Host) -> int:
    assert not host.initialized(1e-4).DoStep(0.0, 6e-5, 1)
    return host.DoStep(6e-5, 6e-5, 1)


def damaged(host: Host) -> int:
    data = host.initialized().saved()
    data[len(data) // 2] = bytes([data[len(data) // 2][0] ^ 16])
    return host.read(data, len(data))


def truncated(host: Host) -> int:
    data = host.initialized().saved()
    return host.read(data, len(data) - 1)


def foreign(host: Host) -> int:
    data = host.initialized().saved()
    data[0] = b"x"
    return host.read(data, len(data))


def of_another_interface(host: Host) -> int:
    exchanging = Host.__new__(Host)
    exchanging.__dict__ |= host.__dict__
    exchanging.instance = host.instantiate(b"exchanging", host.guid, MODEL_EXCHANGE)
    state = exchanging.initialized().kept()
    status = host.initialized().SetFMUstate(state)
    exchanging.FreeFMUstate(byref(state))
    exchanging.free()
    return status


def small_place(host: Host) -> int:
    state = host.initialized().kept()
    status = host.SerializeFMUstate(state, (c_char * 10)(), c_size_t(10))
    host.FreeFMUstate(byref(state))
    return status


def exchanging(host: Host) -> Host:
    host.free()
    host.instance = host.instantiate(b"exchanging", host.guid, MODEL_EXCHANGE)
    return host.initialized()


def overflowing(host: Host) -> int:
    size = sum(name.startswith("der(state.") for name in host.at)
    exchanging(host).EnterContinuousTimeMode()
    assert not host.SetContinuousStates((c_double * size)(*[1e308] * size), c_size_t(size))
    return host.GetDerivatives((c_double * size)(), c_size_t(size))


MISUSES: dict[str, Callable[[Host], int | None]] = {
    "wrong GUID": wrong_guid,
    "no instance name": without_name,
    "no instance (`NULL`)": without_instance,
    "a call in the wrong phase": lambda host: host.DoStep(0.0, 1e-5, 1),
    "unknown value reference": lambda host: host.initialized().set(UNKNOWN, 1.0),
    "a variable of another type": wrong_type,
    "`NULL` for an array": lambda host: host.initialized().GetReal(None, c_size_t(2), None),
    "an output set": lambda host: host.initialized().set("position", 1.0),
    "a fixed parameter or start value set after initialisation": lambda host: host.initialized().set(
        "position_start", 1.0
    ),
    "NaN or infinity set": lambda host: host.initialized().set("load", math.nan),
    "strings": lambda host: host.initialized().GetString(byref(c_uint(0)), c_size_t(1), (c_void_p * 1)()),
    "a value out of range, at the end of initialisation": out_of_range,
    "a tuned parameter out of range, in the step": tuned_out_of_range,
    "a negative step": lambda host: host.initialized().DoStep(0.0, -1e-5, 1),
    "a step of NaN": lambda host: host.initialized().DoStep(0.0, math.nan, 1),
    "a step backwards, or from elsewhere": lambda host: host.initialized().DoStep(-1.0, 1e-5, 1),
    "an endless step": lambda host: host.initialized().DoStep(0.0, math.inf, 1),
    "an endless step, where a stop time was given": lambda host: host.initialized(1e-4).DoStep(
        0.0, math.inf, 1
    ),
    "a step that the component cannot make": lambda host: host.initialized().DoStep(0.0, 1e300, 1),
    "a step with more vibrations in it than can be followed": too_stiff,
    "a step beyond the stop time, if one was given": beyond_stop,
    "an input's derivative of order 4": lambda host: host.initialized().derivative(
        "SetRealInputDerivatives", "load", 4
    ),
    "the input derivative of no input": lambda host: host.initialized().derivative(
        "SetRealInputDerivatives", "position", 1
    ),
    "an output's derivative of order 2": lambda host: host.initialized().derivative(
        "GetRealOutputDerivatives", "position", 2
    ),
    "a directional derivative by an output": lambda host: host.initialized().directional("position"),
    "a directional derivative of an input": lambda host: host.initialized().directional("load", of="load"),
    "a directional derivative along NaN": lambda host: host.initialized().directional("load", math.nan),
    "no saved state (`NULL`)": lambda host: host.SetFMUstate(None),
    "too small a place for a serialised state": small_place,
    "a damaged serialised state": damaged,
    "a truncated serialised state": truncated,
    "a serialised state of another FMU or version": foreign,
    "a state of an instance for model exchange in one for co-simulation": of_another_interface,
    "a pending step cancelled": lambda host: host.initialized().CancelStep(),
    "the status of a pending step": lambda host: host.initialized().GetStatus(0, byref(c_int())),
    "a wrong number of continuous states": lambda host: exchanging(host).GetContinuousStates(
        (c_double * 99)(), c_size_t(99)
    ),
    "a time of NaN, in model exchange": lambda host: exchanging(host).SetTime(math.nan),
    "derivatives that are not finite, in model exchange": overflowing,
}


def test_the_table_has_all_rows() -> None:
    assert list(rows()) == list(MISUSES)


@pytest.mark.parametrize("misuse", MISUSES)
def test_answer(misuse: str, host: Host, place: tuple[Path, Any]) -> None:
    """The status of the page and its message, where … stands for anything; and exactly one message. After a
    reset the instance gives the same bits as one that was never misused."""
    status, message = rows()[misuse]
    host.said.clear()
    answer = MISUSES[misuse](host)
    assert STATUSES[answer] == status
    pattern = ".*".join(map(re.escape, message.split("…")))
    found = [text for _, text in host.said]
    assert len(found) == (message != "–")
    assert all(re.fullmatch(pattern, text, re.DOTALL) for text in found), found
    assert all(level == (answer or 3) for level, _ in host.said)
    if host.instance is None:
        return
    other = Host(*place)
    assert not host.Reset()
    end = [0.0, 0.0]
    for i, one in enumerate((host, other)):
        if "exchange" not in misuse and "continuous" not in misuse:
            one.initialized()
            assert not one.DoStep(0.0, 1e-4, 1)
        else:
            one.EnterInitializationMode()
        end[i] = one.get("spring_force")
    assert end[0] == end[1]
    other.free()


def test_hosts_may_reach_the_stop_time_by_adding_up(host: Host) -> None:
    """A thousand additions of 0.1 ms end 2e-15 s beyond 0.1 s; another step is refused until the next run."""
    host.initialized(0.1)
    time = 0.0
    for _ in range(1000):
        assert not host.DoStep(time, 1e-4, 1)
        time += 1e-4
    assert time > 0.1
    assert host.DoStep(time, 1e-4, 1) == 3
    assert not host.Reset()
    assert not host.initialized().DoStep(0.0, 0.2, 1)
