"""`python -m interop [TOOL ...] [--fmu NAME ...] [--install]` runs our FMUs in other tools.

Without names it runs every tool that is installed. --install first makes an environment for each tool.
--fmu limits the run to these FMUs. docs/reference/tools.md keeps its results of other FMUs and other tools.
"""

from __future__ import annotations

import argparse
import sys
import time

from fmus.build import NAMES as FMUS
from fmus.native.machine_code import NativeBuildError

from .comparison import KINDS, compare
from .document import FILE, Section, describe_machine, format_page, read_sections
from .processes import NAMES, explain_missing, install

RUNS = 4  # the best one counts


def main() -> int:
    """Return 0 if every named tool could run."""
    parser = argparse.ArgumentParser(prog="python -m interop", description=__doc__)
    parser.add_argument("tools", nargs="*", metavar="TOOL", help=f"one of {', '.join(NAMES)}")
    parser.add_argument("--fmu", nargs="+", choices=FMUS, metavar="NAME", help="only these FMUs")
    parser.add_argument("--install", action="store_true", help="make an environment for each tool")
    given = parser.parse_args()
    if unknown := [name for name in given.tools if name not in NAMES]:
        parser.error(f"no tool {unknown[0]!r}: there are {', '.join(NAMES)}")
    sections, absent = read_sections(), []
    for name in given.tools or NAMES:
        if given.install and not install(name):
            print(f"{name}: could not be installed")
            absent.append(name)
            continue
        if why := explain_missing(name):
            print(why)
            absent.append(name)
            continue
        kept = sections.get(name) if given.fmu else None
        sections[name] = kept or Section(name, "", describe_machine())
        for fmu in given.fmu or FMUS:
            run(sections[name], fmu)
        FILE.write_text(format_page(sections), "utf-8")
    return 1 if given.tools and absent else 0


def run(section: Section, fmu: str) -> None:
    """Run every kind of this FMU in the section's tool."""
    for name, kind in KINDS.items():
        began = time.perf_counter()
        difference, answer = compare(section.tool, fmu, kind, RUNS)
        cells = " ".join(section.add(fmu, name, difference, answer))
        passed = time.perf_counter() - began
        print(f"{section.tool}: {fmu}, {kind.title}: {cells} {answer.failed} ({passed:.1f} s)", flush=True)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except NativeBuildError as error:
        sys.exit(f"{error}; or set up what the tests need: pip install -e '.[dev]'")
