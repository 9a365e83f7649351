"""The C host of docs/how-to/native-fmus.md, compiled as it stands there."""

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest

from fmus.native.machine_code import FMI_HEADERS
from tests.third_party.c_fmus import compiler

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "native-fmus.md"


@pytest.mark.skipif(sys.platform != "linux", reason="the page's commands are Linux's")
def test_the_page_s_host_steps_an_fmu(native_files, tmp_path):
    """Its rows are those of another host, to the digits that it prints."""
    code = re.search(r"```c\n(.+?)```", PAGE.read_text("utf-8"), re.DOTALL)
    assert code
    (tmp_path / "host.c").write_text(code[1])
    command = [*compiler(), "-std=c99", f"-I{FMI_HEADERS}", "host.c", "-o", "host", "-ldl"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=300)
    file = native_files["valve_spring"]
    described = fmpy.read_model_description(str(file))
    position = next(v for v in described.modelVariables if v.name == "position")
    with zipfile.ZipFile(file) as archive:
        archive.extractall(tmp_path)
    library = next((tmp_path / "binaries" / "linux64").glob("*.so"))
    arguments = [str(library), described.guid, str(position.valueReference), "1e-4", "1e-3"]
    done = subprocess.run([str(tmp_path / "host"), *arguments], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    rows = [tuple(map(float, line.split(","))) for line in done.stdout.splitlines()]
    assert [time for time, _ in rows] == pytest.approx([1e-4 * n for n in range(1, 11)])
    expected = fmpy.simulate_fmu(
        str(file), stop_time=1e-3, step_size=1e-4, output_interval=1e-4, output=["position"]
    )
    assert [value for _, value in rows] == pytest.approx(list(expected["position"][1:]), rel=1e-8, abs=1e-15)
