"""What must not change while the house is rebuilt: digests of results, written down before the first move.

`python -m scaffold.same_bits` compares with `same_bits.json`; `--write` records what is missing there;
names as further arguments choose. The bits hold for one machine, its processor and its package versions.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tempfile
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).parent.parent
RECORD = Path(__file__).with_name("same_bits.json")
SCENARIOS = ROOT / "orchestrator" / "scenario" / "shipped"
LIMIT = 400.0  # s of wall time of one case

MASTERS = ["jacobi", "gauss_seidel", "iterated", "newton"]
SIGNALS = ["hold", "linear", "quadratic", "hermite"]

STUDY = """
description = "Force of the slider-crank over damping"
analysis = "force"
[points]
kind = "grid"
[points.axes]
damping = [0.02, 0.05]
"""


def participants(scenario: str, kind: str) -> list[str]:
    """Options that make all components of the scenario participants of this kind."""
    table = tomllib.loads((SCENARIOS / f"{scenario}.toml").read_text())
    names = set(table.get("components", {}))
    while "extends" in table:
        table = tomllib.loads((SCENARIOS / f"{table['extends']}.toml").read_text())
        names |= set(table.get("components", {}))
    return [option for name in sorted(names) for option in ("--set", f"components.{name}.participant={kind}")]


def cases() -> dict[str, list[str]]:
    """Arguments of `tribocosim` by case; OUT stands for the output folder."""
    found: dict[str, list[str]] = {}
    for file in sorted(SCENARIOS.glob("*.toml")):
        run = ["run", file.stem, "--out", "OUT", "--no-figures", "--set", "reference.enabled=false"]
        found[f"{file.stem} fmu"] = run
        found[f"{file.stem} native"] = [*run, "--native"]
        found[f"{file.stem} in-process"] = [*run, *participants(file.stem, "in-process")]
    run = ["run", "quarter-car", "--out", "OUT", "--no-figures", "--set", "reference.enabled=false"]
    for master in MASTERS:
        for signal in SIGNALS:
            found[f"quarter-car {master} {signal}"] = [
                *run, "--set", f"master={{name='{master}', extrapolation='{signal}'}}",
            ]  # fmt: skip
    found["analyse force"] = ["analyse", "force", "--out", "OUT"]
    found["analyse wear"] = ["analyse", "wear", "--out", "OUT"]
    found["analyse quarter-car"] = ["analyse", "quarter-car", "--out", "OUT"]
    found["study force"] = ["study", "STUDY", "--out", "OUT"]
    for name in ["valve-train", "quarter-car", "valve-train-controlled", "slider-crank", "bouncing-mass"]:
        found[f"{name} reference"] = ["run", name, "--out", "OUT", "--no-figures"]
    return found


def digest(case: str, arguments: list[str]) -> str:
    """SHA-256 of what the case writes, or how it ended."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        study = Path(folder) / "study.toml"
        study.write_text(STUDY)
        words = [{"OUT": str(out), "STUDY": str(study)}.get(word, word) for word in arguments]
        command = [
            sys.executable,
            "-c",
            "import sys; from orchestrator.command_line import main; sys.exit(main())",
        ]
        try:
            done = subprocess.run(
                [*command, *words], cwd=ROOT, env={**os.environ, "OMP_NUM_THREADS": "1"},
                timeout=LIMIT, capture_output=True, text=True,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return "not within the limit"
        if done.returncode not in (0, 1, 4):
            return f"exit status {done.returncode}: {done.stderr.strip().splitlines()[-1:]}"
        if case.endswith(" reference"):
            return reference_digest(out / "result.nc")
        files = sorted(path for path in out.rglob("*.csv") if path.name != "units.csv")
        if not files:
            return store_digest(out)
        return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()


def reference_digest(file: Path) -> str:
    """Of all values in the reference's group."""
    import h5py

    sha = hashlib.sha256()
    with h5py.File(file) as data:
        group = data["reference"]
        for name in sorted(group):
            sha.update(name.encode() + group[name][()].tobytes())
    return sha.hexdigest()


def store_digest(out: Path) -> str:
    """Of the values in a study's store, or in an analysis' netCDF file."""
    import numpy as np
    import xarray as xr

    sha = hashlib.sha256()
    for path in sorted(out.rglob("*.zarr")) + sorted(out.rglob("*.nc")):
        data = xr.open_zarr(path) if path.suffix == ".zarr" else xr.open_dataset(path)
        for name in sorted(str(name) for name in data.variables):
            if any(word in name for word in ("time_s", "wall", "host", "finished")):
                continue
            values = np.asarray(data[name].values)
            sha.update(
                name.encode()
                + (repr(values.tolist()).encode() if values.dtype == object else values.tobytes())
            )
    return sha.hexdigest()


def main() -> int:
    """Compare, or write what is missing."""
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    known: dict[str, str] = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    write = "--write" in sys.argv
    chosen = {
        case: arguments
        for case, arguments in cases().items()
        if (not words or any(word in case for word in words)) and not (write and case in known)
        and (write or case in known)
    }  # fmt: skip

    def measure(case: str) -> tuple[str, str, float]:
        began = time.monotonic()
        return case, digest(case, chosen[case]), time.monotonic() - began

    differ = 0
    with ThreadPoolExecutor(int(os.environ.get("JOBS", "2"))) as pool:
        for case, found, seconds in pool.map(measure, chosen):
            if write:
                known[case] = found
                RECORD.write_text(json.dumps(dict(sorted(known.items())), indent=1) + "\n")
            same = known[case] == found
            differ += not same
            print(f"{'same' if same else 'DIFFERENT':9} {seconds:6.1f} s  {case}  {found[:70]}", flush=True)
    print(f"{differ} of {len(chosen)} differ")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
