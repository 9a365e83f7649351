"""OMSimulator by its C library: Jacobi with held inputs, with its default of a weakly coupled system.

The library is that of the environment variable OMSIMULATOR, or one that the system finds.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import tempfile
from typing import Any

from .answering import answer

# oms_system_wc, oms_solver_wc_ma, and the status that is not worse than a warning.
WEAKLY_COUPLED, FIXED_STEPS, WARNING = 1, 6, 1
MODEL, SYSTEM = "run", "run.root"


def simulate(job: dict[str, Any]) -> list[list[float]]:
    path = os.environ.get("OMSIMULATOR") or ctypes.util.find_library("OMSimulator")
    if path is None:
        raise OSError("libOMSimulator is not found (OMSIMULATOR names it)")
    library = ctypes.CDLL(path)

    def call(name: str, *arguments: Any) -> None:
        given = [a.encode() if isinstance(a, str) else a for a in arguments]
        if (status := getattr(library, f"oms_{name}")(*given)) > WARNING:
            raise RuntimeError(f"oms_{name}{arguments}: status {status}")

    with tempfile.TemporaryDirectory() as scratch:
        call("setTempDirectory", scratch)
        call("newModel", MODEL)
        try:
            call("addSystem", SYSTEM, WEAKLY_COUPLED)
            for name, file in job["files"].items():
                call("addSubModel", f"{SYSTEM}.{name}", file)
            for name, values in job["values"].items():
                for key, value in values.items():
                    call("setReal", f"{SYSTEM}.{name}.{key}", ctypes.c_double(value))
            for source, target in job["connections"]:
                call("addConnection", f"{SYSTEM}.{source}", f"{SYSTEM}.{target}", ctypes.c_bool(True))
            call("setResultFile", MODEL, "", 1)
            call("setSolver", SYSTEM, FIXED_STEPS)
            call("setFixedStepSize", SYSTEM, ctypes.c_double(job["step"]))
            stop = job["step"] * job["every"] * job["samples"]
            call("setStartTime", MODEL, ctypes.c_double(0.0))
            call("setStopTime", MODEL, ctypes.c_double(stop))
            call("instantiate", MODEL)
            call("initialize", MODEL)
            values, found = [], ctypes.c_double()
            for k in range(1, job["samples"] + 1):
                call("stepUntil", MODEL, ctypes.c_double(k * job["step"] * job["every"]))
                row = []
                for output in job["outputs"]:
                    call("getReal", f"{SYSTEM}.{output}", ctypes.byref(found))
                    row.append(found.value)
                values.append(row)
            call("terminate", MODEL)
        finally:
            library.oms_delete(MODEL.encode())
    return values


if __name__ == "__main__":
    answer(simulate)
