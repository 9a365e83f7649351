"""A command whose standard streams are closed, full or cut off."""

import subprocess
import sys
from pathlib import Path

import pytest

RUN = [
    *("-m", "tribocosim", "run", "two-masses", "--no-figures"),
    *("--set", "stop_time=0.1", "--set", "reference.enabled=false"),
]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="has no device that is always full")
@pytest.mark.parametrize("streams", [">&-", "2>&-", "<&-", ">&- 2>&- <&-", ">/dev/full", "| head -0"])
def test_a_run_comes_to_its_result(streams: str, tmp_path: Path) -> None:
    command = " ".join(f"'{word}'" for word in (sys.executable, *RUN, "--out", str(tmp_path / "out")))
    subprocess.run(["bash", "-c", f"{command} {streams}"], capture_output=True, check=False)
    assert '"complete": true' in (tmp_path / "out" / "summary.json").read_text("utf-8")
