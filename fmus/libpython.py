"""Makes Python's library visible to extension modules, where only the FMU's binary loaded it.

Extension modules such as numpy's use the Python symbols that are global in the process. This module imports
built-in modules only, because no extension module can be imported before it has run.
"""

import _imp
import contextlib
import os
import sys
from importlib.machinery import ModuleSpec


def show_to_all() -> None:
    """On Linux, load the loaded library again with global symbols; elsewhere do nothing."""
    if not sys.platform.startswith("linux"):
        return
    with open("/proc/self/maps") as maps:
        paths = {line.split(maxsplit=5)[5].strip() for line in maps if "/libpython3" in line}
    flags = sys.getdlopenflags()
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)
    try:
        for path in sorted(paths):
            # Python loads the library, then finds that it is no extension module.
            with contextlib.suppress(ImportError):
                _imp.create_dynamic(ModuleSpec("libpython", None, origin=path))
    finally:
        sys.setdlopenflags(flags)
