"""The processor that kernels are compiled for: the same on all machines of a kind.

Compiled kernels then serve every such machine, so that a wheel can hold them, and give the same bits on each.
`choose` sets what numba reads, for this process and those that it starts.
"""

import contextlib
import os
import platform
import sys

# What x86-64-v3 has beside older processors (x86-64 psABI, table 3.1), by LLVM's names.
V3 = ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave")
NAME, FEATURES = "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"


def choose() -> None:
    """Set NUMBA_CPU_NAME and NUMBA_CPU_FEATURES, unless one is set: x86-64-v3 on such a processor, generic on
    arm64. On another, and where the name is set to "native", kernels are compiled for this very processor."""
    with contextlib.suppress(ImportError, RuntimeError):
        if os.environ.get(NAME) == "native":
            import llvmlite.binding

            os.environ[NAME] = llvmlite.binding.get_host_cpu_name()
        elif NAME not in os.environ and FEATURES not in os.environ and (name := _common_name()):
            os.environ.update({NAME: name, FEATURES: ""})
    if "numba" in sys.modules:  # it has read them, and its user may have set others
        config = sys.modules["numba"].config
        kept = {key: value for key, value in vars(config).items() if key.isupper() and key[:4] != "CPU_"}
        config.reload_config()
        vars(config).update(kept)


def _common_name() -> str:
    machine = platform.machine().lower()
    if machine in ("arm64", "aarch64"):
        return "generic"
    if machine not in ("x86_64", "amd64"):
        return ""
    import llvmlite.binding

    found = llvmlite.binding.get_host_cpu_features()
    return "x86-64-v3" if all(found.get(feature) for feature in V3) else ""
