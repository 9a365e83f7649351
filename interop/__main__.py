"""`python -m interop [TOOL ...] [--fmu NAME ...] [--install]` runs our FMUs in other tools.

Without names it runs every tool that is installed. --install first makes an environment for each tool.
--fmu limits the run to these FMUs. docs/reference/tools.csv keeps the results of other FMUs and other tools.
"""

import argparse
import sys
import time
from itertools import product

from fmus.native.fmu import NAMES as FMUS
from fmus.native.machine_code import NativeBuildError
from models.core.system import suggestion

from .comparison import KINDS, TRAINS, compare
from .document import make_result, read_results, write_results
from .processes import NAMES, explain_missing, install


def main() -> int:
    """Return 0 if every named tool could run."""
    parser = argparse.ArgumentParser(prog="python -m interop", description=__doc__)
    parser.add_argument("tools", nargs="*", metavar="TOOL", help=f"one of {', '.join(NAMES)}")
    parser.add_argument("--fmu", nargs="+", choices=[*FMUS, *TRAINS], metavar="NAME", help="only these FMUs")
    parser.add_argument("--install", action="store_true", help="make an environment for each tool")
    given = parser.parse_args()
    if unknown := [name for name in given.tools if name not in NAMES]:
        parser.error(f"no tool {unknown[0]!r}; {suggestion(unknown[0], NAMES)}")
    results, absent = read_results(), []
    for name in given.tools or NAMES:
        if given.install and not install(name):
            print(f"{name}: could not be installed")
            absent.append(name)
            continue
        if why := explain_missing(name):
            print(why)
            absent.append(name)
            continue
        for fmu, kind in product(given.fmu or [*FMUS, *TRAINS], KINDS):
            began = time.perf_counter()
            result = make_result(fmu, *compare(name, fmu, KINDS[kind]))
            results[name, fmu, kind] = result
            passed = time.perf_counter() - began
            shown = " ".join((result.difference, result.message))
            print(f"{name}: {fmu}, {KINDS[kind].title}: {shown} ({passed:.1f} s)", flush=True)
        write_results(results)
    return 1 if given.tools and absent else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except NativeBuildError as error:
        sys.exit(f"{error}; or set up what the tests need: pip install -e '.[dev]'")
