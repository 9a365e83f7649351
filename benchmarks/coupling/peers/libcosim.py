"""libcosim through libcosimpy: its fixed-step algorithm, Jacobi with held inputs. It counts nanoseconds.

Values are those of its last-value observer after a step, at its end, with the inputs held in the step. It
ignores variables of type Enumeration, so a choice other than the FMU's own cannot be made.
"""

from __future__ import annotations

from typing import Any

from .answering import answer


def simulate(job: dict[str, Any]) -> list[list[float]]:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_step_size(step_size=nanoseconds(job["step"]))
    index, reference, slaves = {}, {}, []
    for name, path in job["files"].items():
        slaves.append(CosimLocalSlave(fmu_path=path, instance_name=name))
        index[name] = execution.add_local_slave(slaves[-1])
        variables = execution.slave_variables(index[name])
        reference[name] = {v.name.decode(): v.reference for v in variables}
    for name, values in job["values"].items():
        for key, value in values.items():
            if key not in reference[name]:
                raise RuntimeError(f"libcosim ignores Enumerations, so {name}.{key} cannot be set")
            kind = {bool: "boolean", int: "integer", float: "real"}[type(value)]
            initial = getattr(execution, f"{kind}_initial_value")
            if not initial(index[name], reference[name][key], value):
                raise RuntimeError(f"libcosim refused {name}.{key} = {value}")
    ports = {}
    for port in {port for connection in job["connections"] for port in connection} | set(job["outputs"]):
        name, _, variable = port.partition(".")
        ports[port] = (index[name], reference[name][variable])
    for source, target in job["connections"]:
        execution.connect_real_variables(*ports[source], *ports[target])
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    outputs = [ports[name] for name in job["outputs"]]
    rows = []
    _step(execution, 0)  # initialises
    for _ in range(job["samples"]):
        _step(execution, job["every"])
        rows.append([observer.last_real_values(i, [reference])[0] for i, reference in outputs])
    return rows


def nanoseconds(step: float) -> int:
    """The step as libcosim counts it; ValueError for one that is no whole number of them."""
    count = round(step * 1e9)
    if abs(count - step * 1e9) > 1e-6:
        raise ValueError(f"{step:g} s is no whole number of nanoseconds")
    return count


def _step(execution: Any, count: int) -> None:
    if not execution.step(step_count=count):
        raise RuntimeError("libcosim could not step")


if __name__ == "__main__":
    answer(simulate)
