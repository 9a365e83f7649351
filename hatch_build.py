"""Build of the wheel: with TRIBOCOSIM_COMPILE=all it holds compiled kernels, and a first run compiles none.

The kernels are those that the shipped scenarios take, or those that TRIBOCOSIM_COMPILE names, for this
version of Python, of numba and of numpy and for every processor of this kind (models/compile/processor.py).
With other versions kernels are compiled at the first run, as with a wheel that holds none.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SCENARIOS = "orchestrator/scenario/shipped"
TO = "tribocosim_kernels"  # where models/compile/kernel_cache.py finds them


class CompiledKernels(BuildHookInterface):  # type: ignore[type-arg]
    """Adds a folder of compiled kernels to the wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile what is asked for, and let the wheel's name tell its platform."""
        wanted = os.environ.get("TRIBOCOSIM_COMPILE", "").split()
        if version != "standard" or not wanted:
            return
        root = Path(self.root)
        if wanted == ["all"]:
            wanted = sorted(file.stem for file in (root / SCENARIOS).glob("*.toml"))
        self._folder = Path(tempfile.mkdtemp(prefix="tribocosim-wheel-"))
        for name in wanted:
            self.app.display_info(f"kernels of {name}")
            self._run(root, name)
        build_data["force_include"][str(self._folder / "kernels")] = TO
        build_data["pure_python"] = False
        build_data["infer_tag"] = True

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Delete what was compiled."""
        if build_data["infer_tag"]:
            shutil.rmtree(self._folder)

    def _run(self, root: Path, name: str) -> None:
        """Run a scenario with this cache folder, which then holds its kernels."""
        command = [sys.executable, "-m", "tribocosim", "run", name, "--out", str(self._folder / name)]
        environment = os.environ | {"TRIBOCOSIM_CACHE": str(self._folder), "TRIBOCOSIM_KERNELS": ""}
        subprocess.run(command, cwd=root, env=environment, check=True)
