"""Python's library made visible to extension modules, where the FMU's binary alone had it loaded.

Extension modules such as numpy's name no Python library: they take what the process shows to all. Without any
extension module, as none can be imported yet: the ones that are built in suffice.
"""

from __future__ import annotations

import _imp
import contextlib
import os
import sys
from importlib.machinery import ModuleSpec


def show_to_all() -> None:
    """On Linux, load the library that is loaded once more, for all to see; elsewhere nothing."""
    if not sys.platform.startswith("linux"):
        return
    with open("/proc/self/maps") as maps:
        paths = {line.split(maxsplit=5)[5].strip() for line in maps if "/libpython3" in line}
    flags = sys.getdlopenflags()
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)
    try:
        for path in sorted(paths):
            # It is no extension module, which is noticed when it has been loaded.
            with contextlib.suppress(ImportError):
                _imp.create_dynamic(ModuleSpec("libpython", None, origin=path))
    finally:
        sys.setdlopenflags(flags)
