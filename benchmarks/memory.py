"""Peak memory of a run with a million macro steps, results streamed to disk, in a process of its own."""

import subprocess
import sys
import tempfile

CODE = """
import sys
from pathlib import Path
from tribocosim.command_line import main
arguments = ["run", "valve-train", "--out", sys.argv[1], "--no-figures", "--overwrite"]
for item in ("macro_step=1e-7", "output_step=1e-7", "stop_time=0.1", "reference.enabled=false"):
    arguments += ["--set", item]
sys.argv[1:] = arguments
try:
    main()
finally:
    # Not getrusage: its peak comes along from the process that started this one.
    peak = Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0]
    print("peak", int(peak) // 1024, "MB")
"""


# Macro steps with a rollback every tenth; the memory in use at a tenth of the way and at its end.
ROLLBACKS = """
import sys
from pathlib import Path
from fmus.build import build
from orchestrator.engine.coupling import Coupling
from orchestrator.masters import GaussSeidel
from orchestrator.participants.open_fmu import open_fmu
from benchmarks.measure import load_system
STEPS, STEP = int(sys.argv[1]), 1e-6
_, system = load_system("quarter-car")
participants = {
    n: open_fmu(n, build(i.component.name, structure=i.component.structure), i)
    for n, i in system.instances.items()
}
master = GaussSeidel("quadratic")
coupling = Coupling(system, participants, master.degree)
coupling.initialise(0.0, STEPS * STEP)

def read_resident():
    return int(Path("/proc/self/status").read_text().split("VmRSS:")[1].split()[0])

for n in range(STEPS):
    time = n * STEP
    if n % 10 == 0:
        with coupling.points.keep() as saved:
            master.step(coupling, time, STEP)
            coupling.points.restore(saved)
            master.step(coupling, time, STEP)
    else:
        master.step(coupling, time, STEP)
    coupling.accept(time + STEP)
    if n == STEPS // 10:
        early = read_resident()
print("resident", early, read_resident())
"""


def measure_rollbacks(steps: int = 1_000_000) -> tuple[float, float] | str:
    """Memory in use (MB) at a tenth of the steps and at their end, or what went wrong."""
    command = [sys.executable, "-c", ROLLBACKS, str(steps)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = [line.split() for line in done.stdout.splitlines() if line.startswith("resident")]
    if not lines:
        return done.stderr[-300:]
    early, late = (int(part) / 1024 for part in lines[0][1:])
    return early, late


def measure_recording() -> str:
    """Peak memory of a run with a million macro steps, or what went wrong."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-c", CODE, folder], capture_output=True, text=True, check=False
        )
    peak = [line for line in done.stdout.splitlines() if line.startswith("peak")]
    return peak[0] if peak else done.stderr[-300:]


def measure() -> list[tuple[str, str]]:
    """Figures and their values (Linux)."""
    found = measure_rollbacks()
    return [
        ("memory: 10^6 macro steps of valve-train, every one recorded", measure_recording()),
        (
            "memory: 10^6 macro steps of quarter-car, a rollback every tenth; at 10 % and at 100 %",
            found if isinstance(found, str) else f"{found[0]:.1f} MB, {found[1]:.1f} MB",
        ),
    ]
