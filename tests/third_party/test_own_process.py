"""The process of a third-party FMU."""

import subprocess
import sys

import pytest

from .c_fmus import fmu
from .runs import CASES

# A run of the FMU at PATH by messages, which prints the packages of what it has imported.
SERVED = """
import json, sys
from orchestrator.participants.messages import ADVANCE, CALL, READ, TIMES
from orchestrator.participants.process import Server
server = Server()
call = lambda method, **given: server.carry_out(CALL, json.dumps({"method": method, **given}).encode())
path, folder = sys.argv[1:]
call("instantiate", name="mass", path=path, given={"outputs": ["position"]}, folder=folder)
call("connect", inputs=["force"], rows=4, outputs=["position"], rated=True)
call("initialise", start_time=0.0, stop_time=1.0)
call("finish_initialisation")
server.carry_out(ADVANCE, TIMES.pack(0.0, 0.01) + bytes(32))
server.carry_out(READ, b"")
call("close")
print(*(name.partition(".")[0] for name in sys.modules))
"""
NEEDLESS = {
    "numba", "llvmlite", "scipy", "sksundae", "matplotlib", "pydantic", "xarray", "h5netcdf", "pint", "typer",
    "rich", "jinja2", "pythonfmu",
}  # fmt: skip


@pytest.mark.parametrize("version", sorted({version for version, _ in CASES}))
def test_the_process_of_an_fmu_imports_no_compiler(version, tmp_path):
    """Nor what solves, draws or reads scenarios: each FMU would wait for it. The FMU holds its input, which
    gets means."""
    path = fmu("sprung", version, tmp_path)
    command = [sys.executable, "-c", SERVED, str(path), str(tmp_path / "unpacked")]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert not NEEDLESS & set(done.stdout.split())
